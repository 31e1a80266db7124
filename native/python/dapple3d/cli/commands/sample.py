# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple sample: points on a mesh."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np

import dapple3d as dapple
from dapple3d.cli import options
from dapple3d.cli.files import about
from dapple3d.cli.masks import Command
from dapple3d.cli.output import Output, Source, point_options
from dapple3d.cli.report import figures

AXES = ("x", "y", "z")
PRESETS: dict[str, dict[str, Any]] = {"default": {}, "paper": dapple.PAPER}


@click.command("sample", cls=Command, short_help="Points on a mesh, evenly spaced.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of points.")
@click.option(
    "--preset",
    type=click.Choice(list(PRESETS)),
    default="default",
    show_default=True,
    help="paper: as in Chen et al. 2012, from white noise by plain L-BFGS; the options "
    "below change it.",
)
@click.option(
    "--symmetry",
    type=click.Choice(AXES),
    help="Points in pairs of mirror images along this axis. A point also has its 'mirror', the "
    "index of its image; its own on the plane.",
)
@click.option(
    "--symmetry-at",
    type=float,
    help="Where the plane of symmetry crosses its axis, in the mesh's units.  [default: 0]",
)
@options.library_options("sample_symmetric", only=["max_mirror_error"], before="With --symmetry: ")
@point_options("sample")
def command(
    mesh: Path,
    count: int | None,
    spacing: float | None,
    preset: str,
    symmetry: str | None,
    symmetry_at: float | None,
    max_mirror_error: float | None,
    source: Source,
    output: Output,
    **solver: Any,
) -> None:
    """Put COUNT points on MESH, evenly spaced and unpatterned, into OUT.

    MESH is .ply, .obj, .stl, .off, .glb, .gltf or .npz (arrays 'vertices' (v, 3) and 'faces'
    (m, 3), others for --density and --attributes). OUT is .ply or .csv (positions, normals, ids,
    classes), .npz (also the face and the barycentric coordinates of each point), .obj or .off
    (positions and normals); --attributes adds to each what it has room for. Numbers keep
    all their digits.

    \b
    Examples:
      dapple sample bunny.ply points.ply -n 2000
      dapple sample bunny.ply points.ply --spacing 0.004
      dapple sample bunny.npz points.csv -n 2000 --density fur --json report.json
      dapple sample body.obj scales.ply -n 1000 --symmetry x
      dapple sample hills.obj trees.csv -n 5000 --slope 0 30 --distance road.obj 3 inf
    """
    options.check_amount(count, spacing)
    mirrored = options.given({"symmetry_at": symmetry_at, "max_mirror_error": max_mirror_error})
    if symmetry is None and mirrored:
        raise click.UsageError("--symmetry-at and --max-mirror-error need --symmetry")
    output.check(source, [mesh])
    loaded = source.load(mesh)
    masked = source.masks.on(loaded.surface, mesh, count=count, spacing=spacing)
    count = options.counted(masked.surface, count, spacing)
    chosen = PRESETS[preset] | options.given(solver)
    more: dict[str, Any] = {}
    if symmetry is None:
        solving = partial(dapple.sample, masked.surface, count, **chosen)
        samples = masked.to_original(output.run("sampling", solving))
        report = samples.report
    else:
        pairs = partial(in_pairs, masked.surface, count, symmetry, **mirrored, **chosen)
        with about(f"{mesh}, with --symmetry {symmetry}"):
            made = output.run("sampling", pairs)
        report = made.samples.report
        samples = masked.pairs_to_original(made, **plane_across(symmetry, symmetry_at or 0.0))
        more = {"arrays": {"mirror": made.mirror}, "mirror_error": made.mirror_error}
        mirrored["symmetry"] = symmetry
    settings = {
        "count": count,
        **options.given({"spacing": spacing}),
        "preset": preset,
        **source.masks.describe(),
        **options.library_defaults("sample"),
    }
    said = f"{count} points, {figures(report)}"
    settings |= mirrored | chosen
    output.write("sample", loaded, samples, said, settings=settings, report=report, **more)


def in_pairs(
    surface: dapple.Surface, count: int, axis: str, symmetry_at: float = 0.0, **options: Any
) -> dapple.SymmetricSamples:
    """Samples in pairs of mirror images along an axis."""
    plane = plane_across(axis, symmetry_at)
    return dapple.sample_symmetric(surface, count, **plane, **options)


def plane_across(axis: str, at: float) -> dict[str, Any]:
    """The plane of symmetry across an axis."""
    normal = np.eye(3)[AXES.index(axis)]
    return {"normal": normal, "point": at * normal}
