# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple classes: points of several classes on a mesh."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import meshes, options
from dapple3d.cli.masks import Command, hexagonal_count
from dapple3d.cli.output import Output, Source, point_options
from dapple3d.cli.report import figures
from dapple3d.density import MaskedSurface

CLASS_METAVAR = "COUNT|spacing=S[:radius=R,density=D,borders=B]"
BORDERS = ("keep", "move-in", "remove")
_FIELDS = ("radius", "density", "borders")


@dataclass(frozen=True)
class Wanted:
    """One class, as it stands on the command line."""

    count: int | None
    spacing: float | None = None
    radius: float = 0.0
    density: str | None = None
    borders: str = BORDERS[0]

    @property
    def stays_inside(self) -> bool:
        """Whether its discs do not stick out over borders."""
        return self.borders != BORDERS[0] and self.radius > 0.0

    def settings(self, count: int) -> dict[str, Any]:
        """The entry of a report for a class with that many points."""
        own = {"count": count, "radius": self.radius, "density": self.density}
        own |= {"borders": self.borders} if self.stays_inside else {}
        return own | options.given({"spacing": self.spacing})

    def amount(self, surface: dapple.Surface) -> int:
        """About how many points it has."""
        return self.count or hexagonal_count(surface.area, self.spacing or 1.0)

    def density_on(self, loaded: meshes.Loaded) -> meshes.Density:
        """The density that it names, checked on the surface; else that of the mesh."""
        if self.density is None:
            return loaded.density
        found = meshes.read_density(loaded.mesh, self.density)
        meshes.with_density(loaded.surface, found)  # whose errors name the file
        return found

    def on(self, surface: dapple.Surface, share: float = 1.0, **density: Any) -> dapple.SampleClass:
        """The class on a surface, with the options of a density if it has its own.

        Args:
            share: of its points that are left where others are removed.
        """
        own = surface.with_density(**density) if density else surface
        count = options.counted(own, self.count, self.spacing)
        left = round(share * count) if self.count and self.borders == "remove" else count
        return dapple.SampleClass(left, radius=self.radius, **density)


def classes_on(
    wanted: Sequence[Wanted], loaded: meshes.Loaded, source: Source, count: int | None = None
) -> tuple[MaskedSurface, list[dapple.SampleClass]]:
    """The surface in its masks, and the classes with their densities there.

    Args:
        count: of all points, where the classes do not say it.
    """
    surface, path = loaded.surface, loaded.mesh.path
    densities = [one.density_on(loaded) for one in wanted]
    count = count or sum(one.amount(surface) for one in wanted)
    if not (source.masks.given and wanted) and not any(one.stays_inside for one in wanted):
        own = [one.options() if w.density else {} for one, w in zip(densities, wanted, strict=True)]
        masked = source.masks.on(surface, path, count=count)
    else:  # each class has its density: that of the surface is the masks alone
        values = {str(k): one.as_rows() for k, one in enumerate(densities) if one.source}
        masked = source.masks.on(surface.with_density(None), path, count=count, values=values)
        names = [str(k) if str(k) in values else "" for k in range(len(wanted))]
        shares = _clear_borders(masked, wanted, names, path)
        own = [masked.class_density(name) for name in names]
        rows = zip(wanted, shares, own, strict=True)
        return masked, [one.on(masked.surface, share, **density) for one, share, density in rows]
    pairs = zip(wanted, own, strict=True)
    return masked, [one.on(masked.surface, **density) for one, density in pairs]


def _clear_borders(
    masked: MaskedSurface, wanted: Sequence[Wanted], names: list[str], path: Path
) -> list[float]:
    """Keep the discs of classes inside the border: exchanges the names of their densities, and
    returns which share of the capacity is left of each.

    Raises:
        ClickException: there is no room for a class.
    """
    shares = [1.0] * len(wanted)
    for k, one in enumerate(wanted):
        if not one.stays_inside:
            continue
        masked.clear_borders({f"class {k}": (names[k], one.radius)})
        names[k], shares[k] = f"class {k}", masked.cleared_share(f"class {k}")
        if shares[k] == 0.0:
            raise click.ClickException(
                f"{path}: class {k} has no room: no place is {one.radius:g} away from the border"
            )
    return shares


class WantedType(click.ParamType):
    """COUNT[:radius=R][,density=D][,borders=B], or spacing=S in place of COUNT."""

    name = "class"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Wanted:
        """Parse a class, or say which part is wrong."""
        head, _, rest = value.partition(":")
        fields: dict[str, Any] = {}
        for part in rest.split(",") if rest else ():
            key, _, text = part.partition("=")
            if key not in _FIELDS or not text or key in fields:
                listed = "radius=R, density=D or borders=B"
                self.fail(f"'{part}': {listed} is needed, each once", param, ctx)
            if key == "borders" and text not in BORDERS:
                self.fail(f"'{part}': B is one of {', '.join(BORDERS)}", param, ctx)
            fields[key] = click.FLOAT.convert(text, param, ctx) if key == "radius" else text
        if head.startswith("spacing="):
            spacing = options.SPACING.convert(head.removeprefix("spacing="), param, ctx)
            return Wanted(None, spacing, **fields)
        return Wanted(options.COUNT.convert(head, param, ctx), **fields)


@click.command("classes", cls=Command, short_help="Several classes of points, even together.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@click.option(
    "--class",
    "wanted",
    type=WantedType(),
    multiple=True,
    required=True,
    metavar=CLASS_METAVAR,
    help="A class; repeat it for each. COUNT is the number of its points; spacing=S instead is the "
    "distance between them where the density is largest. R is the radius of a disc around each "
    "point: discs of all classes stay apart, and points without one stay outside of them. Lengths "
    "are in the units of MESH. D is a density as for --density; without it, that of MESH. B says "
    "what happens to discs that would stick out over the border of MESH, or of what masks and "
    "densities leave: keep, move-in or remove.",
)
@point_options("sample_classes")
def command(
    mesh: Path, wanted: tuple[Wanted, ...], source: Source, output: Output, **solver: Any
) -> None:
    """Put points of several classes on MESH: each class even by itself, and all together.

    MESH and OUT are files as for `dapple sample`; the column 'class' counts the classes from 0 in
    their order.

    \b
    Examples:
      dapple classes meadow.ply plants.ply --class 800 --class 400:radius=0.02
      dapple classes meadow.ply plants.ply --class spacing=0.1 --class spacing=0.5:radius=0.1
      dapple classes meadow.npz plants.csv --class 800:density=moist --class 200
      dapple classes floor.ply tables.csv --class 40:radius=0.5,borders=move-in
    """
    output.check(source, [mesh, *(options.density_file(one.density) for one in wanted)])
    loaded = source.load(mesh)
    masked, listed = classes_on(wanted, loaded, source)
    chosen = options.given(solver)
    solving = partial(dapple.sample_classes, masked.surface, listed, **chosen)
    samples = masked.to_original(output.run("sampling", solving))
    settings = {
        "classes": [one.settings(made.count) for one, made in zip(wanted, listed, strict=True)],
        **source.masks.describe(),
        **options.library_defaults("sample_classes"),
    }
    said = f"{len(samples)} points, {figures(samples.report)}"
    output.write("classes", loaded, samples, said, settings=settings | chosen)
