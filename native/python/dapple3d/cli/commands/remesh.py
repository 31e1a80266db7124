# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple remesh: the best triangle mesh of so many vertices, on one frame or on all of a motion."""

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click
import numpy as np

import dapple3d as dapple
from dapple3d.cli import meshes, options, sequences
from dapple3d.cli.files import about, check_outputs, listed, load_npz, unknown_format
from dapple3d.cli.ranges import Number
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work
from dapple3d.writing import replacing, write_npz

MESHES = (".off", ".obj", ".ply", ".stl")  # write_mesh() knows them
MOVING = ("vertices", "source_faces", "barycentric")
EMPTY_PLY = """\
ply
format ascii 1.0
element vertex 0
property double x
property double y
property double z
element face 0
property list uchar int vertex_indices
end_header
"""
ARRAYS = ("vertices", "faces", "source_faces", "barycentric", "features", "lines")


@click.command("remesh", short_help="An even triangle mesh of a mesh.")
@click.argument("mesh", type=options.FRAMES)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of vertices.")
@options.density_options
@options.library_options("remesh")
@click.option(
    "--least-angle",
    type=Number(0.0, 60.0),
    help="Of frames: vertices stay in their places of the surface where an angle below this would "
    "get smaller. Degrees; 20 by default.",
)
@options.surface_options
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    out: Path,
    count: int | None,
    spacing: float | None,
    density: str | None,
    density_at: meshes.Place | None,
    least_angle: float | None,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **chosen: Any,
) -> None:
    """Make a new triangle mesh of COUNT evenly spaced vertices on MESH, into OUT.

    Creases, corners and borders stay, and so does the topology: where it needs more vertices, the
    command says how many; --max-distance adds more. MESH is read as by 'sample'. OUT is .ply, .obj,
    .off, .stl or .npz, which also holds where each vertex lies on MESH.

    MESH may be a motion: a folder of meshes with the same polygons, or one .npz with 'vertices'
    (frames, v, 3) and 'faces' (m, 3). The mesh of its first frame then moves along, its vertices
    evenly spaced on each frame. OUT is an .npz: 'vertices' (frames, n, 3), 'source_faces' (frames,
    n), 'barycentric' (frames, n, 3), the same 'faces' for all, and 'reports' (frames,), JSON.

    Where the polygons differ from frame to frame, as of fluids, each frame has a mesh of its own:
    vertices stay where the surface does not change, and the spacing is that of the first one. OUT
    is then a folder, of one .ply for each frame, or an .npz of 'vertices_0', 'faces_0', 'ids_0'
    (the same number is the same vertex), 'source_faces_0', 'barycentric_0', 'features_0' and so on.

    \b
    Examples:
      dapple remesh bunny.ply even.ply -n 10000
      dapple remesh part.stl even.obj --spacing 0.5 --feature-angle 40
      dapple remesh part.stl even.obj -n 2000 --max-distance 0.01
      dapple remesh scan.ply near.ply -n 10000 --adaptive
      dapple remesh walk.npz even.npz -n 5000
      dapple remesh splash_meshes even_meshes -n 5000
    """
    reporter = Reporter(json_out, quiet)
    options.check_amount(count, spacing)
    motion, changing = motion_of(mesh)
    check_motion(motion, changing, out, least_angle)
    check_extension(out, changing)
    if changing:
        check_of_frames({"density": density} | options.given(chosen))
    files = sequences.files_of([mesh])
    check_outputs([*files, options.density_file(density)], [out, reporter.file])
    if changing:
        amount = (count, spacing)
        remesh_all(reporter, mesh, out, motion, amount, surface_options, profile, chosen)
        return
    first = replace(motion[0][1], path=mesh) if motion else meshes.read_mesh(mesh)
    loaded = meshes.load(first, density, density_at, surface_options)
    count = options.counted(loaded.surface, count, spacing)
    given = options.given(chosen)
    with Work("remeshing", steps=max(len(motion), 1), quiet=quiet) as work:
        made = work.run(partial(dapple.remesh, loaded.surface, count, **given))
        moved = follow(
            work, loaded.surface, made, motion, options.given({"least_angle": least_angle})
        )
    write(out, made, moved)
    reporter.store(
        "remesh",
        input=loaded.describe(),
        output=str(out),
        settings={
            "count": count,
            **options.given({"spacing": spacing}),
            **options.library_defaults("remesh"),
            **given,
            **options.given({"least_angle": least_angle}),
        },
        mesh=made.report.to_dict(),
        **({"frames": [frame.figures() for frame in moved]} if moved else {}),
    )
    reporter.say(f"{out}: {figures(made.report)}{motion_figures(moved)}{loaded.doubled()}")
    if profile:
        reporter.show_profile([made.report])


