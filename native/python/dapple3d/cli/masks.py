# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks on the command line: points only where slope, height, distance, noise are in a range."""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d import density
from dapple3d.cli import points
from dapple3d.cli.files import about, load_npz
from dapple3d.cli.meshes import read_mesh
from dapple3d.cli.ranges import Number, Whole

SECTION = "Masks"
INTRODUCTION = (
    "They multiply the density: full where a quantity is from MIN to MAX, both included, and none "
    "beyond. Faces are cut where that needs it; points are on those of MESH. Lengths are in the "
    "units of MESH. inf and -inf are no limit."
)
_SLACK = 1e-4  # degrees: error of angles from coordinates in single precision
_MOST = 1_000_000  # points that faces are cut for


@dataclass(frozen=True)
class Row:
    """The options of a mask: the values before MIN and MAX, and its other options."""

    name: str
    number: Number
    help: str
    unit: str  # of MIN and MAX
    before: tuple[tuple[str, click.ParamType], ...] = ()
    more: tuple[click.Option, ...] = ()
    angle: bool = False  # in degrees

    @property
    def metavar(self) -> str:
        return " ".join([*(name for name, _ in self.before), "MIN", "MAX"])


class MaskOption(click.Option):
    """An option that the help shows in the section of masks."""


ANGLE, LENGTH, SHARE, HEIGHT = Number(0.0, 180.0), Number(0.0), Number(0.0, 1.0), Number()
ROWS = (
    Row(
        "slope",
        ANGLE,
        "Only where the angle between the normal and the z axis is in a range of degrees: 0 is a "
        "floor, 90 a wall, 180 a ceiling.",
        "DEGREES",
        angle=True,
    ),
    Row("height", HEIGHT, "Only where z is in a range.", "LENGTH"),
    Row(
        "distance",
        LENGTH,
        "Only where the distance to what FILE holds, a mesh or points, is in a range; inside of a "
        "closed mesh it is 0.",
        "LENGTH",
        before=(("FILE", click.Path(exists=True, dir_okay=False, path_type=Path)),),
        more=(
            MaskOption(
                ["--distance-ignore-height"],
                is_flag=True,
                default=None,
                help="Measure that distance seen from above.",
            ),
        ),
    ),
    Row(
        "border",
        LENGTH,
        "Only where the distance to the border of MESH is in a range.",
        "LENGTH",
    ),
    Row(
        "aspect",
        ANGLE,
        "Only where the angle between DIRECTION and the one that the surface faces is in a range "
        "of degrees. DIRECTION is as on a compass: 0 is the y axis, 90 the x axis. Level ground "
        "counts as in the range.",
        "DEGREES",
        before=(("DIRECTION", Number(finite=True)),),
        angle=True,
    ),
    Row(
        "noise",
        SHARE,
        "Only where a noise, from 0 to 1 and spread evenly, is in a range: patches.",
        "SHARE",
        more=(
            MaskOption(
                ["--noise-size"],
                type=Number(0.0, finite=True, open_below=True),
                metavar="LENGTH",
                help="Size of the patches, in the mesh's units.  [default: 1.0]",
            ),
            MaskOption(
                ["--noise-detail"],
                type=Whole(0, 8),
                help="How many finer noises are added, each of half the size and half the "
                "influence.  [default: 2]",
            ),
            MaskOption(
                ["--noise-seed"],
                type=Whole(0, 2**31 - 1),
                help="Each seed gives other patches.  [default: 0]",
            ),
        ),
    ),
)


OPENNESS = 0.05
OUTSIDE = (
    MaskOption(
        ["--outside"],
        is_flag=True,
        default=None,
        help="Only where the surface is seen from outside, not on parts that are inside others. "
        "Where parts pass through each other, points keep their distance across the joint.",
    ),
    MaskOption(
        ["--openness"],
        type=Number(0.0, 1.0, finite=True),
        metavar="SHARE",
        help="With --outside: share of the sky that a place has to see; more leaves out crevices "
        f"too.  [default: {OPENNESS}]",
    ),
)


