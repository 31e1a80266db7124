# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple analyze: how even a point set is."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import meshes, options
from dapple3d.cli.files import about, check_outputs
from dapple3d.cli.points import in_space, read_points, stored_places
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work
from dapple3d.writing import replacing

# Figure, its name in the table, its format, what it means.
ROWS = (
    ("count", "points", "d", ""),
    ("spacing", "spacing", ".6g", "of a hexagonal lattice of as many points, in the mesh's units"),
    ("alpha_min", "alpha min", ".4f", "smallest distance / local spacing; 1 for hexagons"),
    ("alpha_mean", "alpha mean", ".4f", "the mean of the same ratio over the points"),
    ("thin_share", "thin share", ".4f", "of the points, on thin parts, which alpha is without"),
    ("capacity_variation", "capacity variation", ".5f", "standard deviation / mean; 0 is the best"),
    ("bond_order", "psi6", ".4f", "white noise 0.36, dart throwing 0.42, hexagons 1"),
    ("energy", "energy", ".5f", "normalized; 0.16037 for hexagons"),
)
Places = NDArray | dapple.Samples  # in space, or on the faces of a mesh
FAR = 1e12  # sizes of the mesh: beyond, the nearest face is not defined in floating point


@click.command("analyze", short_help="How even a point set is.")
@click.argument("points", type=options.INPUT)
@click.option(
    "--mesh",
    type=options.INPUT,
    help="The surface they lie on. A point counts on the face that an .npz of 'sample' names for "
    "it, else where the mesh is nearest.  [default: the unit square]",
)
@options.density_options
@click.option(
    "--plot",
    type=options.OUTPUT,
    metavar="FILE.png",
    help="Draw the power spectrum, its radial mean and anisotropy (needs matplotlib).",
)
@options.library_options("analyze")
@options.library_options("sample", only=["threads"])
@options.surface_options
@options.report_options
def command(
    points: Path,
    mesh: Path | None,
    density: str | None,
    density_at: meshes.Place | None,
    plot: Path | None,
    threads: int | None,
    surface_options: meshes.SurfaceOptions,
    json_out: str | None,
    quiet: bool,
    **measure: Any,
) -> None:
    """Print how even POINTS are: all of them, and each class.

    POINTS is .ply, .csv (named columns x, y, z and perhaps class; or two or three without names),
    .npz ('positions', perhaps 'classes'), .obj or .off. Without --mesh they lie in the unit square
    0 <= x, y <= 1, z = 0.

    \b
    Examples:
      dapple analyze points.ply --mesh bunny.ply
      dapple analyze dots.csv --plot spectrum.png --json figures.json
    """
    reporter = Reporter(json_out, quiet)
    if plot and plot.suffix.lower() != ".png":
        raise click.ClickException(f"{plot}: the picture is written as .png")
    check_outputs([points, mesh, options.density_file(density)], [plot, reporter.file])
    if mesh is None and (density or density_at):
        raise click.UsageError("--density and --density-at need --mesh")
    found = read_points(points)
    with about(points):
        places = in_space(found.positions)
    loaded = (
        meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options) if mesh else None
    )
    surface = loaded.surface if loaded else unit_square(points, places)
    with about(points):
        distances = distances_to(surface, places)
    chosen = options.given(measure)
    stored = stored_places(surface, found, points) if mesh else None
    on_mesh = places if stored is None else stored
    report = measured(surface, on_mesh, found.classes, chosen)
    if plot:
        with about(f"{plot}: spectra are measured in discs around the points"):
            draw(plot, surface if mesh else None, on_mesh, threads, quiet)
    farthest = float(np.max(distances, initial=0.0) / report["spacing"])
    reporter.store(
        "analyze",
        input={"points": str(points), **(loaded.describe() if loaded else {"mesh": None})},
        settings=options.library_defaults("analyze") | chosen,
        bound="nearest" if stored is None else "stored",
        report=report,
        farthest_from_surface=farthest,
    )
    if json_out != "-":
        click.echo(table(report, farthest))
        if loaded and loaded.surface.doubled_faces:
            click.echo(loaded.doubled().removeprefix("; "))


