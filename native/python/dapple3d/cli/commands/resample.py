# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple resample: another number of points, or another density."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import indices, options, points
from dapple3d.cli.masks import Command
from dapple3d.cli.output import Output, Source, point_options
from dapple3d.cli.report import figures


@click.command("resample", cls=Command, short_help="Another number of points, most of which stay.")
@click.argument("mesh", type=options.INPUT)
@click.argument("points_file", metavar="POINTS", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of points wanted, with those that stay.")
@click.option(
    "--locked",
    type=indices.IndicesType(),
    metavar=indices.METAVAR,
    help=f"Points that stay where they are. {indices.HELP}",
)
@point_options("resample")
def command(
    mesh: Path,
    points_file: Path,
    count: int | None,
    spacing: float | None,
    locked: NDArray[np.int64] | Path | None,
    source: Source,
    output: Output,
    **solver: Any,
) -> None:
    """Make COUNT points of POINTS on MESH, or follow another density, into OUT.

    Most points stay nearly where they are and keep their ids: some are taken out, or put into the
    widest gaps, and all are made even again. MESH, POINTS and OUT are as for 'sample' and
    'analyze'.

    \b
    Examples:
      dapple resample bunny.ply points.npz more.npz -n 3000
      dapple resample bunny.ply points.npz more.npz -n 3000 --locked 0-99,120
    """
    options.check_amount(count, spacing)
    output.check(source, [mesh, points_file, indices.file_of(locked)])
    loaded = source.load(mesh)
    masked = source.masks.on(loaded.surface, mesh, count=count, spacing=spacing)
    count = options.counted(masked.surface, count, spacing)
    before = points.bound(loaded.surface, points_file)
    kinds = np.unique(before.classes)
    if len(kinds) > 1:
        raise click.ClickException(
            f"{points_file}: holds points of {len(kinds)} classes, and resample knows one: use "
            "'dapple relax' with --class for each"
        )
    stay = indices.indices("--locked", locked, len(before), "points")
    chosen = options.given(solver)
    there = masked.from_original(before)
    solving = partial(dapple.resample, masked.surface, there, count, locked=stay, **chosen)
    samples = masked.to_original(output.run("sampling", solving))
    settings = {
        "count": count,
        **options.given({"spacing": spacing}),
        "locked": 0 if stay is None else len(stay),
        **source.masks.describe(),
        **options.library_defaults("resample"),
    }
    output.write(
        "resample",
        loaded,
        samples,
        f"{count} points of {len(before)}, {figures(samples.report)}",
        settings=settings | chosen,
        read={"points": str(points_file)},
    )
