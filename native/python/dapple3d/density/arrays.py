# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a surface: (v,) at its vertices, (m, 1) on its faces or (m, 3) at their corners."""

from collections.abc import Sequence
from functools import reduce
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._native import Surface, _face_areas, _longest_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]
Indices = NDArray[np.integer]


def shaped(name: str, values: ArrayLike, *shape: int) -> Floats:
    """Values as an array of that shape, in which -1 is any length.

    Raises:
        ValueError: naming the argument, if its shape is another.
    """
    found = np.asarray(values, dtype=np.float64)
    alike = found.ndim == len(shape)
    if not alike or any(n not in (-1, have) for n, have in zip(shape, found.shape, strict=True)):
        wanted = ", ".join("n" if n < 0 else str(n) for n in shape)
        wanted += "," if len(shape) == 1 else ""
        raise ValueError(f"{name} has the shape {found.shape}: ({wanted}) is needed")
    return found


def check_values(name: str, values: Floats, surface: Surface) -> None:
    """Raise ValueError, naming the values, unless they are (v,), (m, 1) or (m, 3) of a surface."""
    vertices, faces = len(surface.vertices), len(surface.faces)
    if values.shape not in ((vertices,), (faces, 1), (faces, 3)):
        raise ValueError(
            f"{name} has the shape {values.shape}: ({vertices},), ({faces}, 1) or ({faces}, 3) is "
            "needed"
        )


def product(values: Sequence[Floats], faces: Ints) -> Floats:
    """Values multiplied, each at vertices (v,), on faces (m, 1) or at their corners (m, 3).

    The product is at the coarsest of these places that holds all of it: of (v,) and (m, 1) it is at
    the corners.
    """
    of_vertices = [one for one in values if one.ndim == 1]
    found = [one for one in values if one.ndim == 2]
    if of_vertices:
        smooth: Floats = np.prod(of_vertices, axis=0)
        found.append(smooth[faces] if found else smooth)
    return reduce(np.multiply, found)


def at_corners(values: Floats | None, faces: Ints) -> Floats:
    """Values at the corners (m, 3) of faces (m, 3); 1 where there are none."""
    if values is None:
        return np.ones((len(faces), 3))
    if values.ndim == 1:
        return values[faces]
    found: Floats = np.broadcast_to(values, (len(faces), 3))
    return found


def density_of(surface: Surface) -> Floats | None:
    """Density of a surface as (v,), (m, 1) or (m, 3); None where it is the same everywhere."""
    density = surface.density
    if density is None or surface.density_at != "faces":
        return density
    return density[:, None]


def placed(values: Floats | None) -> tuple[Floats | None, Literal["vertices", "faces", "corners"]]:
    """Values as `dapple.Surface` takes a density, and the name of the place that they are at."""
    if values is None or values.ndim == 1:
        return values, "vertices"
    return (values[:, 0], "faces") if values.shape[1] == 1 else (values, "corners")


def multiplied(surface: Surface, *factors: Floats) -> Surface:
    """The surface with its density multiplied by factors: (v,), (m, 1) or (m, 3), each >= 0.

    Raises:
        ValueError: a factor has another shape, or a value that no density can have.
    """
    for k, one in enumerate(factors):
        check_values(f"factor {k}", one, surface)
    own = density_of(surface)
    terms = [*factors] if own is None else [*factors, own]
    if not factors:
        return surface
    values, at = placed(product(terms, surface.faces))
    return surface.with_density(values, density_at=at)


def longest_edges(points: Floats, faces: Ints) -> Floats:
    """Longest edge (m,) of faces (m, 3) of vertices (v, 3)."""
    return _longest_edges(points, faces)


def face_areas(points: Floats, faces: Ints) -> Floats:
    """Area (m,) of faces (m, 3) of vertices (v, 3)."""
    return _face_areas(points, faces)


def over_corners(join: np.ufunc, values: NDArray[Any], faces: Ints) -> NDArray[Any]:
    """Values (v,) at vertices joined over the corners of each face (m, 3).

    Columns are several times faster than a reduction of rows of three.
    """
    a, b, c = (values[corner] for corner in np.ascontiguousarray(faces.T))
    found: NDArray[Any] = join(join(a, b), c)
    return found


def vertices_of(faces: Ints, count: int) -> Indices:
    """The vertices of faces (m, 3), of so many, ascending."""
    used = np.zeros(count, dtype=bool)
    used[faces] = True
    return np.flatnonzero(used)
