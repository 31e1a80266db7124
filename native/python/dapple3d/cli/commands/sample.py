# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple sample: points on a mesh."""

from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import options
from dapple3d.cli.masks import Command
from dapple3d.cli.output import Output, Source, point_options
from dapple3d.cli.report import figures

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
@point_options("sample")
def command(
    mesh: Path,
    count: int | None,
    spacing: float | None,
    preset: str,
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
      dapple sample hills.obj trees.csv -n 5000 --slope 0 30 --distance road.obj 3 inf
    """
    options.check_amount(count, spacing)
    output.check(source, [mesh])
    loaded = source.load(mesh)
    masked = source.masks.on(loaded.surface, mesh, count=count, spacing=spacing)
    count = options.counted(masked.surface, count, spacing)
    chosen = PRESETS[preset] | options.given(solver)
    solving = partial(dapple.sample, masked.surface, count, **chosen)
    samples = masked.to_original(output.run("sampling", solving))
    settings = {
        "count": count,
        **options.given({"spacing": spacing}),
        "preset": preset,
        **source.masks.describe(),
        **options.library_defaults("sample"),
    }
    said = f"{count} points, {figures(samples.report)}"
    output.write("sample", loaded, samples, said, settings=settings | chosen)
