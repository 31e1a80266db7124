# SPDX-License-Identifier: GPL-3.0-or-later
"""Common options of the commands that put points on a mesh, and their output."""

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import meshes, options, points
from dapple3d.cli.attributes import with_attributes
from dapple3d.cli.files import check_outputs
from dapple3d.cli.masks import Masks, mask_options
from dapple3d.cli.report import Reporter, figures, is_measured
from dapple3d.cli.work import Result, Work


@dataclass(frozen=True)
class Source:
    """Density, masks and surface options of the mesh that is read."""

    density: str | None
    density_at: meshes.Place | None
    options: meshes.SurfaceOptions
    masks: Masks

    def load(self, mesh: Path) -> meshes.Loaded:
        """The checked surface of a file, not masked yet.

        Raises:
            ClickException: naming the file, the rule and the first offender.
        """
        found = meshes.read_mesh(mesh)
        return meshes.load(found, self.density, self.density_at, self.options)


@dataclass(frozen=True)
class Output:
    """The file that points are written to, and the report about them."""

    path: Path
    attributes: bool
    profile: bool
    reporter: Reporter

    def check(self, source: Source, inputs: Iterable[Path | None]) -> None:
        """Refuse outputs, before the work, that cannot be written or would destroy an input.

        Raises:
            ClickException: naming the output.
        """
        points.check_extension(self.path)
        read = [*inputs, options.density_file(source.density), *source.masks.files]
        check_outputs(read, [self.path, self.reporter.file])

    def run(self, label: str, call: Callable[..., Result]) -> Result:
        """The result of call(context=...), with a progress bar."""
        with Work(label, quiet=self.reporter.quiet) as work:
            return work.run(call)

    def write(
        self,
        command: str,
        loaded: meshes.Loaded,
        samples: dapple.Samples,
        said: str,
        *,
        settings: dict[str, Any],
        read: dict[str, str] | None = None,
        arrays: dict[str, NDArray] | None = None,
        report: dapple.Report | None = None,
        **more: Any,
    ) -> None:
        """Write samples of the mesh that was loaded, the report, and a line.

        Args:
            said: how the line goes on after the file's name.
            settings: all that the command was called with, for the report.
            read: what else was read, for the report.
            arrays: more of each point, by name.
            report: of the samples; None: their own.
            more: more of the report.
        """
        report = report or samples.report
        found = points.points_of(samples)
        if self.attributes:
            found = with_attributes(loaded.mesh, samples, found)
        found = replace(found, attributes={**found.attributes, **(arrays or {})})
        points.write_points(self.path, found)
        self.reporter.store(
            command,
            input={**loaded.describe(), **(read or {})},
            output=str(self.path),
            settings=settings,
            **more,
            report=report.to_dict(),
        )
        self.reporter.say(f"{self.path}: {said}{loaded.doubled()}")
        for k, quality in enumerate(report.classes):
            shown = figures(quality) if is_measured(quality) else "left alone"
            self.reporter.say(f"  class {k}: {quality.count} points, {shown}")
        if self.profile:
            self.reporter.show_profile([report])


def point_options(verb: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """The options of a command that calls a function of the library to put points on a mesh: it
    gets a `source`, an `output`, and those of the function.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(command)
        def with_both(
            *,
            density: str | None,
            density_at: meshes.Place | None,
            masks: Masks,
            surface_options: meshes.SurfaceOptions,
            out: Path,
            attributes: bool,
            profile: bool,
            json_out: str | None,
            quiet: bool,
            **others: Any,
        ) -> None:
            source = Source(density, density_at, surface_options, masks)
            output = Output(out, attributes, profile, Reporter(json_out, quiet))
            command(source=source, output=output, **others)

        of_report = options.profile_option(options.report_options(with_both))
        of_surface = mask_options(options.surface_options(of_report))
        of_verb = options.library_options(verb)(of_surface)
        return options.density_options(options.attributes_option(of_verb))

    return decorate
