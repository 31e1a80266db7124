# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple track: points that stay put on a moving mesh."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import meshes, options, sequences
from dapple3d.cli.files import about, check_outputs
from dapple3d.cli.masks import Command, Masks, mask_options
from dapple3d.cli.points import bound
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.sequences import Frames
from dapple3d.cli.work import Work
from dapple3d.density import MaskedSurface
from dapple3d.extras.distributed.shots import changing_arrays, motion_arrays
from dapple3d.writing import replacing, write_npz

LARGEST_CLASS = 1_000_000
OVER_TIME = FIRST_FRAME, ALL_FRAMES, EACH_FRAME = "first-frame", "all-frames", "each-frame"
# Options of sample(), for the first frame, that mean the same to the tracker.
START = {*options.library_defaults("sample")} & {*options.library_defaults("Tracker")} - {
    "max_evaluations"  # of each frame
}


@click.command("track", cls=Command, short_help="Points that stay put on a moving mesh.")
@click.argument("frames", type=options.FRAMES, nargs=-1, required=True)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of points, on the first frame.")
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
@click.option(
    "--keep-density",
    is_flag=True,
    help="As many points per area as on the first frame: some appear, others vanish, and FRAMES "
    "may have other faces.",
)
@options.library_options("Population", only=["fade", "reach"], before="With --keep-density: ")
@options.library_options("sample", only=["seed"])
@options.library_options("Tracker", without=["union_weight"])
@mask_options
@click.option(
    "--outside-over-time",
    type=click.Choice(OVER_TIME),
    help="With --outside: frames that decide. first-frame: places stay as they are there, and "
    "points may become hidden. all-frames: places that are seen on every frame. each-frame: points "
    "leave places that become hidden and move to those that become visible.  "
    f"[default: {FIRST_FRAME}]",
)
@options.surface_options
@options.profile_option
@options.report_options
def command(
    frames: tuple[Path, ...],
    out: Path,
    count: int | None,
    spacing: float | None,
    points: Path | None,
    together: bool,
    closed: bool | None,
    sweeps: int | None,
    keep_density: bool,
    fade: int | None,
    reach: float | None,
    seed: int | None,
    masks: Masks,
    outside_over_time: str | None,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **solver: Any,
) -> None:
    """Keep COUNT points, or a file's, even and in place on the FRAMES of a motion.

    FRAMES are meshes as for `dapple sample` with the same polygons, a folder of them, or one .npz
    with 'vertices' (frames, v, 3) and 'faces' (m, 3). OUT is an .npz: 'positions' and 'normals'
    (frames, n, 3), 'faces' (frames, n) and 'barycentric' (frames, n, 3): where on the mesh each
    point is; 'ids' and 'classes' (n,), and 'reports' (frames,), JSON.

    A folder's files are in the order of the numbers in their names; a minus is a sign where another
    name has a number in its place (f-1, f0), else a dash (shot-1, shot-2). Polygons may begin at
    another corner. Triangles of .stl hang together where those of the first frame do.

    Masks count as on the first frame, and go with the surface; --outside-over-time says more of
    --outside.

    With --keep-density faces may be others on each frame, or none: no points then. One .npz then
    has 'vertices_0', 'faces_0', 'vertices_1' and so on. The points of all frames follow each other
    in OUT: those of frame k are the rows 'starts'[k] to 'starts'[k + 1] of each array. 'fade'
    (rows,) is how far a point has appeared, 0 to 1.

    \b
    Examples:
      dapple track walk_0.ply walk_1.ply walk_2.ply points.npz -n 2000
      dapple track walk.npz points.npz -n 2000 --together --closed
      dapple track walk.npz points.npz --points plants.npz
      dapple track splash_meshes points.npz -n 2000 --keep-density
    """
    reporter = Reporter(json_out, quiet)
    if out.suffix.lower() != ".npz":
        raise click.ClickException(f"{out}: the points of all frames are written as .npz")
    check_usage(together, closed, sweeps, keep_density, fade, reach, masks)
    check_over_time(outside_over_time, together, masks)
    options.check_either(count, spacing, points)
    files = sequences.files_of(frames)
    check_outputs([*files, points, *masks.files], [out, reporter.file])
    motion = sequences.read(files, may_be_empty=keep_density)
    if not keep_density:
        motion = sequences.with_same_faces(motion)
    begin = sequences.first_with_faces(motion)
    loaded = meshes.load(
        replace(motion[begin][1], path=Path(motion[begin][0])),
        options=surface_options,
    )
    poses = [mesh.vertices for _, mesh in motion] if outside_over_time == ALL_FRAMES else []
    on_mesh = partial(masks.on, loaded.surface, loaded.mesh.path, count=count, spacing=spacing)
    masked = on_mesh(poses=poses)
    tracking = options.given(solver)
    sampling = {name: tracking[name] for name in START if name in tracking}
    sampling |= options.given({"seed": seed})
    if together:
        tracking |= options.given({"closed": closed, "sweeps": sweeps})
    tracking |= options.given({"fade": fade, "reach": reach})
    with Work("tracking", steps=2 if together else len(motion), quiet=quiet) as work:
        if points:
            first = masked.from_original(bound(loaded.surface, points))
            tracking |= of_classes(points, first)
        else:
            count = options.counted(masked.surface, count, spacing)
            first = work.run(partial(dapple.sample, masked.surface, count, **sampling))
        if keep_density:
            empty: list[Any] = [Nothing() for _ in motion[:begin]]
            results = empty + follow_population(
                work, loaded.surface, motion[begin:], first, tracking
            )
        elif outside_over_time == EACH_FRAME:
            results = follow_outside(work, on_mesh, masked, motion, first, tracking)
        else:
            follow = follow_together if together else follow_each
            found = follow(work, masked, motion, first, tracking)
            results = [
                masked.to_original(samples, mesh.vertices)
                for samples, (_, mesh) in zip(found, motion, strict=True)
            ]
    with replacing(out) as file:
        write_npz(file, (changing_arrays if keep_density else motion_arrays)(results))
    verb = "Population" if keep_density else "track_window" if together else "Tracker"
    settings = {
        "count": len(first),
        **options.given({"spacing": spacing}),
        "together": together,
        **masks.describe(),
        **options.given({"outside_over_time": outside_over_time}),
    } | options.library_defaults(verb)
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
        f"{out}: {len(first)} points on {len(motion)} frames{turnover(results, keep_density)}, the "
        f"last one: {of_last(results)}, farthest slide {slide:.3f} spacings"
        f"{loaded.doubled()}"
    )
    if profile:
        reporter.show_profile([samples.report for samples in results if len(samples)])


