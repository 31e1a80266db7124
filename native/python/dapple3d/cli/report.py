# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command says when it is done: a line for people, JSON for programs."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d.writing import replacing

STANDARD_OUTPUT = "-"


@dataclass(frozen=True)
class Reporter:
    """Where the words go: with --json - the standard output holds nothing but JSON."""

    json_out: str | None
    quiet: bool

    @property
    def file(self) -> Path | None:
        """Of the JSON, if it goes to one."""
        to_file = self.json_out is not None and self.json_out != STANDARD_OUTPUT
        return Path(str(self.json_out)) if to_file else None

    def say(self, text: str) -> None:
        """Print for people, unless told to be quiet or a program listens."""
        if not self.quiet and self.json_out != STANDARD_OUTPUT:
            click.echo(text)

    def store(self, command: str, **content: Any) -> None:
        """Write the JSON, if asked for: command and version, then the content."""
        document = {"command": command, "version": dapple.__version__, **content}
        text = json.dumps(document, indent=1) + "\n"
        if self.file:
            with replacing(self.file) as file:
                file.write(text.encode())
        elif self.json_out == STANDARD_OUTPUT:
            click.echo(text, nl=False)


def figures(report: dapple.Quality) -> str:
    """The most telling figures on one line."""
    return (
        f"alpha min {report.alpha_min:.3f}, psi6 {report.bond_order:.3f}, "
        f"capacity variation {report.capacity_variation:.4f}"
    )
