# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple export: points, still or moving, for other programs."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from dapple3d import instances
from dapple3d.cli import meshes, motions, options, points
from dapple3d.cli.files import about, check_outputs
from dapple3d.cli.ranges import Number, Whole
from dapple3d.cli.report import Reporter
from dapple3d.extras import gltf, godot, usd

POSITIVE = Number(0.0, finite=True, open_below=True)
OF_GODOT = (*godot.SUFFIXES, *(one for one in godot.MESHES if one != ".obj"))  # not converted
SCENE = {"fps": 24.0, "up": "Z", "meters_per_unit": 1.0}
NAMED = re.compile(r"(?P<path>.*\.(usd[acz]?|glb|gltf))(?::(?P<prim>.+))?", re.IGNORECASE)


class PrototypeType(click.ParamType):
    """FILE[:PRIM]."""

    name = "prototype"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> instances.Reference:
        """Tell the file from the prim in it."""
        found = NAMED.fullmatch(value)
        path = Path(found["path"] if found else value)
        if not (path.is_file() or value.startswith(godot.PROJECT)):
            self.fail(f"'{path}': there is no such file", param, ctx)
        return instances.Reference(path, (found["prim"] or "") if found else "")


@click.command("export", short_help="Points for other programs: USD, glTF, Godot and others.")
@click.argument("source", metavar="POINTS", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@click.option(
    "--prototype",
    "prototypes",
    type=PrototypeType(),
    multiple=True,
    metavar="FILE[:PRIM]",
    help="What stands at the points, once for each class: a mesh (.ply .obj .stl .off), which OUT "
    "holds; for USD a prim of a USD file, which OUT refers to, by default its default prim; for "
    "glTF a node of a glTF file, which OUT holds, by default all; for Godot a .res, .tres or .mesh "
    "file or a path res://..., which OUT refers to.  [default: balls]",
)
@click.option("--frame", type=Whole(1), help="Only this one, counted from 1.")
@click.option("--start", type=int, help="Number of the first frame.  [default: as in POINTS, or 1]")
@click.option("--fps", type=POSITIVE, help="Frames in a second.  [default: as in POINTS, or 24]")
@click.option(
    "--up",
    type=click.Choice(["Y", "Z"], case_sensitive=False),
    help="The axis of POINTS that points up.  [default: as in POINTS, or Z]",
)
@click.option(
    "--meters-per-unit",
    type=POSITIVE,
    help="Length of a unit of POINTS.  [default: as in POINTS, or 1]",
)
@click.option(
    "--scale", type=POSITIVE, help="Size of what stands at the points, times the scales of POINTS."
)
@options.report_options
def command(
    source: Path,
    out: Path,
    prototypes: tuple[instances.Reference, ...],
    frame: int | None,
    start: int | None,
    fps: float | None,
    up: instances.Up | None,
    meters_per_unit: float | None,
    scale: float | None,
    json_out: str | None,
    quiet: bool,
) -> None:
    """Write POINTS, still or in motion, to OUT for another program.

    POINTS is what `dapple sample`, `classes` or `track` has written, or USD or glTF. OUT is
    .usd, .usda or .usdc: a PointInstancer with ids, classes, orientations (along the normals, if
    POINTS has none), scales and velocities, with time samples for a motion. Or it is .glb or .gltf:
    nodes with EXT_mesh_gpu_instancing. Or it is .tscn: a scene of Godot 4, with the meshes of
    prototypes in a folder beside it. All these round numbers to 32 bits. Or it is .ply, .csv,
    .npz, .obj or .off. A motion fits into USD and .npz.

    \b
    Examples:
      dapple export points.ply points.usda
      dapple export walk.npz walk.usdc --fps 25 --prototype fern.usd --prototype rocks.usd:/Rock_3
      dapple export plants.csv plants.glb --prototype plants.glb:Fern --prototype rock.ply
      dapple export plants.csv plants.tscn --prototype fern.ply --prototype res://rock.tres
      dapple export walk.usdc frame_10.csv --frame 10
    """
    reporter = Reporter(json_out, quiet)
    suffix = points.check_extension(out)
    check_outputs([source, *(one.path for one in prototypes)], [out, reporter.file])
    motion = chosen(motions.read(source), source, frame, start)
    if scale is not None:
        motion = replace(motion, frames=[motions.scaled(one, scale) for one in motion.frames])
    given = options.given({"fps": fps, "up": up, "meters_per_unit": meters_per_unit})
    scene = SCENE | motion.scene | given
    if suffix in points.SCENES:
        write_scene(out, motion, source, [prototype(one, out) for one in prototypes], scene)
    elif prototypes:
        raise click.UsageError(f"--prototype: {suffix} holds points alone")
    else:
        write_points(out, motion, source)
    counts = [len(one.positions) for one in motion.frames]
    reporter.store(
        "export",
        input=str(source),
        output=str(out),
        settings={
            "prototypes": [f"{one.path}{':' * bool(one.prim)}{one.prim}" for one in prototypes],
            "frame": frame,
            "scale": scale,
            **scene,
        },
        points=counts,
    )
    moving = f" on {len(counts)} frames" if len(counts) > 1 else ""
    reporter.say(f"{out}: {max(counts)} points{moving}")


def chosen(
    motion: motions.Motion, source: Path, frame: int | None, start: int | None
) -> motions.Motion:
    """The chosen frame, or all frames, with their numbers.

    Raises:
        ClickException: there is no such frame.
    """
    count = len(motion.frames)
    if frame is not None:
        if frame > count:
            raise click.ClickException(f"{source}: has {count} frames, so there is no {frame}")
        return motions.Motion(motion.frames[frame - 1 : frame], scene=motion.scene)
    if start is None:
        return motion
    times = np.arange(1.0 * count) if motion.times is None else motion.times - motion.times[0]
    return replace(motion, times=start + times)


def prototype(given: instances.Reference, out: Path) -> instances.Reference | instances.Mesh:
    """A file of the format of OUT as it is, of a mesh what it holds.

    Raises:
        ClickException: it is of another format.
    """
    kinds = [
        suffixes
        for suffixes in ((*usd.SUFFIXES, ".usdz"), gltf.SUFFIXES, OF_GODOT)
        if given.path.suffix.lower() in suffixes
    ]
    if given.path.parts[0] == "res:":
        kinds = [godot.SUFFIXES]
    if kinds and out.suffix.lower() in kinds[0]:
        return given
    if kinds:
        raise click.ClickException(f"{given.path}: cannot stand in {out.suffix}, another format")
    mesh = meshes.read_mesh(given.path)
    return instances.Mesh(mesh.vertices, mesh.faces)


def write_scene(
    out: Path,
    motion: motions.Motion,
    source: Path,
    prototypes: list[instances.Reference | instances.Mesh],
    scene: dict[str, Any],
) -> None:
    """In a format that also holds what stands at the points; with velocities, if they move.

    Raises:
        ClickException: OUT is not USD, so it holds a single frame, but there are several.
    """
    with about(source):
        frames = [points.instances_of(one) for one in motion.frames]
        frames = instances.along_normals(frames, up=scene["up"])
    if len(frames) > 1:
        frames = instances.with_velocities(frames, scene["fps"])
    place = {"up": scene["up"], "meters_per_unit": scene["meters_per_unit"]}
    with about(out):
        if out.suffix.lower() in usd.SUFFIXES:
            fps = scene["fps"]
            usd.write(out, frames, times=motion.times, fps=fps, prototypes=prototypes, **place)
        else:
            check_single(out, motion, source)
            module = points.SCENES[out.suffix.lower()]
            module.write(out, frames[0], prototypes=prototypes, **place)


def check_single(out: Path, motion: motions.Motion, source: Path) -> None:
    """Raise ClickException if there are several frames."""
    if len(motion.frames) > 1:
        raise click.ClickException(
            f"{out}: {source} has {len(motion.frames)} frames, and {out.suffix} holds one: choose "
            "it by --frame, or write .npz or USD"
        )


def write_points(out: Path, motion: motions.Motion, source: Path) -> None:
    """In a format that holds points alone."""
    if len(motion.frames) > 1 and out.suffix.lower() == ".npz":
        motions.write_npz_motion(out, motion.frames)
    else:
        check_single(out, motion, source)
        points.write_points(out, motion.frames[0])
