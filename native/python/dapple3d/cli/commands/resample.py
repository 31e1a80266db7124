# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple resample: another number of points, or another density."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import indices, meshes, options, points
from dapple3d.cli.attributes import with_attributes
from dapple3d.cli.files import check_outputs
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.work import Work


@click.command("resample", short_help="Another number of points, most of which stay.")
@click.argument("mesh", type=options.INPUT)
@click.argument("source", metavar="POINTS", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of points wanted, with those that stay.")
@click.option(
    "--locked",
    type=indices.IndicesType(),
    metavar=indices.METAVAR,
    help=f"Points that stay where they are. {indices.HELP}",
)
@options.density_options
@options.attributes_option
@options.library_options("resample")
@options.surface_options
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    source: Path,
    out: Path,
    count: int | None,
    spacing: float | None,
    locked: NDArray[np.int64] | Path | None,
    density: str | None,
    density_at: meshes.Place | None,
    attributes: bool,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
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
    reporter = Reporter(json_out, quiet)
    options.check_amount(count, spacing)
    points.check_extension(out)
    inputs = [mesh, source, options.density_file(density), indices.file_of(locked)]
    check_outputs(inputs, [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    count = options.counted(loaded.surface, count, spacing)
    before = points.bound(loaded.surface, source)
    stay = indices.indices("--locked", locked, len(before), "points")
    chosen = options.given(solver)
    solving = partial(dapple.resample, loaded.surface, before, count, locked=stay, **chosen)
    with Work("sampling", quiet=quiet) as work:
        samples = work.run(solving)
    found = points.points_of(samples)
    points.write_points(out, with_attributes(loaded.mesh, samples, found) if attributes else found)
    settings = {
        "count": count,
        **options.given({"spacing": spacing}),
        "locked": 0 if stay is None else len(stay),
        **options.library_defaults("resample"),
    }
    reporter.store(
        "resample",
        input={**loaded.describe(), "points": str(source)},
        output=str(out),
        settings=settings | chosen,
        report=samples.report.to_dict(),
    )
    reporter.say(
        f"{out}: {count} points of {len(before)}, {figures(samples.report)}{loaded.doubled()}"
    )
    if profile:
        reporter.show_profile([samples.report])
