# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple lines: points along the creases and borders of a mesh."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import meshes, options, points
from dapple3d.cli.files import check_outputs
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work


@click.command("lines", short_help="Points along the creases and borders of a mesh.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@click.option("-n", "--count", type=options.COUNT, help="Number of points.")
@click.option(
    "--spacing",
    type=options.SPACING,
    help="Instead of a number: the mean distance along lines, in the mesh's units.",
)
@options.density_options
@options.library_options("sample_lines")
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
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **chosen: Any,
) -> None:
    """Put COUNT points on the creases and borders of MESH, into OUT.

    MESH is read and OUT is written as by 'sample'; a point also has its 'tangents', the direction
    of its line, and 'lines', which one it is on.

    \b
    Examples:
      dapple lines part.stl rivets.csv -n 500
      dapple lines field.obj posts.csv --spacing 2.5 --corners --feature-angle 180
    """
    reporter = Reporter(json_out, quiet)
    points.check_extension(out)
    options.check_amount(count, spacing)
    check_outputs([mesh, options.density_file(density)], [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    given = options.given(chosen)
    with Work("sampling", quiet=quiet) as work:
        if count is None:
            count = counted(loaded.surface, spacing, given)
        made = work.run(partial(dapple.sample_lines, loaded.surface, count, **given))
    found = points.points_of(made.samples)
    points.write_points(
        out, replace(found, attributes={"tangents": made.tangents, "lines": made.lines})
    )
    reporter.store(
        "lines",
        input=loaded.describe(),
        output=str(out),
        settings={
            "count": count,
            **options.given({"spacing": spacing}),
            **options.library_defaults("sample_lines"),
            **given,
        },
        lines=len(made.lengths),
        length=float(made.lengths.sum()),
        report=made.samples.report.to_dict(),
    )
    reporter.say(f"{out}: {count} points on {len(made.lengths)} lines{loaded.doubled()}")
    if profile:
        reporter.show_profile([made.samples.report])


def counted(surface: dapple.Surface, spacing: float | None, given: dict[str, Any]) -> int:
    """How many points there are at so much from each to the next along all lines."""
    length = dapple.sample_lines(surface, 1, **{**given, "corners": False}).lengths.sum()
    most = options.COUNT.max
    assert spacing is not None
    assert most is not None
    return int(max(1, min(round(length / spacing), most)))
