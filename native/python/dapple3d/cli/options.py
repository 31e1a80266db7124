# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands share; the library's own defaults are read from the library."""

import ast
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import click

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

INPUT = click.Path(exists=True, dir_okay=False, path_type=Path)
OUTPUT = click.Path(path_type=Path)
NOT_NEGATIVE = click.FloatRange(min=0)
COUNT = click.IntRange(min=1, max=100_000_000)

# Arguments of the library by name: the type of the option, and its help.
KNOWN: dict[str, tuple[click.ParamType, str]] = {
    "seed": (
        click.IntRange(0, 2**64 - 1),
        "Of the random start: another number, another set just as even.",
    ),
    "capacity_weight": (
        NOT_NEGATIVE,
        "Lambda, weight of equal capacities (no unit): more of it, less like a lattice; "
        "20 to 100 are useful.",
    ),
    "repulsion_weight": (
        NOT_NEGATIVE,
        "Kappa, weight of the repulsion that keeps neighbors apart (no unit); 0 is none.",
    ),
    "tolerance": (
        NOT_NEGATIVE,
        "Relative decrease of the energy at which to stop (no unit): less is more regular, slower.",
    ),
    "max_evaluations": (
        click.IntRange(1, 2**31 - 1),
        "Of the energy, at most; of a motion for each frame.",
    ),
    "method": (
        click.Choice(["trust_region", "line_search"]),
        "Of the optimizer: line_search is plain L-BFGS, as in the paper.",
    ),
    "start": (
        click.Choice(["poisson", "random"]),
        "Poisson-disk set, or white noise, as in the paper.",
    ),
    "cells": (
        click.Choice(["connected", "euclidean"]),
        "Cells follow the surface, or go to the site that is nearest in space.",
    ),
    "threads": (click.IntRange(0, 4096), "0 is as many as the machine has; same bytes for any."),
    "union_weight": (
        NOT_NEGATIVE,
        "Mu, evenness of all classes together against that of each (no unit).",
    ),
    "stickiness": (
        NOT_NEGATIVE,
        "Weight of staying where the surface carries a point (no unit): more of it, less slide, "
        "less even.",
    ),
    "pattern_strength": (
        click.FloatRange(0, 1),
        "How strongly points return to the first frame's pattern; 0 lets it drift.",
    ),
    "max_slide": (NOT_NEGATIVE, "Farthest slide of a point within one frame, in spacings."),
    "longest_motion": (
        NOT_NEGATIVE,
        "Share of the surface's size that it may move at once; farther frames are split; "
        "0 never splits.",
    ),
    "sweeps": (click.IntRange(0, 2**31 - 1), "With --together: passes forwards and backwards."),
}


def library_defaults(function: object) -> dict[str, Any]:
    """What a native function takes for the arguments that are left out.

    Its documentation begins with its signature; None stands for nothing and is left out.
    """
    signature = (function.__doc__ or "").strip().splitlines()[0]
    (definition,) = ast.parse(f"def {signature}: ...").body
    assert isinstance(definition, ast.FunctionDef)
    arguments = zip(definition.args.kwonlyargs, definition.args.kw_defaults, strict=True)
    values = {argument.arg: ast.literal_eval(value) for argument, value in arguments if value}
    return {name: value for name, value in values.items() if value is not None}


def library_options(function: object, *names: str) -> Callable[[Decorated], Decorated]:
    """Options for arguments of a native function, in this order; those left out are None.

    Args:
        function: whose defaults the help shows.
        names: keys of KNOWN.
    """
    defaults = library_defaults(function)

    def decorate(command: Decorated) -> Decorated:
        for name in reversed(names):
            kind, text = KNOWN[name]
            flag, text = "--" + name.replace("_", "-"), f"{text}  [default: {defaults[name]}]"
            command = click.option(flag, type=kind, help=text)(command)
        return command

    return decorate


def given(options: Mapping[str, Any]) -> dict[str, Any]:
    """The options that were not left out."""
    return {name: value for name, value in options.items() if value is not None}


def check_either(count: int | None, points: Path | None) -> None:
    """Raise UsageError unless there is a number of new points, or else a file with points."""
    if (count is None) == (points is None):
        raise click.UsageError("give either --count or --points")


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


def weld_option(command: Decorated) -> Decorated:
    """--weld, for the surface."""
    return click.option(
        "--weld/--no-weld",
        default=True,
        show_default=True,
        help="Connect faces whose vertices are at the same place, as along hard edges and seams; "
        "or only those that share vertices.",
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
        "property of the vertices of MESH's ply.  [default: the npz's array 'density', else the "
        "same everywhere]",
    )(command)


def density_file(density: str | None) -> Path | None:
    """The file that a density option names, if it names one and no array."""
    return Path(density) if density and density.lower().endswith(".npy") else None