def _options_of(row: Row) -> list[click.Option]:
    """The options of one mask, in the order of the help."""
    flag = f"--{row.name}"
    kinds = [*(kind for _, kind in row.before), row.number, row.number]
    strength = "How much the mask counts, 0 to 1; at 0 it has no effect.  [default: 1.0]"
    return [
        MaskOption([flag], type=click.Tuple(kinds), metavar=row.metavar, help=row.help),
        *row.more,
        MaskOption(
            [f"{flag}-falloff"],
            type=Number(0.0, finite=True),
            metavar=row.unit,
            help="How far beyond the range the density falls to 0.  [default: 0.0]",
        ),
        MaskOption(
            [f"{flag}-invert"],
            is_flag=True,
            default=None,
            help="Full density outside of the range instead of inside.",
        ),
        MaskOption([f"{flag}-strength"], type=SHARE, metavar="SHARE", help=strength),
    ]


@dataclass(frozen=True)
class Masks:
    """The masks of a command line: the values of their options, by the options' names."""

    given: Mapping[str, Any] = field(default_factory=dict)

    @property
    def files(self) -> list[Path]:
        """The files that the masks read."""
        return [self.given["distance"][0]] if "distance" in self.given else []

    def describe(self) -> dict[str, Any]:
        """The entry of a report; empty without masks."""
        if not self.given:
            return {}
        shown = {name: _plain(value) for name, value in self.given.items()}
        return {"masks": shown}

    def on(
        self,
        surface: dapple.Surface,
        path: Path,
        *,
        count: int | None = None,
        spacing: float | None = None,
        values: Mapping[str, NDArray[np.float64]] | None = None,
        poses: Sequence[NDArray[np.float64]] = (),
    ) -> density.MaskedSurface:
        """The surface of a file with its density in the masks, cut for that many points.

        Args:
            values: densities of classes by their names, see `MaskedSurface`.
            poses: vertices in the poses in which --outside looks; none: where they are.

        Raises:
            ClickException: naming the file and the options that leave nothing of it.
        """
        if not self.given:
            return density.MaskedSurface(surface, count=1, values=values)
        if spacing is not None:
            count = hexagonal_count(surface.area, spacing)
        with about(path):
            fields = self._fields(surface)
        masks = ["outside", *(row.name for row in ROWS)]
        names = ", ".join(f"--{name}" for name in masks if name in self.given)
        with about(f"{path}, in {names}"):
            shaped = density.multiplied(surface, *self._factors(surface))
            outside = self.given.get("openness", OPENNESS) if "outside" in self.given else None
            return density.MaskedSurface(
                shaped, fields, count=count or 1, outside=outside, values=values, poses=poses
            )

    def _factors(self, surface: dapple.Surface) -> list[NDArray[np.float64]]:
        found = []
        if "slope" in self.given:
            found.append(density.slope(surface.corner_normals, self._range("slope", angle=True)))
        if "aspect" in self.given:
            direction = math.radians(self.given["aspect"][0])
            within = self._range("aspect", angle=True)
            found.append(density.aspect(surface.corner_normals, within, direction))
        return found

    def _fields(self, surface: dapple.Surface) -> list[density.Field]:
        found: list[density.Field] = []
        if "height" in self.given:
            largest = float(np.abs(surface.vertices[:, 2]).max())
            found.append(density.Height(self._range("height"), largest))
        if "distance" in self.given:
            plan = bool(self.given.get("distance_ignore_height"))
            nearest = nearest_of(self.given["distance"][0], plan)
            found.append(density.Distance(self._range("distance"), nearest))
        if "border" in self.given:
            edges = density.border_edges(surface.vertices, surface.faces)
            if not len(edges):
                raise ValueError("is closed, so it has no border for --border")
            nearest = density.Nearest(segments=edges)
            found.append(density.Distance(self._range("border"), nearest))
        if "noise" in self.given:
            names = ("size", "detail", "seed")
            chosen = {name: self.given.get(f"noise_{name}") for name in names}
            own = {name: value for name, value in chosen.items() if value is not None}
            found.append(density.Noise(self._range("noise"), **own))
        return found

    def _range(self, name: str, angle: bool = False) -> density.Range:
        low, high = self.given[name][-2:]
        falloff = self.given.get(f"{name}_falloff", 0.0)
        if angle:
            slack = 0.0 if falloff else _SLACK
            low, high, falloff = np.deg2rad([low - slack, high + slack, falloff]).tolist()
        invert = bool(self.given.get(f"{name}_invert"))
        return density.Range(low, high, falloff, invert, self.given.get(f"{name}_strength", 1.0))