def check_extension(path: Path, changing: bool) -> None:
    """Raise ClickException unless a mesh, or all meshes, can be written to the file."""
    suffix = path.suffix.lower()
    if changing and not suffix:
        return
    if suffix not in (*MESHES, ".npz"):
        known = listed((*MESHES, ".npz"))
        raise click.ClickException(f"{path}: {unknown_format(path)}; meshes are written as {known}")


def motion_of(path: Path) -> tuple[sequences.Frames, bool]:
    """The frames of a motion, and whether they have polygons of their own; no frames if the file is
    one mesh. Otherwise all have the faces of the first.

    Raises:
        ClickException: naming the file or frame and what is wrong with it.
    """
    if not path.is_dir():
        if path.suffix.lower() != ".npz":
            return [], False
        arrays = load_npz(path)
        numbered = any(sequences.NUMBERED.fullmatch(name) for name in arrays)
        if not numbered and np.ndim(arrays.get("vertices", 0)) != 3:
            return [], False
    frames = sequences.read(sequences.files_of([path]), may_be_empty=True)
    sequences.first_with_faces(frames)
    try:
        return sequences.with_same_faces(frames), False
    except click.ClickException:
        return frames, True


def check_motion(
    motion: sequences.Frames, changing: bool, out: Path, least_angle: float | None
) -> None:
    """Refuse what does not fit a motion, or has no effect without one.

    Raises:
        UsageError: an angle without frames of the same faces.
        ClickException: frames that are not written as npz, or into a folder.
    """
    if changing and out.suffix.lower() not in ("", ".npz"):
        raise click.ClickException(
            f"{out}: the frames have different polygons, so that their meshes are written into a "
            "folder, or as .npz"
        )
    if motion and not changing and out.suffix.lower() != ".npz":
        raise click.ClickException(f"{out}: the meshes of all frames are written as .npz")
    if least_angle is not None and (changing or not motion):
        raise click.UsageError(
            "--least-angle needs a motion: a folder of meshes with the same polygons, or an .npz "
            "of all"
        )


def check_of_frames(given: dict[str, Any]) -> None:
    """Raise UsageError for an option that frames with different polygons do not have."""
    known = {one.name for one in dapple.option_table("remesh_next")}
    for name, value in given.items():
        if value is not None and name not in known:
            raise click.UsageError(
                f"--{name.replace('_', '-')} is for one mesh: these frames have different polygons"
            )


def remesh_all(
    reporter: Reporter,
    source: Path,
    out: Path,
    motion: sequences.Frames,
    amount: tuple[int | None, float | None],
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    chosen: dict[str, Any],
) -> None:
    """Remesh frames whose polygons differ, and write and report all.

    Args:
        amount: count and spacing, one of which is given.
        chosen: options of the library that are given, or None.
    """
    given = options.given(chosen)
    begin = sequences.first_with_faces(motion)
    loaded = meshes.load(
        replace(motion[begin][1], path=Path(motion[begin][0])), options=surface_options
    )
    count = options.counted(loaded.surface, *amount)
    with Work("remeshing", steps=len(motion), quiet=reporter.quiet) as work:
        sequence = work.run(partial(dapple.MeshSequence, loaded.surface, count, **given))
        found: list[dapple.SequenceMesh | None] = [None] * begin + [sequence.first]
        for name, mesh in motion[begin + 1 :]:
            surface = None
            if len(mesh.faces):
                surface = meshes.load(
                    replace(mesh, path=Path(name)), options=surface_options
                ).surface
            with about(name):
                found.append(work.run(partial(sequence.advance, surface)))
    if out.suffix:
        write_changing(out, found)
    else:
        write_folder(out, motion, found)
    made = [one for one in found if one is not None]
    reporter.store(
        "remesh",
        input=loaded.describe() | {"frames": [name for name, _ in motion]},
        output=str(out),
        settings={
            "count": count,
            **options.given({"spacing": amount[1]}),
            **options.library_defaults("remesh_next"),
            **given,
        },
        frames=[one.figures() if one else {} for one in found],
    )
    reporter.say(f"{out}: {sequence_figures(found)}{loaded.doubled()}")
    if profile:
        reporter.show_profile([one.mesh.report for one in made])