def unit_square(path: Path, places: NDArray) -> dapple.Surface:
    """The square that points without a mesh lie in.

    Raises:
        ClickException: naming the first point outside.
    """
    low, high = np.zeros(3), np.array([1.0, 1.0, 0.0])
    outside = np.flatnonzero(~((places >= low) & (places <= high)).all(axis=1))
    if len(outside):
        k = outside[0]
        raise click.ClickException(
            f"{path}: point {k} is {places[k].tolist()}: without --mesh points lie in the unit "
            "square 0 <= x, y <= 1, z = 0"
        )
    return dapple.Plane(1.0, 1.0).surface


def distances_to(surface: dapple.Surface, places: NDArray) -> NDArray:
    """(n,) float64, from the nearest point of the surface.

    Raises:
        ValueError: naming the first point that is not finite, or so far that none is nearest.
    """
    near = dapple.project(surface, places)
    lost = np.flatnonzero(~(near.distances <= FAR * np.sqrt(surface.area)))
    if len(lost):
        raise ValueError(f"point {lost[0]} is too far from the mesh: {places[lost[0]].tolist()}")
    return near.distances


def measured(
    surface: dapple.Surface, places: Places, classes: NDArray | None, chosen: dict[str, Any]
) -> dict[str, Any]:
    """The report of all points, with those of each class if there are several."""
    report = dapple.analyze(surface, places, **chosen).to_dict()
    kinds = np.unique(classes) if classes is not None else np.zeros(1)
    if classes is not None and len(kinds) > 1:
        parts = {
            int(k): dapple.analyze(surface, only(surface, places, classes == k), **chosen)
            for k in kinds
        }
        report["classes"] = [
            {"class": k, **{name: getattr(part, name) for name, *_ in ROWS}}
            for k, part in parts.items()
        ]
    return report


def only(surface: dapple.Surface, places: Places, chosen: NDArray[np.bool_]) -> Places:
    """The chosen of the points."""
    if isinstance(places, dapple.Samples):
        return dapple.Samples(surface, places.faces[chosen], places.barycentric[chosen])
    return places[chosen]


def table(report: dict[str, Any], farthest: float) -> str:
    """One row for each figure; a column for all points and for each class."""
    columns = [report, *report["classes"]]
    lines = []
    if len(columns) > 1:
        heads = ["all", *(f"class {column['class']}" for column in report["classes"])]
        lines.append(" " * 16 + "".join(f"{head:>11}" for head in heads))
    for name, title, form, meaning in ROWS:
        if name == "thin_share" and not any(column[name] for column in columns):
            continue
        numbers = "".join(f"{column[name]:>11{form}}" for column in columns)
        lines.append(f"{title:<16}{numbers}   {meaning}".rstrip())
    meaning = "farthest point, in spacings"
    pad = " " * 11 * (len(columns) - 1)
    lines.append(f"{'off the surface':<16}{farthest:>11.2g}{pad}   {meaning}")
    return "\n".join(lines)


def draw(
    path: Path, surface: dapple.Surface | None, places: Places, threads: int | None, quiet: bool
) -> None:
    """Draw the spectrum of points on a surface, or else in the unit square."""
    from dapple3d import plot

    given = options.given({"threads": threads})
    with Work("spectrum", quiet=quiet) as work:
        spectrum: dapple.Spectrum | dapple.SurfaceSpectrum
        if surface:
            spectrum = work.run(partial(dapple.surface_spectrum, surface, places, **given))
        else:
            flat = np.ascontiguousarray(np.asarray(places)[:, :2])
            spectrum = work.run(partial(dapple.spectrum, flat, **given))
    figure = plot.summary(spectrum)
    with replacing(path) as file:
        figure.savefig(file, format="png")