def hexagonal_count(area: float, spacing: float) -> int:
    """Number of points with that spacing in a hexagonal packing, limited to _MOST."""
    return int(min(2.0 * area / (math.sqrt(3.0) * spacing**2), _MOST))


def _plain(value: Any) -> Any:
    """The value in types of JSON."""
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float) and math.isinf(value):
        return str(value)
    return str(value) if isinstance(value, Path) else value


def nearest_of(path: Path, plan: bool) -> density.Nearest:
    """Distances to the mesh of a file, or to its points if it has no faces.

    Raises:
        ClickException, FileError: naming the file.
    """
    suffix = path.suffix.lower()
    if suffix in points.ONLY_POINTS or (suffix == ".npz" and "vertices" not in load_npz(path)):
        return _nearest_points(path, plan)
    mesh = read_mesh(path, may_be_empty=True)
    if not len(mesh.faces):
        return _nearest_points(path, plan)
    with about(path):
        checked = dapple.Surface(mesh.vertices, mesh.faces)  # its error names the first fault
        return density.Nearest([(checked.vertices, checked.faces)], plan=plan)


def _nearest_points(path: Path, plan: bool) -> density.Nearest:
    found = points.read_points(path)
    with about(path):
        places = points.in_space(found.positions)
        return density.Nearest(segments=np.repeat(places[:, None], 2, axis=1), plan=plan)


def mask_options(command: Callable[..., None]) -> Callable[..., None]:
    """All options of masks: a command gets them as `masks`."""
    listed = [*OUTSIDE, *(option for row in ROWS for option in _options_of(row))]
    names = {option.name for option in listed}

    @functools.wraps(command)
    def with_masks(**values: Any) -> None:
        given = {name: values.pop(name) for name in names}
        command(masks=_checked({k: v for k, v in given.items() if v is not None}), **values)

    known = getattr(command, "__click_params__", [])
    with_masks.__click_params__ = [*known, *reversed(listed)]  # type: ignore[attr-defined]
    return with_masks


def _checked(given: dict[str, Any]) -> Masks:
    """Raises UsageError for a MIN above its MAX, and for an option of a mask that is not there."""
    if "openness" in given and "outside" not in given:
        raise click.UsageError("--openness needs --outside")
    for row in ROWS:
        if row.name not in given:
            alone = [name for name in given if name.startswith(f"{row.name}_")]
            if alone:
                raise click.UsageError(f"--{alone[0].replace('_', '-')} needs --{row.name}")
            continue
        low, high = given[row.name][-2:]
        if low > high:
            raise click.BadParameter(
                f"MIN is {low:g}, MAX {high:g}: MIN must not be larger than MAX",
                param_hint=f"'--{row.name}'",
            )
    return Masks(given)


class Command(click.Command):
    """A command whose help has masks in a section of their own."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The options, then those of masks."""
        sections: dict[str, list[tuple[str, str]]] = {"Options": [], SECTION: []}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                section = SECTION if isinstance(param, MaskOption) else "Options"
                sections[section].append(record)
        for name, records in sections.items():
            if records:
                with formatter.section(name):
                    if name == SECTION:
                        formatter.write_text(INTRODUCTION)
                    formatter.write_dl(records)
