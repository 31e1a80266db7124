# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple relax: points made even again where something has changed."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import indices, meshes, options, points
from dapple3d.cli.commands.classes import CLASS_METAVAR, Wanted, WantedType, classes_on
from dapple3d.cli.files import about
from dapple3d.cli.masks import Command
from dapple3d.cli.output import Output, Source, point_options
from dapple3d.cli.report import figures, is_measured


@click.command(
    "relax", cls=Command, short_help="Points made even again where something has changed."
)
@click.argument("mesh", type=options.INPUT)
@click.argument("points_file", metavar="POINTS", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@click.option(
    "--before",
    type=options.INPUT,
    help="MESH as it was when POINTS were made: what differs has changed.",
)
@click.option(
    "--density-before",
    metavar="FILE.npy|NAME",
    help="The density then, as --density.  [default: as --density of the mesh then]",
)
@click.option(
    "--changed",
    type=indices.IndicesType(),
    metavar=indices.METAVAR,
    help=f"Faces of MESH where something has changed. {indices.HELP}",
)
@click.option(
    "-n",
    "--count",
    type=options.COUNT,
    help="Number of points wanted: the difference comes and goes where something has changed.  "
    "[default: as the points around ask for]",
)
@click.option(
    "--class",
    "wanted",
    type=WantedType(),
    multiple=True,
    metavar=CLASS_METAVAR,
    help="Once for each class of POINTS, in their order, as for `dapple classes`: what it is to "
    "be. Rare classes come first, the others make room.",
)
@click.option(
    "--locked",
    type=indices.IndicesType(),
    metavar=indices.METAVAR,
    help=f"Points that stay where they are. {indices.HELP}",
)
@point_options("relax")
def command(
    mesh: Path,
    points_file: Path,
    before: Path | None,
    density_before: str | None,
    changed: NDArray[np.int64] | Path | None,
    count: int | None,
    wanted: tuple[Wanted, ...],
    locked: NDArray[np.int64] | Path | None,
    source: Source,
    output: Output,
    **solver: Any,
) -> None:
    """Make POINTS on MESH even again where something has changed, into OUT.

    Only points near the change move, come or go; all others stay where they are. To say what has
    changed, give the mesh as it was (--before) or its density then (--density-before), or name the
    faces (--changed). MESH, POINTS and OUT are as for 'sample' and 'analyze'.

    \b
    Examples:
      dapple relax hills.npz points.npz new.npz --density road --density-before plain
      dapple relax dented.ply points.npz new.npz --before round.ply
      dapple relax hills.npz plants.npz new.npz --density road --density-before plain
        --class 50:radius=1 --class 2000
    """
    if (changed is None) == (before is None and density_before is None):
        raise click.UsageError("give either --changed, or --before and --density-before")
    files = [mesh, points_file, before, options.density_file(density_before)]
    files += [options.density_file(one.density) for one in wanted]
    output.check(source, [*files, indices.file_of(changed), indices.file_of(locked)])
    loaded = source.load(mesh)
    surface = loaded.surface
    if changed is None:
        then = surface_before(loaded, before, density_before or source.density, source.density_at)
        where = dapple.changed_faces(then, surface)
    else:
        then, found = surface, indices.indices("--changed", changed, len(surface.faces), "faces")
        assert found is not None
        where = found
    old = points.bound(then, points_file)
    old = dapple.Samples(surface, old.faces, old.barycentric, ids=old.ids, classes=old.classes)
    kinds = np.unique(old.classes)
    if len(kinds) > 1 and not wanted:
        raise click.ClickException(
            f"{points_file}: holds points of {len(kinds)} classes: give --class for each"
        )
    stay = indices.indices("--locked", locked, len(old), "points")
    masked, classes = classes_on(wanted, loaded, source, count or len(old))
    chosen = options.given(solver)
    solving = partial(
        dapple.relax,
        masked.surface,
        masked.from_original(old),
        np.flatnonzero(np.isin(masked.pieces[0], where)),
        classes=classes or None,
        count=count,
        locked=stay,
        **chosen,
    )
    samples = masked.to_original(output.run("relaxing", solving))
    settings = {
        "count": count,
        "classes": [one.settings(made.count) for one, made in zip(wanted, classes, strict=True)],
        "locked": 0 if stay is None else len(stay),
        **source.masks.describe(),
        **options.library_defaults("relax"),
    }
    said = f"{len(samples)} points of {len(old)}, {len(where)} faces changed"
    if is_measured(samples.report):
        said += f", {figures(samples.report)} there"
    output.write(
        "relax",
        loaded,
        samples,
        said,
        settings=settings | chosen,
        read={"points": str(points_file), "before": str(before or mesh)},
        changed_faces=len(where),
    )


def surface_before(
    loaded: meshes.Loaded, path: Path | None, density: str | None, at: meshes.Place | None
) -> dapple.Surface:
    """The surface as it was, of the same faces.

    Raises:
        ClickException: its faces are others, or what load() raises.
    """
    mesh = loaded.mesh if path is None else meshes.read_mesh(path)
    with about(mesh.path):
        if not np.array_equal(mesh.faces, loaded.mesh.faces):
            raise ValueError(f"its faces are not those of {loaded.mesh.path}")
        moved = loaded.surface.deformed(mesh.vertices)
    found = meshes.read_density(mesh, density, at)
    if found.values is None:
        return moved.with_density(None)
    return meshes.with_density(moved, found)
