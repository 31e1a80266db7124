# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from files: vertices, faces and other arrays."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from . import _native as native
from .extras._gltf_meshes import SUFFIXES as GLTF
from .extras._gltf_meshes import read_arrays

__all__ = ["SUFFIXES", "MeshArrays", "check_suffix", "read_mesh"]

SUFFIXES: Final = (".ply", ".obj", ".stl", ".off", *GLTF)
"""Suffixes of the files that read_mesh() reads."""

Floats = NDArray[np.float64]


class MeshArrays(tuple[Floats, NDArray[np.int32]]):
    """Vertices and faces as Surface takes them, with the other arrays of the file.

    Arrays that the file does not have are None.

    Attributes:
        polygons: (m,) int32, the polygon of the file that each triangle was cut from.
        uv: (m, 3, 2) float64, texture coordinates at the corners; 0 where there are none.
        normals: (m, 3, 3) float64, at the corners; 0 where there are none.
        colors: (m, 3, 4) float32, red, green, blue and opacity at the corners, 0 to 1.
        vertex_attributes: further properties of the vertices by name, each (v,) float64.
        face_attributes: properties of the faces by name, each (m,) float64.
    """

    polygons: NDArray[np.int32] | None
    uv: Floats | None
    normals: Floats | None
    colors: NDArray[np.float32] | None
    vertex_attributes: dict[str, Floats]
    face_attributes: dict[str, Floats]

    def __new__(
        cls,
        vertices: Floats,
        faces: NDArray[np.int32],
        *,
        polygons: NDArray[np.int32] | None = None,
        uv: Floats | None = None,
        normals: Floats | None = None,
        colors: NDArray[np.float32] | None = None,
        vertex_attributes: Mapping[str, Floats] = {},
        face_attributes: Mapping[str, Floats] = {},
    ) -> Self:
        made = super().__new__(cls, (vertices, faces))
        made.polygons, made.uv, made.normals, made.colors = polygons, uv, normals, colors
        made.vertex_attributes = dict(vertex_attributes)
        made.face_attributes = dict(face_attributes)
        return made

    def __getnewargs__(self) -> tuple[Floats, NDArray[np.int32]]:
        return self[0], self[1]

    @property
    def vertices(self) -> Floats:
        """(v, 3) float64."""
        return self[0]

    @property
    def faces(self) -> NDArray[np.int32]:
        """(m, 3) int32."""
        return self[1]


def check_suffix(path: str | os.PathLike[str], known: Sequence[str]) -> None:
    """Raise FileError unless a file has one of several suffixes."""
    suffix = Path(path).suffix.lower()
    if suffix not in known:
        raise native.FileError(
            f"{os.fspath(path)} has the suffix '{suffix}': "
            f"supported are {', '.join(known[:-1])} and {known[-1]}"
        )


def read_mesh(path: str | os.PathLike[str], *, may_be_empty: bool = False) -> MeshArrays:
    """Read a mesh from .off, .obj, .ply, .stl, .glb or .gltf, without rounding.

    Polygons are triangulated, also concave ones and those that are not quite planar. The meshes of
    a glTF file are joined, in meters, with z up and v up in images; skinned meshes take the pose of
    their joints.

    Args:
        path: the file.
        may_be_empty: whether a mesh without faces is accepted, as in a frame of a fluid.

    Raises:
        FileError: naming the file and what is wrong with it.
    """
    check_suffix(path, SUFFIXES)
    if Path(path).suffix.lower() not in GLTF:
        return MeshArrays(**native._read_mesh(path, may_be_empty))
    if not Path(path).is_file():
        raise native.FileError(f"{os.fspath(path)} is not a readable file")
    try:
        return MeshArrays(**read_arrays(path, may_be_empty=may_be_empty))
    except ValueError as error:
        raise native.FileError(str(error)) from error