def check_usage(
    together: bool,
    closed: bool | None,
    sweeps: int | None,
    keep_density: bool,
    fade: int | None,
    reach: float | None,
    masks: Masks,
) -> None:
    """Raise UsageError for options that mean nothing together."""
    if not together and (closed or sweeps is not None):
        raise click.UsageError("--closed and --sweeps need --together")
    if not keep_density and (fade is not None or reach is not None):
        raise click.UsageError("--fade and --reach need --keep-density")
    if keep_density and together:
        raise click.UsageError("--keep-density goes frame by frame, so not --together")
    if keep_density and masks.given:
        raise click.UsageError("masks are of the first frame, so not with --keep-density")


def check_over_time(outside_over_time: str | None, together: bool, masks: Masks) -> None:
    """Raise UsageError where --outside-over-time means nothing."""
    if outside_over_time is not None and "outside" not in masks.given:
        raise click.UsageError("--outside-over-time needs --outside")
    if outside_over_time == EACH_FRAME and together:
        raise click.UsageError(f"{EACH_FRAME} goes frame by frame, so not with --together")


def of_last(results: Sequence[Any]) -> str:
    """Figures of the last frame that has points."""
    return figures(next(samples.report for samples in reversed(results) if len(samples)))


@dataclass
class NoReport:
    """The report of a frame without faces."""

    births: int = 0  # on the next frame that has some
    deaths: int = 0
    slide_max: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        return {"births": 0, "deaths": self.deaths}


@dataclass
class Nothing:
    """The samples of a frame without faces."""

    report: NoReport = field(default_factory=NoReport)

    def __len__(self) -> int:
        return 0

    def __getattr__(self, name: str) -> NDArray:
        shapes = {"positions": (0, 3), "normals": (0, 3), "barycentric": (0, 3), "fade": (0,)}
        if name in shapes:
            return np.empty(shapes[name])
        if name in ("faces", "ids", "classes"):
            return np.empty(0, np.int32)
        raise AttributeError(name)


def turnover(results: Sequence[Any], keep_density: bool) -> str:
    """How many points have appeared and vanished, where they may."""
    if not keep_density:
        return ""
    births = sum(samples.report.births for samples in results)
    return f", {births} appear, {sum(samples.report.deaths for samples in results)} vanish"


