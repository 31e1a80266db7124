# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of a command: a line for people, JSON for programs."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.writing import replacing

STANDARD_OUTPUT = "-"


@dataclass(frozen=True)
class Reporter:
    """Destination of messages: with --json - the standard output holds only JSON."""

    json_out: str | None
    quiet: bool

    @property
    def file(self) -> Path | None:
        """The file of the JSON report, if there is one."""
        to_file = self.json_out is not None and self.json_out != STANDARD_OUTPUT
        return Path(str(self.json_out)) if to_file else None

    def say(self, text: str) -> None:
        """Print a line, unless --quiet is given or the JSON goes to the standard output."""
        if not self.quiet and self.json_out != STANDARD_OUTPUT:
            click.echo(text)

    def show_profile(self, reports: Sequence[dapple.Report | dapple.RemeshReport]) -> None:
        """Print the times of the stages on stderr, also with --quiet."""
        click.echo(profile_table(reports), err=True)

    def store(self, command: str, **content: Any) -> None:
        """Write the JSON report if --json is given: command, version and the content."""
        document = {"command": command, "version": dapple.__version__, **content}
        text = json.dumps(document, indent=1) + "\n"
        if self.file:
            with replacing(self.file) as file:
                file.write(text.encode())
        elif self.json_out == STANDARD_OUTPUT:
            click.echo(text, nl=False)


def is_measured(report: dapple.Quality) -> bool:
    """Whether the report has figures: relax() measures only what it has changed."""
    some = report.alpha_min > 0.0 or report.thin_share > 0.0 or report.capacity_variation > 0.0
    return some or report.count < 2


def figures(report: dapple.Quality) -> str:
    """The main figures on one line; without alpha where the surface is thinner than the spacing."""
    variation = f"capacity variation {report.capacity_variation:.4f}"
    if report.thin_share == 1.0:
        return f"{variation} along parts thinner than the spacing"
    shown = f"alpha min {report.alpha_min:.3f}, psi6 {report.bond_order:.3f}, {variation}"
    if report.thin_share > 0.0:
        share = 100 * report.thin_share
        return f"{shown}; alpha without {share:.3g} % on parts thinner than the spacing"
    return shown


def profile_table(reports: Sequence[dapple.Report | dapple.RemeshReport]) -> str:
    """Seconds of each stage and their share, of all reports together."""
    total = sum(report.seconds for report in reports)
    lines = [f"{'stage':<12}{'seconds':>9}{'share':>9}"]
    for stage in reports[0].profile:
        seconds = sum(report.profile[stage] for report in reports)
        share = 100 * seconds / total if total > 0 else 0.0
        lines.append(f"{stage:<12}{seconds:>9.3f}{share:>7.1f} %")
    return "\n".join([*lines, f"{'all':<12}{total:>9.3f}"])
