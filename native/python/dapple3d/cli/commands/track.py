# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple track: points that stay put on a moving mesh."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import meshes, options
from dapple3d.cli.files import about, check_outputs
from dapple3d.cli.points import bound
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.work import Work
from dapple3d.distributed.shots import motion_arrays
from dapple3d.writing import replacing, write_npz

Motion = list[tuple[str, NDArray]]  # name and vertices of each frame
# Options of sample(), for the first frame, that mean the same to the tracker.
START = {*options.library_defaults("sample")} & {*options.library_defaults("Tracker")} - {
    "max_evaluations"  # of each frame
}


@click.command("track", short_help="Points that stay put on a moving mesh.")
@click.argument("frames", type=options.INPUT, nargs=-1, required=True)
@click.argument("out", type=options.OUTPUT)
@click.option("-n", "--count", type=options.COUNT, help="Number of points, on the first frame.")
@click.option(
    "--points",
    type=options.INPUT,
    help="Begin with these points on the first frame instead; each of their classes stays even.",
)
@click.option(
    "--together",
    is_flag=True,
    help="Solve all frames together: smoother in time, about three times as long; the stickiness "
    f"is then {options.library_defaults('track_window')['stickiness']} by default.",
)
@options.library_options("track_window", only=["closed", "sweeps"], before="With --together: ")
@options.library_options("sample", only=["seed"])
@options.library_options("Tracker", without=["union_weight"])
@options.weld_option
@options.profile_option
@options.report_options
def command(
    frames: tuple[Path, ...],
    out: Path,
    count: int | None,
    points: Path | None,
    together: bool,
    closed: bool | None,
    sweeps: int | None,
    seed: int | None,
    weld: bool,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **solver: Any,
) -> None:
    """Keep COUNT points, or a file's, even and in place on the FRAMES of a motion.

    FRAMES are meshes as for `dapple sample` with the same faces, or one .npz with 'vertices'
    (frames, v, 3) and 'faces' (m, 3). OUT is an .npz: 'positions' and 'normals' (frames, n, 3),
    'faces' (frames, n) and 'barycentric' (frames, n, 3): where on the mesh each point is; 'ids'
    and 'classes' (n,), and 'reports' (frames,), JSON.

    \b
    Examples:
      dapple track walk_0.ply walk_1.ply walk_2.ply points.npz -n 2000
      dapple track walk.npz points.npz -n 2000 --together --closed
      dapple track walk.npz points.npz --points plants.npz
    """
    reporter = Reporter(json_out, quiet)
    if out.suffix.lower() != ".npz":
        raise click.ClickException(f"{out}: the points of all frames are written as .npz")
    if not together and (closed or sweeps is not None):
        raise click.UsageError("--closed and --sweeps need --together")
    options.check_either(count, points)
    check_outputs([*frames, points], [out, reporter.file])
    source, motion = read_motion(frames)
    loaded = meshes.load(source, weld=weld)
    tracking = options.given(solver)
    sampling = {name: tracking[name] for name in START if name in tracking}
    sampling |= options.given({"seed": seed})
    if together:
        tracking |= options.given({"closed": closed, "sweeps": sweeps})
    with Work("tracking", steps=2 if together else len(motion), quiet=quiet) as work:
        if points:
            first = bound(loaded.surface, points)
            tracking |= of_classes(first)
        else:
            assert count is not None
            first = work.run(partial(dapple.sample, loaded.surface, count, **sampling))
        follow = follow_together if together else follow_each
        results = follow(work, loaded.surface, motion, first, tracking)
    write_motion(out, results)
    verb = "track_window" if together else "Tracker"
    settings = {"count": len(first), "together": together} | options.library_defaults(verb)
    settings["seed"] = options.library_defaults("sample")["seed"]
    reporter.store(
        "track",
        input=loaded.describe()
        | {"frames": [name for name, _ in motion], "points": str(points) if points else None},
        output=str(out),
        settings=settings | sampling | tracking,
        reports=[samples.report.to_dict() for samples in results],
    )
    slide = max(samples.report.slide_max for samples in results)
    reporter.say(
        f"{out}: {len(first)} points on {len(motion)} frames, the last one: "
        f"{figures(results[-1].report)}, farthest slide {slide:.3f} spacings"
    )
    if profile:
        reporter.show_profile([samples.report for samples in results])


def of_classes(first: dapple.Samples) -> dict[str, Any]:
    """How many points each class has, for the tracker, if there are several."""
    counts = np.bincount(first.classes).tolist()
    return {"classes": counts} if len(counts) > 1 else {}


def read_motion(frames: Sequence[Path]) -> tuple[meshes.Mesh, Motion]:
    """The first frame as a mesh, and the vertices of all, the first's among them.

    Raises:
        ClickException: naming the frame that has other faces, or arrays that are no motion.
    """
    first = meshes.read_mesh(frames[0])
    if len(frames) == 1:
        if np.ndim(first.vertices) != 3 or len(first.vertices) == 0:
            raise click.ClickException(
                f"{first.path}: 'vertices' has the shape {np.shape(first.vertices)}: "
                "(frames, v, 3) is needed, or more files"
            )
        motion = [(f"{first.path}[{k}]", frame) for k, frame in enumerate(first.vertices)]
        return meshes.Mesh(first.path, first.vertices[0], first.faces, first.arrays), motion
    motion = [(str(first.path), first.vertices)]
    for path in frames[1:]:
        other = meshes.read_mesh(path)
        check_same_faces(first, other)
        motion.append((str(path), other.vertices))
    return first, motion


def check_same_faces(first: meshes.Mesh, other: meshes.Mesh) -> None:
    """Raise ClickException, naming the first face that differs."""
    if other.faces.shape != first.faces.shape:
        raise click.ClickException(
            f"{other.path}: has faces {other.faces.shape}, but {first.path} {first.faces.shape}: "
            "all frames need the same faces"
        )
    different = np.flatnonzero((other.faces != first.faces).any(axis=1))
    if len(different):
        k = different[0]
        raise click.ClickException(
            f"{other.path}: faces[{k}] is {other.faces[k].tolist()}, but in {first.path} "
            f"{first.faces[k].tolist()}: all frames need the same faces"
        )


def follow_each(
    work: Work,
    surface: dapple.Surface,
    motion: Motion,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[dapple.Samples]:
    """Frame after frame."""
    tracker = dapple.Tracker(surface, first, **given)
    results = [first]
    for name, vertices in motion[1:]:
        with about(name):
            results.append(work.run(partial(tracker.advance, vertices)))
    return results


def follow_together(
    work: Work,
    surface: dapple.Surface,
    motion: Motion,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[dapple.Samples]:
    """All frames at once."""
    frames = [vertices for _, vertices in motion[1:]]
    with about(motion[0][0]):
        return work.run(partial(dapple.track_window, surface, frames, first, **given))


def write_motion(path: Path, results: Sequence[dapple.Samples]) -> None:
    """Write the frames' samples."""
    with replacing(path) as file:
        write_npz(file, motion_arrays(results))