def of_classes(path: Path, first: dapple.Samples) -> dict[str, Any]:
    """How many points each class has, for the tracker, if there are several.

    Raises:
        ClickException: naming the first point of a class that is too large to count up to.
    """
    large = np.flatnonzero(first.classes > LARGEST_CLASS)
    if len(large):
        k = large[0]
        raise click.ClickException(
            f"{path}: class of point {k} is {first.classes[k]}: {LARGEST_CLASS} at most is needed"
        )
    counts = np.bincount(first.classes).tolist()
    return {"classes": counts} if len(counts) > 1 else {}


def follow_each(
    work: Work,
    masked: MaskedSurface,
    motion: Frames,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[dapple.Samples]:
    """Frame after frame."""
    tracker = dapple.Tracker(masked.surface, first, **given)
    results = [first]
    for name, mesh in motion[1:]:
        with about(name):
            results.append(work.run(partial(tracker.advance, masked.vertices(mesh.vertices))))
    return results


def follow_outside(
    work: Work,
    on_mesh: Callable[..., MaskedSurface],
    masked: MaskedSurface,
    motion: Frames,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[dapple.Samples]:
    """Frame after frame, each with the places that are outside there; on the original faces."""
    tracker = dapple.Tracker(masked.surface, first, **given)
    begin = masked.to_original(first)
    results, before = [begin], motion[0][1].vertices
    for name, mesh in motion[1:]:
        with about(name):
            masked = on_mesh(poses=[mesh.vertices])
            now, start = (placed_on(masked, samples) for samples in (results[-1], begin))
            tracker.resume_on(masked.surface, masked.vertices(before), now, start)
            found = work.run(partial(tracker.advance, masked.vertices(mesh.vertices)))
        before = mesh.vertices
        results.append(masked.to_original(found, before))
    return results


def placed_on(masked: MaskedSurface, samples: dapple.Samples) -> dapple.Samples:
    """Samples of any frame, at rest on the faces that the masks need."""
    who = {"ids": samples.ids, "classes": samples.classes}
    at_rest = dapple.Samples(masked.original, samples.faces, samples.barycentric, **who)
    return masked.from_original(at_rest)


def follow_population(
    work: Work,
    surface: dapple.Surface,
    motion: Frames,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[Any]:
    """Frame after frame, of any faces or none."""
    population: dapple.Population | None = dapple.Population(surface, first, **given)
    density, next_id = len(first) / surface.capacity, 0
    results: list[Any] = [first]
    last = motion[0][1]
    for name, mesh in motion[1:]:
        if len(mesh.faces) == 0:
            if population is not None:
                next_id = population.state["next_id"]
            population = None
            gone = int(np.count_nonzero(np.asarray(results[-1].fade) > 0.0))
            results.append(Nothing(NoReport(deaths=gone)))
            work.run(skipped)
            continue
        if sequences.same_polygons(mesh, last):
            mesh = replace(mesh, faces=last.faces)
        last = mesh
        next_surface = meshes.load(
            replace(mesh, path=Path(name)),
            options=meshes.SurfaceOptions.of(surface),
        ).surface
        with about(name):
            if population is None:
                population = work.run(partial(begun, next_surface, density, next_id, given))
                results[-1].report.births = len(population.samples)
                results.append(population.samples)
            else:
                results.append(work.run(partial(population.advance, next_surface)))
    return results


def skipped(context: dapple.Context) -> None:
    """A step in which nothing is to do."""
    context.check()


def begun(
    surface: dapple.Surface,
    density: float,
    next_id: int,
    given: dict[str, Any],
    context: dapple.Context,
) -> dapple.Population:
    """A population that appears on a surface, behind frames without faces.

    Raises:
        ValueError: there are classes.
    """
    if "classes" in given:
        raise ValueError(
            "follows a frame without faces: points of several classes cannot begin again there"
        )
    count = max(1, round(density * surface.capacity))
    sampling = {name: given[name] for name in START if name in given}
    found = dapple.sample(surface, count, seed=next_id, context=context, **sampling)
    ids = np.arange(next_id, next_id + count, dtype=np.int32)
    found = dapple.Samples(surface, found.faces, found.barycentric, ids=ids)
    population = dapple.Population(surface, found, **given)
    step = 1.0 / given.get("fade", options.library_defaults("Population")["fade"])
    state = population.state | {"fades": np.full(count, step), "densities": np.array([density])}
    population.resume(surface, population.samples, state)
    return population


def follow_together(
    work: Work,
    masked: MaskedSurface,
    motion: Frames,
    first: dapple.Samples,
    given: dict[str, Any],
) -> list[dapple.Samples]:
    """All frames at once."""
    frames = [masked.vertices(mesh.vertices) for _, mesh in motion[1:]]
    with about(motion[0][0]):
        return work.run(partial(dapple.track_window, masked.surface, first, frames, **given))
