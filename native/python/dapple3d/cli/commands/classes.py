# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple classes: points of several classes on a mesh."""

from dataclasses import dataclass
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

CLASS_METAVAR = "COUNT|spacing=S[:radius=R,density=D]"


@dataclass(frozen=True)
class Wanted:
    """One class, as it stands on the command line."""

    count: int | None
    spacing: float | None = None
    radius: float = 0.0
    density: str | None = None

    def settings(self, count: int) -> dict[str, Any]:
        """What the report says of it, which has so many points."""
        told = {"count": count, "radius": self.radius, "density": self.density}
        return told | options.given({"spacing": self.spacing})

    def on(self, loaded: meshes.Loaded) -> dapple.SampleClass:
        """The class with the density that it names."""
        if self.density is None:
            count = options.counted(loaded.surface, self.count, self.spacing)
            return dapple.SampleClass(count, radius=self.radius)
        found = meshes.read_density(loaded.mesh, self.density)
        surface = meshes.with_density(loaded.surface, found)  # whose errors name the file
        count = options.counted(surface, self.count, self.spacing)
        return dapple.SampleClass(
            count, density=found.values, density_at=found.at, radius=self.radius
        )


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


@click.command("classes", short_help="Several classes of points on a mesh, even together.")
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
@options.density_options
@options.attributes_option
@options.library_options("sample_classes")
@options.surface_options
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    out: Path,
    wanted: tuple[Wanted, ...],
    density: str | None,
    density_at: meshes.Place | None,
    attributes: bool,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **solver: Any,
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
    reporter = Reporter(json_out, quiet)
    points.check_extension(out)
    densities = [options.density_file(name) for name in (density, *(w.density for w in wanted))]
    check_outputs([mesh, *densities], [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    listed = [one.on(loaded) for one in wanted]
    chosen = options.given(solver)
    with Work("sampling", quiet=quiet) as work:
        samples = work.run(partial(dapple.sample_classes, loaded.surface, listed, **chosen))
    found = points.points_of(samples)
    if attributes:
        found = with_attributes(loaded.mesh, samples, found)
    points.write_points(out, found)
    settings = {**options.library_defaults("sample_classes"), **chosen}
    reporter.store(
        "classes",
        input=loaded.describe(),
        output=str(out),
        settings={
            "classes": [one.settings(made.count) for one, made in zip(wanted, listed, strict=True)],
            **settings,
        },
        report=samples.report.to_dict(),
    )
    reporter.say(f"{out}: {len(samples)} points, {figures(samples.report)}{loaded.doubled()}")
    for k, quality in enumerate(samples.report.classes):
        reporter.say(f"  class {k}: {quality.count} points, {figures(quality)}")
    if profile:
        reporter.show_profile([samples.report])