def write_changing(path: Path, frames: Sequence[dapple.SequenceMesh | None]) -> None:
    """The meshes of all frames as one npz; the file is complete or not written."""
    arrays: dict[str, Any] = {}
    for k, frame in enumerate(frames):
        if frame is None:
            arrays |= {f"vertices_{k}": np.empty((0, 3)), f"faces_{k}": np.empty((0, 3), np.int32)}
            continue
        arrays |= {f"{name}_{k}": np.asarray(getattr(frame.mesh, name)) for name in ARRAYS}
        arrays[f"ids_{k}"] = frame.ids
    arrays["reports"] = np.array([json.dumps(one.figures() if one else {}) for one in frames])
    with replacing(path) as file:
        write_npz(file, arrays)


def write_folder(
    path: Path, motion: sequences.Frames, frames: Sequence[dapple.SequenceMesh | None]
) -> None:
    """One PLY file for each frame, with the name of its file; those of an npz are numbered. The
    folder is complete or not written.
    """
    width = len(str(len(frames) - 1))
    with TemporaryDirectory(dir=path.parent) as draft:
        folder = Path(draft) / "meshes"
        folder.mkdir()
        for k, ((name, mesh), frame) in enumerate(zip(motion, frames, strict=True)):
            stem = Path(name).stem if str(mesh.path) == name else f"{k:0{width}}"
            file = folder / f"{stem}.ply"
            if frame is None:
                file.write_text(EMPTY_PLY, encoding="ascii")
            else:
                dapple.write_mesh(file, frame.mesh.vertices, frame.mesh.faces)
        folder.rename(path)


def sequence_figures(frames: Sequence[dapple.SequenceMesh | None]) -> str:
    """How many vertices the frames have, how many stay, and what is not as asked."""
    made = [one for one in frames if one is not None]
    counts = [len(one.ids) for one in made]
    later = sum(counts[1:])
    kept = 100 * sum(one.kept for one in made[1:]) / later if later else 100
    worst = min(one.mesh.report.smallest_angle for one in made)
    words = (
        f"{len(frames)} frames with {min(counts)} to {max(counts)} vertices, of which {kept:.0f} % "
        f"stay from frame to frame, angles from {worst:.1f} degrees"
    )
    flaws = sum(one.mesh.report.flaws for one in made)
    if flaws:
        words += f"; in {flaws} places of all frames the topology is not that of the surface"
    return words


def follow(
    work: Work,
    surface: dapple.Surface,
    mesh: dapple.RemeshResult,
    motion: sequences.Frames,
    given: dict[str, Any],
) -> list[dapple.MovedMesh]:
    """The mesh on all frames; none without a motion."""
    if not motion:
        return []
    tracker = dapple.MeshTracker(surface, mesh, **given)
    found = [tracker.first]
    for name, frame in motion[1:]:
        with about(name):
            found.append(work.run(partial(tracker.advance, frame.vertices)))
    return found


def motion_figures(frames: Sequence[dapple.MovedMesh]) -> str:
    """How good the triangles are on the worst frame."""
    if not frames:
        return ""
    worst = max(range(len(frames)), key=lambda k: (frames[k].below_15, frames[k].flipped))
    words = f"; {len(frames)} frames"
    if not frames[worst].below_15:
        return f"{words}, no triangle below 15 degrees"
    return (
        f"{words}, at most {frames[worst].below_15} triangles below 15 degrees and "
        f"{frames[worst].flipped} turned over, on frame {worst}"
    )


def write(path: Path, mesh: dapple.RemeshResult, frames: Sequence[dapple.MovedMesh] = ()) -> None:
    """Write in the format of the extension; the file is complete or not written."""
    if path.suffix.lower() != ".npz":
        dapple.write_mesh(path, mesh.vertices, mesh.faces)
        return
    arrays = {name: np.asarray(getattr(mesh, name)) for name in ARRAYS}
    if frames:
        arrays |= {name: np.stack([getattr(one, name) for one in frames]) for name in MOVING}
        arrays["reports"] = np.array([json.dumps(one.figures()) for one in frames])
    with replacing(path) as file:
        write_npz(file, arrays)


def figures(report: dapple.RemeshReport) -> str:
    """The figures of the mesh, and what is not as asked."""
    words = (
        f"{report.vertices} vertices, {report.faces} triangles, angles from "
        f"{report.smallest_angle:.1f} degrees, {100 * report.valence_6:.0f} % of the vertices "
        "have six neighbors"
    )
    if report.vertices > report.asked:
        needs = "the distance needs" if report.distance else "the topology needs"
        words += f"; {needs} {report.vertices - report.asked} more than asked for"
    if report.distance:
        words += f"; at most {report.distance:.3g} from the surface"
    if report.dropped_lines:
        words += f"; {report.dropped_lines} creases were given up"
    if report.self_intersecting:
        words += f"; {report.self_intersecting} triangles pass through others"
    if report.flaws:
        words += f"; in {report.flaws} places the topology is not that of the surface"
    return words
