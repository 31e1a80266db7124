# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on several frames, in npz and USD files; files of still points are one frame."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from dapple3d.cli import points, text
from dapple3d.cli.files import about, load_npz
from dapple3d.cli.points import Points
from dapple3d.extras import usd
from dapple3d.writing import replacing, write_npz


@dataclass(frozen=True)
class Motion:
    """Points on one or more frames.

    times: their numbers, if the file has them.
    scene: fps, up and meters_per_unit as in dapple3d.extras.usd, if the file has them.
    """

    frames: list[Points]
    times: NDArray[np.float64] | None = None
    scene: dict[str, Any] = field(default_factory=dict)


def read(path: Path) -> Motion:
    """Read one frame or all, in the format of the extension.

    Raises:
        ClickException: naming the file and what is wrong with it.
        OSError: naming the file.
    """
    suffix = path.suffix.lower()
    if suffix in usd.SUFFIXES:
        with about(path):
            found = usd.read(path)
            frames = [points.of_instances(frame) for frame in found.frames]
            scene = {name: getattr(found, name) for name in ("fps", "up", "meters_per_unit")}
            return Motion(frames, found.times if found.times.any() else None, scene)
    if suffix == ".npz":
        arrays = load_npz(path)
        if "starts" in arrays:
            with about(path):
                return Motion(_changing(arrays), _times(arrays, len(arrays["starts"]) - 1))
        if "positions" in arrays and arrays["positions"].ndim == 3:
            with about(path):
                return Motion(_frames(arrays), _times(arrays, len(arrays["positions"])))
    if suffix == ".csv":
        with about(path):
            return _of_table(text.read_csv(path))
    return Motion([points.read_points(path)])


def _of_table(columns: dict[str, NDArray]) -> Motion:
    """The points of each frame are the lines with its number."""
    if "frame" not in columns:
        return Motion([points.from_columns(columns)])
    times = np.unique(columns["frame"])
    rows = [columns["frame"] == time for time in times]
    frames = [{name: values[row] for name, values in columns.items()} for row in rows]
    return Motion([points.from_columns(frame) for frame in frames], times)


def _changing(arrays: dict[str, NDArray]) -> list[Points]:
    """Points of frame k are the rows starts[k] to starts[k + 1]; a fade below 1 scales them."""
    if "positions" not in arrays:
        raise ValueError("has starts, but no positions")
    joined = points.from_arrays(arrays).arrays()
    rows = len(joined["positions"])
    starts = _starts(arrays["starts"], rows)
    if "fade" in arrays:
        fade = arrays["fade"]
        if fade.shape != (rows,) or fade.dtype.kind not in "fiu":
            raise ValueError(
                f"fade is {fade.dtype.name} {fade.shape}: numbers ({rows},) are needed"
            )
        joined["scales"] = joined.get("scales", np.ones((rows, 3))) * fade[:, None]
    return [
        Points(**{name: values[begin:end] for name, values in joined.items()})
        for begin, end in pairwise(starts)
    ]


def _starts(starts: NDArray, rows: int) -> list[int]:
    """Check that starts begin with 0, do not decrease and end with the number of rows."""
    if starts.ndim == 1 and len(starts) > 1 and starts.dtype.kind in "iu":
        found: list[int] = starts.tolist()
        if found[0] == 0 and found[-1] == rows and found == sorted(found):
            return found
    raise ValueError(f"starts does not divide the {rows} rows of positions into frames")


def _times(arrays: dict[str, NDArray], count: int) -> NDArray[np.float64] | None:
    """The frame numbers, if there is one for each frame."""
    times = arrays.get("times")
    if times is None:
        return None
    if times.shape != (count,) or times.dtype.kind not in "fiu":
        raise ValueError(
            f"times is {times.dtype.name} {times.shape}: a number for each frame is needed"
        )
    return times.astype(np.float64)


def _frames(arrays: dict[str, NDArray]) -> list[Points]:
    """The frames one after the other; an array without an axis for frames is the same on all."""
    positions = arrays["positions"]
    if positions.shape[2] not in (2, 3) or positions.dtype.kind not in "fiu":
        raise ValueError(
            f"positions is {positions.dtype.name} {positions.shape}: numbers (frames, n, 2) or "
            "(frames, n, 3) are needed"
        )
    count = len(positions)
    if count == 0:
        raise ValueError("positions holds no frame")
    known = {
        name: values for name, values in arrays.items() if name in (*points.NAMES, *points.CARRIED)
    }
    moving = {name for name, values in known.items() if values.ndim > _dimensions(name)}
    for name in moving:
        if len(known[name]) != count:
            raise ValueError(f"{name} has {len(known[name])} frames, but positions {count}")
    return [
        points.from_arrays(
            {name: known[name][k] if name in moving else known[name] for name in known}
        )
        for k in range(count)
    ]


def _dimensions(name: str) -> int:
    """Number of dimensions of the array of one frame."""
    return 1 if name in points.WHOLE else 2


def write_npz_motion(path: Path, frames: Sequence[Points]) -> None:
    """Write several frames: a first axis for them, but of ids and classes, which are of all.

    Raises:
        ClickException: the points are not the same ones on all frames.
    """
    first = frames[0]
    for name in ("ids", "classes"):
        if any(not _same(getattr(frame, name), getattr(first, name)) for frame in frames):
            raise click.ClickException(f"{path}: {name} change over the frames; USD can hold that")
    if len({len(frame.positions) for frame in frames}) > 1:
        raise click.ClickException(f"{path}: the number of points changes; USD can hold that")
    arrays = {
        name: values if name in ("ids", "classes") else np.stack([f.arrays()[name] for f in frames])
        for name, values in first.arrays().items()
    }
    with replacing(path) as file:
        write_npz(file, arrays)


def _same(one: NDArray | None, other: NDArray | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other)


def scaled(found: Points, factor: float) -> Points:
    """The frame with its instances scaled."""
    scales = np.ones((len(found.positions), 3)) if found.scales is None else found.scales
    return replace(found, scales=factor * scales)
