# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple sample: points on a mesh."""

from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import meshes, options, points
from dapple3d.cli.attributes import with_attributes
from dapple3d.cli.files import check_outputs
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.work import Work

PRESETS: dict[str, dict[str, Any]] = {"default": {}, "paper": dapple.PAPER}


@click.command("sample", short_help="Points on a mesh, evenly spaced.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of points.")
@options.density_options
@options.attributes_option
@click.option(
    "--preset",
    type=click.Choice(list(PRESETS)),
    default="default",
    show_default=True,
    help="paper: as in Chen et al. 2012, from white noise by plain L-BFGS; the options "
    "below change it.",
)
@options.library_options("sample")
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
    attributes: bool,
    preset: str,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
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
    """
    reporter = Reporter(json_out, quiet)
    options.check_amount(count, spacing)
    points.check_extension(out)
    check_outputs([mesh, options.density_file(density)], [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    count = options.counted(loaded.surface, count, spacing)
    chosen = PRESETS[preset] | options.given(solver)
    with Work("sampling", quiet=quiet) as work:
        samples = work.run(partial(dapple.sample, loaded.surface, count, **chosen))
    found = points.points_of(samples)
    if attributes:
        found = with_attributes(loaded.mesh, samples, found)
    points.write_points(out, found)
    settings = {
        "count": count,
        **options.given({"spacing": spacing}),
        "preset": preset,
        **options.library_defaults("sample"),
    }
    reporter.store(
        "sample",
        input=loaded.describe(),
        output=str(out),
        settings=settings | chosen,
        report=samples.report.to_dict(),
    )
    reporter.say(f"{out}: {count} points, {figures(samples.report)}{loaded.doubled()}")
    if profile:
        reporter.show_profile([samples.report])
