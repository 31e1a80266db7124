# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs `dapple` in this process."""

import re

from click.testing import CliRunner, Result
from dapple3d.cli.app import main


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def done(*arguments: object) -> Result:
    found = run(*arguments)
    assert found.exit_code == 0, found.output
    return found


def refused(*arguments: object) -> str:
    """The message of a bad input: one line on stderr, exit code 1."""
    found = run(*arguments)
    assert found.exit_code == 1, found.output
    assert found.stdout == ""
    assert re.fullmatch(r"Error: [^\n]+\n", found.stderr), found.stderr
    assert isinstance(found.exception, SystemExit)
    return found.stderr
