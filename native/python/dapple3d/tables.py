# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of instances, for scripts and spreadsheets: CSV, and npz with numpy's arrays.

>>> from dapple3d import instances, tables
>>> tables.write("points.csv", [instances.of_samples(samples)])

`dapple export` reads both, several frames as a motion.
"""

import csv
import io
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .instances import Instances, Scatter
from .writing import replacing, write_npz

__all__ = ["COLUMNS", "SUFFIXES", "write"]

SUFFIXES: Final = (".csv", ".npz")
"""Suffixes of the files that write() writes."""

COLUMNS: Final[dict[str, tuple[str, ...]]] = {
    "positions": ("x", "y", "z"),
    "normals": ("nx", "ny", "nz"),
    "orientations": ("qw", "qx", "qy", "qz"),
    "scales": ("sx", "sy", "sz"),
    "velocities": ("vx", "vy", "vz"),
    "ids": ("id",),
    "classes": ("class",),
    "prototypes": ("prototype",),
}
"""Names of the columns of a CSV file."""

CONSTANT = ("ids", "classes", "prototypes")


def write(
    path: str | os.PathLike[str],
    frames: Sequence[Instances],
    *,
    times: ArrayLike | None = None,
    names: Sequence[str] = (),
) -> None:
    """Write instances, frame after frame, without rounding.

    CSV has a header and a line for each instance and frame, with a column `frame` if times are
    given. npz has the arrays of Instances by their names. With several frames the first axis of
    the arrays is the frame, except for ids, classes and prototypes, which must be the same on all
    frames; `times` is a further array.

    Args:
        path: ends with one of SUFFIXES.
        frames: the instances; in CSV their number may change.
        times: (frames,) numbers of the frames.
        names: of the prototypes: the last column `object` in CSV, the array `names` in npz.

    Raises:
        ValueError: an argument is wrong, or npz cannot hold it.
        OSError: naming the file.
    """
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"{target}: a table ends with {' or '.join(SUFFIXES)}")
    scatter = Scatter("points", frames)
    codes = None if times is None else np.asarray(times, np.float64)
    if codes is not None and codes.shape != (len(frames),):
        raise ValueError(f"times has the shape {codes.shape}: ({len(frames)},) is needed")
    if 0 < len(names) < scatter.needed:
        raise ValueError(
            f"names has {len(names)} of {scatter.needed} entries: one for each prototype is needed"
        )
    if suffix == ".npz":
        arrays = _stacked(frames) | ({} if codes is None else {"times": codes})
        with replacing(target) as file:
            write_npz(file, arrays | ({"names": np.array(names)} if names else {}))
    else:
        with replacing(target) as file:
            _write_csv(file, frames, codes, names)


def _stacked(frames: Sequence[Instances]) -> dict[str, NDArray]:
    first = frames[0].arrays()
    if len(frames) == 1:
        return first
    for name in CONSTANT:
        for k, frame in enumerate(frames):
            if not np.array_equal(frame.arrays().get(name, ()), first.get(name, ())):
                raise ValueError(f"{name} of frames[{k}] are others than before: CSV can hold that")
    return {
        name: values if name in CONSTANT else np.stack([frame.arrays()[name] for frame in frames])
        for name, values in first.items()
    }


def _write_csv(
    file: IO[bytes], frames: Sequence[Instances], codes: NDArray | None, names: Sequence[str]
) -> None:
    heads = [head for name in frames[0].arrays() for head in COLUMNS[name]]
    text = io.TextIOWrapper(file, "utf-8", newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        [*(["frame"] if codes is not None else []), *heads, *(["object"] if names else [])]
    )
    for k, frame in enumerate(frames):
        columns = list(_columns(frame))
        if codes is not None:
            columns.insert(0, [f"{codes[k]:.17g}"] * len(frame))
        if names:
            columns.append([names[one] for one in frame.placed])
        rows.writerows(zip(*columns, strict=True))
    text.detach()


def _columns(frame: Instances) -> Iterator[list[Any]]:
    for values in frame.arrays().values():
        table = values[:, None] if values.ndim == 1 else values
        yield from (column.tolist() for column in table.T)
