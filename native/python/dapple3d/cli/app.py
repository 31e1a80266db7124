# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `dapple`: its subcommands, and errors as one sentence."""

import importlib
import pkgutil
from typing import Any

import click

import dapple3d as dapple
from dapple3d import _starting
from dapple3d._starting import CANCELLED, INTERRUPTED
from dapple3d.cli import commands


class Commands(click.Group):
    """The modules of dapple3d/cli/commands; only the one that is called is imported."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(module.name for module in pkgutil.iter_modules(commands.__path__))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        module = importlib.import_module(f"{commands.__name__}.{cmd_name}")
        found: click.Command = module.command
        return found

    def invoke(self, ctx: click.Context) -> Any:
        try:
            _starting.ready()
            return super().invoke(ctx)
        except KeyboardInterrupt:
            if _starting.is_command():
                _starting.begin()  # a second Ctrl-C ends the process at once
            click.echo(CANCELLED, err=True)
            ctx.exit(INTERRUPTED)
        except BrokenPipeError:
            raise  # click ends quietly when the reader is gone
        except MemoryError as error:
            raise click.ClickException("there is not enough memory for this") from error
        except (ValueError, OSError, ImportError) as error:
            raise click.ClickException(sentence(error)) from error


def sentence(error: Exception) -> str:
    """The message of an error on one line; an error of the system begins with the file."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return " ".join(str(error).split())


@click.command(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(dapple.__version__, prog_name="dapple")
def main() -> None:
    """Blue noise on surfaces: points that are evenly spaced and never patterned.

    The same input and seed give the same bytes, whatever the number of threads. Exit codes: 0 done,
    1 bad input, 2 bad usage, 130 interrupted by Ctrl-C (nothing is then written).

    \b
    Example:
      dapple sample bunny.ply points.ply -n 2000
    """
