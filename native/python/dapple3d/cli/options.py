# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands share; the library's own defaults are read from the library."""

import functools
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any, TypeVar

import click

import dapple3d as dapple
from dapple3d.cli.meshes import SurfaceOptions
from dapple3d.cli.ranges import Number, Whole

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

INPUT = click.Path(exists=True, dir_okay=False, path_type=Path)
FRAMES = click.Path(exists=True, path_type=Path)  # or a folder of them
OUTPUT = click.Path(path_type=Path)
NOT_NEGATIVE = Number(0.0)
COUNT = Whole(1, 100_000_000)
SPACING = Number(0.0, finite=True, open_below=True)


def library_defaults(verb: str) -> dict[str, Any]:
    """The defaults of the options of a library function."""
    return {option.name: option.default for option in dapple.option_table(verb)}


def library_options(
    verb: str, *, only: Collection[str] = (), without: Collection[str] = (), before: str = ""
) -> Callable[[Decorated], Decorated]:
    """Options of a function of the library, in its order; those left out are None.

    Args:
        verb: the function's name.
        only: not empty: names of those to take.
        without: names of those not to take.
        before: words that their help begins with.
    """
    table = [
        option
        for option in dapple.option_table(verb)
        if option.name not in without and (not only or option.name in only)
    ]

    def decorate(command: Decorated) -> Decorated:
        for option in reversed(table):
            command = library_option(option, before)(command)
        return command

    return decorate


def library_option(option: dapple.Option, before: str = "") -> Callable[[Decorated], Decorated]:
    """A flag for an option of the library."""
    flag = "--" + option.name.replace("_", "-")
    unit = f" In {option.unit}." if option.unit else ""
    text = before + option.documentation + unit
    if option.type == "bool":
        names = f"{flag}/--no-{flag[2:]}" if option.default else flag
        return click.option(names, default=None, is_flag=True, help=text)
    shown = f"{text}  [default: {option.default}]"
    return click.option(flag, type=param_type(option), help=shown)


def param_type(option: dapple.Option) -> click.ParamType:
    """The type of a click option for an option of the library."""
    if option.choices:
        return click.Choice(option.choices)
    if option.type == "int":
        return Whole(option.min, option.max)
    return Number(option.min, option.max, open_below=option.open)


def given(options: Mapping[str, Any]) -> dict[str, Any]:
    """The options that were given."""
    return {name: value for name, value in options.items() if value is not None}


def count_options(words: str) -> Callable[[Decorated], Decorated]:
    """--count and --spacing; words are the help of --count."""

    def decorate(command: Decorated) -> Decorated:
        command = click.option(
            "--spacing",
            type=SPACING,
            help="Instead of a number: the distance between neighbors, in the mesh's units, where "
            "the density is largest.",
        )(command)
        return click.option("-n", "--count", type=COUNT, help=words)(command)

    return decorate


def check_amount(count: int | None, spacing: float | None) -> None:
    """Raise UsageError unless there is a number of new points, or else their spacing."""
    if count is None and spacing is None:
        raise click.UsageError("Missing option '-n' / '--count', or '--spacing'.")
    if count is not None and spacing is not None:
        raise click.UsageError("give either --count or --spacing")


def check_either(count: int | None, spacing: float | None, points: Path | None) -> None:
    """Raise UsageError unless there are new points, or else a file with points."""
    if count is None and spacing is None and points is None:
        raise click.UsageError("Missing option '-n' / '--count', '--spacing' or '--points'.")
    if (count is not None) + (spacing is not None) + (points is not None) > 1:
        raise click.UsageError("give only one of --count, --spacing and --points")


def counted(surface: dapple.Surface, count: int | None, spacing: float | None) -> int:
    """The number of new points, given or by their spacing.

    Raises:
        ClickException: the spacing is that of too many.
    """
    if spacing is None:
        assert count is not None
        return count
    return surface.count(spacing)


def report_options(command: Decorated) -> Decorated:
    """--json and --quiet, which every command takes."""
    command = click.option(
        "--quiet", "-q", is_flag=True, help="No progress bar, and no line when all went well."
    )(command)
    return click.option(
        "--json",
        "json_out",
        metavar="FILE|-",
        help="Also write input, settings and figures as JSON; - is the standard output.",
    )(command)


def profile_option(command: Decorated) -> Decorated:
    """--profile, for commands that solve."""
    return click.option(
        "--profile",
        is_flag=True,
        help="Also print what the time of the solution went to, on stderr.",
    )(command)


def surface_options(command: Callable[..., None]) -> Callable[..., None]:
    """--weld, --merge-doubled and --sharp-angle: a command gets them as `surface_options`."""

    @functools.wraps(command)
    def with_surface_options(
        *, weld: bool, merge_doubled: bool, sharp_angle: float, **others: Any
    ) -> None:
        command(surface_options=SurfaceOptions(weld, merge_doubled, sharp_angle), **others)

    return _weld_option(_doubled_option(_sharp_option(with_surface_options)))


def _sharp_option(command: Decorated) -> Decorated:
    return click.option(
        "--sharp-angle",
        type=Number(0.0, 180.0),
        default=SurfaceOptions.sharp_angle,
        show_default=True,
        metavar="DEGREES",
        help="Normals jump over edges whose faces turn by more; where MESH has normals of its "
        "own, these count.",
    )(command)


def _weld_option(command: Decorated) -> Decorated:
    return click.option(
        "--weld/--no-weld",
        default=True,
        show_default=True,
        help="Connect faces whose vertices are at the same place, as along hard edges and seams; "
        "or only those that share vertices.",
    )(command)


def _doubled_option(command: Decorated) -> Decorated:
    return click.option(
        "--merge-doubled/--keep-doubled",
        default=True,
        show_default=True,
        help="Count faces that lie on each other corner by corner as one, whichever way they are "
        "turned.",
    )(command)


def attributes_option(command: Decorated) -> Decorated:
    """--attributes, for commands that put points on a mesh."""
    return click.option(
        "--attributes",
        is_flag=True,
        help="Also write what MESH has where the points are: texture coordinates, colors, the "
        "number of the polygon, other properties of a ply and arrays of an npz.",
    )(command)


def density_options(command: Decorated) -> Decorated:
    """--density and --density-at, for the surface."""
    command = click.option(
        "--density-at",
        type=click.Choice(["vertices", "faces", "corners"]),
        help="Where the values are: (v,), (m,) or (m, 3) numbers.  [default: by their shape]",
    )(command)
    return click.option(
        "--density",
        metavar="FILE.npy|NAME",
        help="Values >= 0, points per area in relation: a .npy file, an array of MESH's npz, or a "
        "property of the vertices or faces of MESH's ply.  [default: the npz's array 'density', "
        "else the same everywhere]",
    )(command)


def density_file(density: str | None) -> Path | None:
    """The file of a density option, if it names a file."""
    return Path(density) if density and density.lower().endswith(".npy") else None
