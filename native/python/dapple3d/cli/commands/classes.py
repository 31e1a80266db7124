# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple classes: points of several classes on a mesh."""

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.cli import meshes, options, points
from dapple3d.cli.files import check_outputs
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.work import Work


@dataclass(frozen=True)
class Wanted:
    """One class, as it stands on the command line."""

    count: int
    radius: float = 0.0
    density: str | None = None

    def on(self, loaded: meshes.Loaded) -> dapple.SampleClass:
        """The class with the density that it names."""
        if self.density is None:
            return dapple.SampleClass(self.count, radius=self.radius)
        found = meshes.read_density(loaded.mesh, self.density)
        meshes.with_density(loaded.surface, found)  # so that its errors name the file
        return dapple.SampleClass(
            self.count, density=found.values, density_at=found.at, radius=self.radius
        )


class WantedType(click.ParamType):
    """COUNT[:radius=R][,density=D]."""

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
    metavar="COUNT[:radius=R,density=D]",
    help="Once for each class. R >= 0, in the units of MESH, keeps things apart by the sum of "
    "their radii (0: points); D is a density as for --density, else that of MESH.",
)
@options.density_options
@options.library_options("sample_classes")
@options.weld_option
@options.doubled_option
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    out: Path,
    wanted: tuple[Wanted, ...],
    density: str | None,
    density_at: meshes.Place | None,
    weld: bool,
    merge_doubled: bool,
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
      dapple classes meadow.npz plants.csv --class 800:density=moist --class 200
    """
    reporter = Reporter(json_out, quiet)
    points.check_extension(out)
    densities = [options.density_file(name) for name in (density, *(w.density for w in wanted))]
    check_outputs([mesh, *densities], [out, reporter.file])
    loaded = meshes.load(
        meshes.read_mesh(mesh), density, density_at, weld=weld, merge_doubled=merge_doubled
    )
    listed = [one.on(loaded) for one in wanted]
    chosen = options.given(solver)
    with Work("sampling", quiet=quiet) as work:
        samples = work.run(partial(dapple.sample_classes, loaded.surface, listed, **chosen))
    points.write_points(out, points.points_of(samples))
    settings = {**options.library_defaults("sample_classes"), **chosen}
    reporter.store(
        "classes",
        input=loaded.describe(),
        output=str(out),
        settings={"classes": [asdict(one) for one in wanted], **settings},
        report=samples.report.to_dict(),
    )
    reporter.say(f"{out}: {len(samples)} points, {figures(samples.report)}{loaded.doubled()}")
    for k, quality in enumerate(samples.report.classes):
        reporter.say(f"  class {k}: {quality.count} points, {figures(quality)}")
    if profile:
        reporter.show_profile([samples.report])
