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

CLASS_METAVAR = "COUNT|spacing=S[:radius=R,density=D]"


@dataclass(frozen=True)
class Wanted:
    """One class, as it stands on the command line."""

    count: int | None
    spacing: float | None = None
    radius: float = 0.0
    density: str | None = None

    def settings(self, count: int) -> dict[str, Any]:
        """The entry of a report for a class with that many points."""
        own = {"count": count, "radius": self.radius, "density": self.density}
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

    def on(self, surface: dapple.Surface, **density: Any) -> dapple.SampleClass:
        """The class on a surface, with the options of a density if it has its own."""
        own = surface.with_density(**density) if density else surface
        count = options.counted(own, self.count, self.spacing)
        return dapple.SampleClass(count, radius=self.radius, **density)


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
    if not source.masks.given or not wanted:
        own = [one.options() if w.density else {} for one, w in zip(densities, wanted, strict=True)]
        masked = source.masks.on(surface, path, count=count)
    else:  # each class has its density: that of the surface is the masks alone
        values = {str(k): one.as_rows() for k, one in enumerate(densities) if one.source}
        masked = source.masks.on(surface.with_density(None), path, count=count, values=values)
        own = [masked.class_density(str(k) if str(k) in values else "") for k in range(len(wanted))]
    pairs = zip(wanted, own, strict=True)
    return masked, [one.on(masked.surface, **density) for one, density in pairs]


class WantedType(click.ParamType):
    """COUNT[:radius=R][,density=D], or spacing=S in place of COUNT."""

    name = "class"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Wanted:
        """Parse a class, or say which part is wrong."""
        head, _, rest = value.partition(":")
        fields: dict[str, Any] = {}
        for part in rest.split(",") if rest else ():
            key, _, text = part.partition("=")
            if key not in ("radius", "density") or not text or key in fields:
                self.fail(f"'{part}': radius=R or density=D is needed, each once", param, ctx)
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
    help="Once for each class. S, in place of a number, is the distance between its points where "
    "the density is largest. R >= 0 keeps things apart by the sum of their radii; with 0 they are "
    "points, which stay outside the things of others. Both are in the units of MESH. D is a "
    "density as for --density, else that of MESH.",
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
