# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple mosaic: the cells of points as tiles."""

import warnings
from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import meshes, options, polygons
from dapple3d.cli.files import check_outputs
from dapple3d.cli.points import bound
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work

GROUT = 0.1  # spacings


@click.command("mosaic", short_help="Tiles over a mesh.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of tiles, around new points.")
@click.option(
    "--points",
    type=options.INPUT,
    help="Tiles around these instead; those in the way of none are bound where the mesh is "
    "nearest.",
)
@options.density_options
@click.option(
    "--grout",
    type=options.NOT_NEGATIVE,
    help=f"Width of the gap, in the mesh's units.  [default: {GROUT} spacings]",
)
@options.library_options("mosaic", only=["thickness", "shortest_edge"])
@options.library_options("sample")
@options.surface_options
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    out: Path,
    count: int | None,
    spacing: float | None,
    points: Path | None,
    density: str | None,
    density_at: meshes.Place | None,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **chosen: Any,
) -> None:
    """Cover MESH with tiles, the Voronoi cells of COUNT points or of a file's, into OUT.

    MESH and --points are read as by 'sample' and 'analyze'. OUT is .ply (polygons with the
    properties cell, class and side: 0 top, 1 wall, 2 bottom), .obj (groups cell_..., materials
    class_...), .off, .stl (triangles) or .npz.

    \b
    Examples:
      dapple mosaic bunny.ply tiles.ply -n 800 --thickness 0.001
      dapple mosaic bunny.ply tiles.obj --points plants.npz --grout 0
    """
    reporter = Reporter(json_out, quiet)
    polygons.check_extension(out)
    options.check_either(count, spacing, points)
    if profile and points:
        raise click.UsageError("--profile needs --count: nothing is solved for --points")
    check_outputs([mesh, points, options.density_file(density)], [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    names = ("grout", "thickness", "shortest_edge")
    shape = options.given({name: chosen.pop(name) for name in names})
    given = options.given(chosen)
    with Work("tiling", steps=2, quiet=quiet) as work:
        if points:
            samples = bound(loaded.surface, points)
        else:
            count = options.counted(loaded.surface, count, spacing)
            samples = work.run(partial(dapple.sample, loaded.surface, count, **given))
        shape.setdefault("grout", GROUT * samples.report.spacing)
        tiling = {name: given[name] for name in ("cells", "threads") if name in given} | shape
        merge = not polygons.needs_convex(out)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # about empty tiles, reported below
            made = work.run(partial(dapple.mosaic, loaded.surface, samples, merge=merge, **tiling))
    if made.empty == len(samples):
        raise click.ClickException(
            f"{out}: all {len(samples)} tiles are empty, so it was not written: the grout of "
            f"{shape['grout']:.6g} is wider than the cells, whose sites are about "
            f"{samples.report.spacing:.6g} apart"
        )
    polygons.write_tiles(out, made, samples.ids)
    reporter.store(
        "mosaic",
        input={**loaded.describe(), "points": str(points) if points else None},
        output=str(out),
        settings={
            "count": len(samples),
            **options.given({"spacing": spacing}),
            **options.library_defaults("mosaic"),
            **given,
        }
        | tiling,
        tiles=summary(made),
    )
    if made.empty:
        reporter.say(
            f"{out}: {made.empty} of {len(samples)} tiles are empty: the grout of "
            f"{shape['grout']:.6g} takes all of them"
        )
    left = 100 * made.areas.sum() / made.cell_areas.sum()
    reporter.say(
        f"{out}: {len(samples)} tiles of {len(made)} polygons, {left:.1f} % of the area"
        f"{loaded.doubled()}"
    )
    if profile:
        reporter.show_profile([samples.report])


def summary(made: dapple.Mosaic) -> dict[str, Any]:
    """What became of the cells."""
    return {
        "polygons": len(made),
        "cell_area": float(made.cell_areas.sum()),
        "area": float(made.areas.sum()),
        "with_one_loop": int(((made.parts == 1) & (made.loops == 1)).sum()),
        "with_holes": int((made.loops > made.parts).sum()),
        "in_several_parts": int((made.parts > 1).sum()),
        "closed": int(((made.parts > 0) & (made.loops == 0)).sum()),
        "lost_to_the_grout": made.empty,
    }
