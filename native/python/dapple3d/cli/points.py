# SPDX-License-Identifier: GPL-3.0-or-later
"""Point sets in files: PLY, CSV, npz, OBJ, OFF, USD, glTF and scenes of Godot, by the extension.

All digits are kept, but by USD, glTF and Godot, whose numbers have 32 bits.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d import instances
from dapple3d.cli import ply, text
from dapple3d.cli.files import Arrays, about, listed, load_npz, quoted, unknown_format
from dapple3d.extras import gltf, godot, usd
from dapple3d.tables import COLUMNS
from dapple3d.writing import replacing, write_npz


@dataclass(frozen=True)
class Points:
    """A point set; arrays that a file does not hold are None.

    positions: (n, 2) or (n, 3) float64.
    normals: (n, 3) float64. ids, classes: (n,) int32.
    faces, barycentric: (n,) int32 and (n, 3) float64, where on the mesh each point is.
    orientations, scales, velocities: (n, 4), (n, 3), (n, 3) float64, and
    prototypes: (n,) int32, as in dapple3d.instances.
    uv, colors, polygons: (n, 2) and (n, 4) float64, (n,) int32, of the mesh there.
    attributes: its other numbers there by name, each (n,) or (n, k).
    """

    positions: NDArray
    normals: NDArray | None = None
    ids: NDArray | None = None
    classes: NDArray | None = None
    faces: NDArray | None = None
    barycentric: NDArray | None = None
    orientations: NDArray | None = None
    scales: NDArray | None = None
    velocities: NDArray | None = None
    prototypes: NDArray | None = None
    uv: NDArray | None = None
    colors: NDArray | None = None
    polygons: NDArray | None = None
    attributes: Any = field(default_factory=dict)  # Arrays; mypy cannot express it here

    def arrays(self) -> Arrays:
        """The arrays that are not None, by name."""
        own = {name: value for name, value in vars(self).items() if name != "attributes"}
        return {name: value for name, value in own.items() if value is not None} | self.attributes


OF_SAMPLES = ("positions", "normals", "ids", "classes", "faces", "barycentric")
NAMES = (*OF_SAMPLES, "orientations", "scales", "velocities", "prototypes")
EXACT = 2**53  # integers up to this are exact as 64-bit floats
SINGLE = 1e-6  # relative error of coordinates in single precision
TOUCH = 1e-3  # of the spacing
CARRIED = ("uv", "colors", "polygons")  # of a mesh
WIDTHS = {
    **{"normals": 3, "barycentric": 3, "orientations": 4, "scales": 3, "velocities": 3},
    **{"uv": 2, "colors": 4},
}
WHOLE = ("ids", "classes", "faces", "prototypes", "polygons")
VECTORS = {
    **{name: heads for name, heads in COLUMNS.items() if len(heads) > 1 and name != "positions"},
    **{"uv": ("u", "v"), "colors": ("red", "green", "blue", "alpha")},
}
WHOLE_COLUMNS = {
    **{name: heads[0] for name, heads in COLUMNS.items() if len(heads) == 1},
    "polygons": "polygon",
}


def points_of(samples: dapple.Samples) -> Points:
    """All arrays of the samples."""
    return Points(**{name: getattr(samples, name) for name in OF_SAMPLES})


def instances_of(points: Points) -> instances.Instances:
    """The points as instances.

    Raises:
        ValueError: naming the array that is wrong and its first offender.
    """
    known = ("orientations", "scales", "velocities", "normals", "ids", "classes", "prototypes")
    return instances.Instances(
        _padded(points.positions), **{name: getattr(points, name) for name in known}
    )


def of_instances(found: instances.Instances) -> Points:
    """The points of what was read.

    Raises:
        ValueError: naming the first id that has more than 32 bits.
    """
    arrays = found.arrays()
    return Points(
        **{name: whole(name, arr) if name in WHOLE else arr for name, arr in arrays.items()}
    )


def write_points(path: Path, points: Points) -> None:
    """Write in the format of the extension; the file is complete or not written.

    Raises:
        ClickException: no points can be written with this extension, or a number does not fit.
        OSError: naming the file.
    """
    suffix = check_extension(path)
    with about(path):
        points = _fitting(points)
    if suffix in SCENES:
        with about(path):
            SCENES[suffix].write(path, *instances.along_normals([instances_of(points)]))
        return
    with replacing(path) as file:
        WRITERS[suffix](file, points)


def _fitting(points: Points) -> Points:
    """The points with integers where the format has them.

    Raises:
        ValueError: naming the first number that does not fit.
    """
    given = {name: getattr(points, name) for name in WHOLE}
    fields: dict[str, Any] = {
        name: whole(name, np.asarray(values))
        for name, values in given.items()
        if values is not None
    }
    for name, values in points.attributes.items():
        _check_exact(name, values)
    return replace(points, **fields)


def _check_exact(name: str, values: NDArray) -> None:
    """Raise ValueError, naming the first integer that is not exact as a float."""
    if values.dtype.kind in "iu" and values.dtype.itemsize == 8:
        wrong = np.argwhere((values > EXACT) | (values < -EXACT))
        if len(wrong):
            row, value = wrong[0][0], values[tuple(wrong[0])]
            raise ValueError(f"{name} of point {row} is {value}: whole numbers end at {EXACT}")


def check_extension(path: Path) -> str:
    """The extension, in lower case, of a file that points can be written to.

    Raises:
        ClickException: naming those that there are.
        ImportError: it needs a module that is not installed.
    """
    suffix = path.suffix.lower()
    if suffix in usd.SUFFIXES:
        usd.check_installed()
    if suffix in FORMATS:
        return suffix
    trouble = "STL holds triangles, no points" if suffix == ".stl" else unknown_format(path)
    raise click.ClickException(f"{path}: {trouble}; points are written as {listed(FORMATS)}")


def read_points(path: Path) -> Points:
    """Read points, in the format of the extension.

    Raises:
        ClickException: naming the file and what is wrong with it.
        OSError: naming the file.
    """
    read = READERS.get(path.suffix.lower())
    if read is None:
        raise click.ClickException(
            f"{path}: {unknown_format(path)}; points are read from {listed(READERS)}"
        )
    with about(path):
        return read(path)


def in_space(positions: NDArray) -> NDArray:
    """(n, 3) of (n, 2) or (n, 3); points of the plane get z = 0.

    Raises:
        ValueError: there are no points.
    """
    if len(positions) == 0:
        raise ValueError("holds no points")
    return _padded(positions)


def _padded(positions: NDArray) -> NDArray:
    return np.pad(positions, ((0, 0), (0, 3 - positions.shape[1])))


def bound(surface: dapple.Surface, path: Path) -> dapple.Samples:
    """The points of a file on the surface: where it says that they are, or else nearest.

    Raises:
        ClickException: naming the file and its first point that is not finite or has no place.
    """
    points = read_points(path)
    stored = stored_places(surface, points, path)
    if stored is not None:
        return stored
    with about(path):
        near = dapple.project(surface, in_space(points.positions))
        return dapple.Samples(
            surface, near.faces, near.barycentric, ids=points.ids, classes=points.classes
        )


def stored_places(surface: dapple.Surface, points: Points, path: Path) -> dapple.Samples | None:
    """The points on the faces that their file names, if it does and they are of this surface.

    If they are not, a sentence says so on stderr.
    """
    if points.faces is None or points.barycentric is None:
        return None
    with about(path):
        places = in_space(points.positions)
    try:
        found = dapple.Samples(
            surface, points.faces, points.barycentric, ids=points.ids, classes=points.classes
        )
        _check_places(surface, found, places)
    except ValueError as error:
        click.echo(
            f"{path}: its faces are not those of the mesh ({error}); "
            "each point counts where the mesh is nearest",
            err=True,
        )
        return None
    return found


def _check_places(surface: dapple.Surface, found: dapple.Samples, places: NDArray) -> None:
    """Check that points are where their faces put them, within rounding and TOUCH spacings."""
    size = float(np.abs(surface.vertices).max(initial=0.0))
    most = SINGLE * size + TOUCH * surface.spacing(len(found))
    off = np.linalg.norm(found.positions - places, axis=1)
    wrong = np.flatnonzero(~(off <= most))
    if len(wrong):
        raise ValueError(f"point {wrong[0]} is {off[wrong[0]]:.3g} away from its place there")


def _columns(points: Points) -> Arrays:
    columns = dict(zip("xyz", points.positions.T, strict=False))
    for name, letters in VECTORS.items():
        values = getattr(points, name)
        if values is not None:
            columns |= dict(zip(letters, values.T, strict=True))
    for name, column in WHOLE_COLUMNS.items():
        if getattr(points, name) is not None:
            columns[column] = getattr(points, name)
    for name, values in points.attributes.items():
        columns |= dict(_named_columns(name, values))
    return columns


def _named_columns(name: str, values: NDArray) -> Iterator[tuple[str, NDArray]]:
    """Columns of an array: its name for (n,), name_0, name_1 and so on for (n, k)."""
    if values.ndim == 1:
        yield name, values if values.dtype == np.int32 else values.astype(np.float64)
        return
    for k, column in enumerate(values.reshape(len(values), -1).T):
        yield f"{name}_{k}", column.astype(np.float64)


def check_carried(source: str, name: str, values: NDArray) -> None:
    """Refuse texture coordinates, colors and polygons of another shape.

    Raises:
        ClickException: naming the file and the array.
    """
    widths = {"uv": (2,), "colors": (3, 4), "polygons": ()}.get(name)
    if widths is None:
        return
    fits = values.ndim == 1 if not widths else values.ndim == 2 and values.shape[1] in widths
    if not fits:
        raise click.ClickException(
            f"{source}: array '{name}' has {values.shape[1:]} numbers a row: "
            f"{' or '.join(map(str, widths)) or 'one'} are needed"
        )


def whole(name: str, values: NDArray) -> NDArray[np.int32]:
    """The values as int32.

    Raises:
        ValueError: naming the first that is no whole number of 32 bits.
    """
    if values.ndim != 1 or values.dtype.kind not in "fiu":
        raise ValueError(
            f"{name} is {values.dtype.name} {values.shape}: whole numbers (n,) are needed"
        )
    limits = np.iinfo(np.int32)
    fits = (values >= limits.min) & (values <= limits.max) & (values == np.floor(values))
    if not fits.all():
        k = int(np.flatnonzero(~fits)[0])
        raise ValueError(
            f"{name} of point {k} is {values[k]:.17g}: a whole number of 32 bits is needed"
        )
    return values.astype(np.int32)


def from_columns(columns: Mapping[str, NDArray]) -> Points:
    """The points of columns of these names; others are left out.

    Raises:
        ValueError: x or y is missing, or a whole number is none.
    """

    def stacked(*names: str) -> NDArray | None:
        if not all(name in columns for name in names):
            return None
        return np.column_stack([columns[name] for name in names]).astype(np.float64)

    positions = stacked("x", "y", "z") if "z" in columns else stacked("x", "y")
    if positions is None:
        raise ValueError(f"has the columns {', '.join(columns)}: x, y (and z) are needed")
    vectors = {name: stacked(*letters) for name, letters in VECTORS.items()}
    numbers = {
        name: whole(column, columns[column])
        for name, column in WHOLE_COLUMNS.items()
        if column in columns
    }
    return Points(positions, **vectors | {"colors": _colors(columns)}, **numbers)


def _colors(columns: Mapping[str, NDArray]) -> NDArray | None:
    """Colors from 0 to 1; integers of a PLY file are divided by 255."""
    if not all(name in columns for name in ("red", "green", "blue")):
        return None
    parts = [columns[name] for name in VECTORS["colors"] if name in columns]
    values = np.column_stack(parts).astype(np.float64)
    if all(part.dtype.kind == "u" for part in parts) or values.max(initial=0.0) > 1.0:
        values /= 255.0
    return np.column_stack([values, np.ones((len(values), 4 - len(parts)))])


def from_arrays(arrays: Mapping[str, NDArray]) -> Points:
    """The points of arrays with the names of Points; other arrays are skipped.

    Raises:
        ValueError: naming the array whose type, shape or whole numbers are wrong.
    """
    positions = _numbers("positions", arrays["positions"], "n", 2, 3)
    found: Arrays = {"positions": positions}
    for name in (*NAMES[1:], *CARRIED):
        if name not in arrays:
            continue
        values = arrays[name]
        if values.shape[:1] != positions.shape[:1]:
            raise ValueError(
                f"{name} has the shape {values.shape}: {len(positions)} rows are needed"
            )
        if name in WHOLE:
            found[name] = whole(name, values)
        else:
            found[name] = _numbers(name, values, len(positions), WIDTHS[name])
    return Points(**found)


def _numbers(name: str, values: NDArray, rows: int | str, *widths: int) -> NDArray[np.float64]:
    """The values as float64, in rows of one of the widths."""
    if values.ndim != 2 or values.shape[1] not in widths or values.dtype.kind not in "fiu":
        shapes = " or ".join(f"({rows}, {width})" for width in widths)
        raise ValueError(
            f"{name} is {values.dtype.name} {values.shape}: numbers {shapes} are needed"
        )
    return values.astype(np.float64)


def _read_npz(path: Path) -> Points:
    arrays = load_npz(path)
    if "positions" not in arrays:
        raise ValueError(f"has no array 'positions', only {quoted(arrays)}")
    if "starts" in arrays:
        raise ValueError("holds several frames; `dapple export --frame` takes one out")
    return from_arrays(arrays)


def _read_usd(path: Path) -> Points:
    frames = usd.read(path).frames
    if len(frames) > 1:
        raise ValueError(f"holds {len(frames)} frames; `dapple export --frame` takes one out")
    return of_instances(frames[0])


def _write_npz(file: IO[bytes], points: Points) -> None:
    write_npz(file, points.arrays())


def _write_ply(file: IO[bytes], points: Points) -> None:
    columns = _columns(points)
    if points.colors is not None:  # in the type that other programs expect
        for name in VECTORS["colors"]:
            columns[name] = np.rint(255.0 * np.clip(columns[name], 0.0, 1.0)).astype(np.uint8)
    ply.write(file, columns)


def _write_csv(file: IO[bytes], points: Points) -> None:
    text.write_csv(file, _columns(points))


def _write_obj(file: IO[bytes], points: Points) -> None:
    text.write_obj(file, _columns(points))


def _write_off(file: IO[bytes], points: Points) -> None:
    text.write_off(file, _columns(points))


WRITERS: dict[str, Callable[[IO[bytes], Points], None]] = {
    ".ply": _write_ply,
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".obj": _write_obj,
    ".off": _write_off,
}
READERS: dict[str, Callable[[Path], Points]] = {
    ".ply": lambda path: from_columns(ply.read(path)),
    ".csv": lambda path: from_columns(text.read_csv(path)),
    ".npz": _read_npz,
    ".obj": lambda path: from_columns(text.read_obj(path)),
    ".off": lambda path: from_columns(text.read_off(path)),
    **dict.fromkeys(usd.SUFFIXES, _read_usd),
    **dict.fromkeys(gltf.SUFFIXES, lambda path: of_instances(gltf.read(path))),
}
ONLY_POINTS = (".csv", *usd.SUFFIXES)  # formats that hold no mesh
SCENES: dict[str, Any] = {  # formats that also hold prototypes, and their modules
    suffix: module for module in (usd, gltf, godot) for suffix in module.SUFFIXES
}
FORMATS = (*WRITERS, *SCENES)
