# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces from files: PLY, OBJ, STL, OFF, glTF, and npz with densities."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d._meshes import SUFFIXES, check_suffix
from dapple3d.cli import ply
from dapple3d.cli.files import Arrays, about, load_npy, load_npz, quoted

Place = Literal["vertices", "faces", "corners"]


@dataclass(frozen=True)
class Mesh:
    """The content of a file, not validated yet.

    vertices: (v, 3) float64, or (frames, v, 3) in an npz of a motion.
    faces: (m, 3) int32.
    arrays: the others of an npz, by name.
    said: the other arrays of a file that is not an npz.
    """

    path: Path
    vertices: NDArray
    faces: NDArray
    arrays: Arrays = field(default_factory=dict)
    said: dapple.MeshArrays | None = None

    @property
    def polygons(self) -> NDArray[np.int64]:
        """(m,), not falling: the polygon of each triangle, or each its own."""
        if self.said is not None and self.said.polygons is not None:
            return self.said.polygons.astype(np.int64)
        return np.arange(len(self.faces))


@dataclass(frozen=True)
class SurfaceOptions:
    """Options of a surface, see dapple.Surface.

    weld: whether border edges at the same place are connected.
    """

    weld: bool = True
    merge_doubled: bool = True
    sharp_angle: float = 30.0

    @staticmethod
    def of(surface: dapple.Surface) -> "SurfaceOptions":
        """The options of a surface."""
        return SurfaceOptions(surface.weld is not None, surface.merge_doubled, surface.sharp_angle)


@dataclass(frozen=True)
class Density:
    """Values and the place that they are at; None is 1 everywhere."""

    values: NDArray | None = None
    at: Place = "vertices"
    source: str = ""

    def options(self) -> dict[str, Any]:
        """Options of a dapple.SampleClass or a surface with this density."""
        return {"density": self.values, "density_at": self.at}

    def as_rows(self) -> NDArray[np.float64]:
        """(v,) at vertices, (m, 1) on faces, (m, 3) at corners."""
        values = np.asarray(self.values, dtype=np.float64)
        return values[:, None] if self.at == "faces" else values


def read_mesh(path: Path, *, may_be_empty: bool = False) -> Mesh:
    """Read a mesh, by the extension of its file; one without faces only if it may be empty.

    Raises:
        FileError, ClickException: naming the file and what is wrong with it.
    """
    check_suffix(path, (*SUFFIXES, ".npz"))
    if path.suffix.lower() != ".npz":
        said = dapple.read_mesh(path, may_be_empty=may_be_empty)
        return Mesh(path, *said, said=said)
    arrays = load_npz(path)
    for name in ("vertices", "faces"):
        if name not in arrays:
            raise click.ClickException(f"{path}: has no array '{name}', only {quoted(arrays)}")
    mesh = Mesh(path, arrays.pop("vertices"), arrays.pop("faces"), arrays)
    if mesh.vertices.ndim not in (2, 3) or mesh.faces.ndim != 2:
        raise click.ClickException(
            f"{path}: vertices {mesh.vertices.shape} and faces {mesh.faces.shape} are not "
            "(v, 3), or (frames, v, 3), and (m, 3)"
        )
    return mesh


def read_density(mesh: Mesh, wanted: str | None, at: Place | None = None) -> Density:
    """The density that an option names: a .npy file, or an array of the mesh's npz.

    Args:
        mesh: whose vertices, faces or corners it belongs to.
        wanted: None is the npz's array 'density', if there is one.
        at: where the values are; None tells it from their shape, vertices first.

    Raises:
        ClickException: there is no such array, or it fits neither vertices, faces nor corners.
    """
    values, source = _density_values(mesh, wanted, at)
    if values is None:
        return Density()
    return Density(
        values, at or _known_place(mesh, wanted) or _place_of(mesh, values, source), source
    )


def _known_place(mesh: Mesh, wanted: str | None) -> Place | None:
    """The element that a property of a PLY file belongs to."""
    if mesh.said is None or wanted is None or wanted in mesh.said.vertex_attributes:
        return None
    return "faces" if wanted in mesh.said.face_attributes else None


@dataclass(frozen=True)
class Loaded:
    """The checked surface of a mesh with its density."""

    mesh: Mesh
    surface: dapple.Surface
    density: Density

    def doubled(self) -> str:
        """The end of a line about the surface: the number of doubled faces."""
        doubled = self.surface.doubled_faces
        if not doubled:
            return ""
        return (
            "; 1 doubled face counts once"
            if doubled == 1
            else f"; {doubled} doubled faces count once"
        )

    def describe(self) -> dict[str, Any]:
        """The entry of a report about the input."""
        return {
            "mesh": str(self.mesh.path),
            "vertices": len(self.surface.vertices),
            "faces": len(self.surface.faces),
            "doubled_faces": self.surface.doubled_faces,
            "area": self.surface.area,
            "density": self.density.source or None,
            "density_at": self.density.at,
        }


def load(
    mesh: Mesh,
    density: str | None = None,
    at: Place | None = None,
    options: SurfaceOptions = SurfaceOptions(),
) -> Loaded:
    """Check a mesh, and give it the density that an option names.

    Args:
        mesh: from read_mesh().
        density, at: as for read_density().
        options: how the surface is made of it.

    Raises:
        ClickException: naming the file, the rule and the first offender.
    """
    with about(mesh.path):
        unwelded: dict[str, Any] = {} if options.weld else {"weld": None}
        surface = dapple.Surface(
            mesh.vertices,
            mesh.faces,
            merge_doubled=options.merge_doubled,
            sharp_angle=options.sharp_angle,
            normals=_normals(mesh),
            **unwelded,
        )
    found = read_density(mesh, density, at)
    return Loaded(mesh, with_density(surface, found), found)


def _normals(mesh: Mesh) -> NDArray | None:
    """Normals (m, 3, 3) of the corners, 0 where missing; None if the mesh has none."""
    normals = _npz_normals(mesh) if mesh.said is None else mesh.said.normals
    return None if normals is None else np.where(np.isfinite(normals), normals, 0.0)


def _npz_normals(mesh: Mesh) -> NDArray | None:
    """Normals at corners or vertices; an array of another shape is ignored."""
    normals, faces, count = mesh.arrays.get("normals"), mesh.faces, len(mesh.vertices)
    if normals is None or normals.dtype.kind not in "fiu":
        return None
    if normals.shape == (len(faces), 3, 3):
        return normals
    there = faces.dtype.kind in "iu" and ((faces >= 0) & (faces < count)).all()
    return normals[faces] if normals.shape == (count, 3) and there else None


def with_density(surface: dapple.Surface, density: Density) -> dapple.Surface:
    """The surface with the density, if there is one; errors name where it comes from."""
    if density.values is None:
        return surface
    with about(density.source):
        return surface.with_density(density.values, density_at=density.at)


def _density_values(mesh: Mesh, wanted: str | None, at: Place | None) -> tuple[NDArray | None, str]:
    if wanted is None:
        return mesh.arrays.get("density"), f"{mesh.path}, array 'density'"
    if wanted.lower().endswith(".npy"):
        return load_npy(Path(wanted)), wanted
    arrays = _named_arrays(mesh)
    if wanted not in arrays:
        known = f"it has {', '.join(arrays)}" if arrays else "it holds none"
        raise click.ClickException(
            f"{mesh.path}: has no density '{wanted}' ({known}); a file's name ends with .npy"
        )
    if at == "faces" and mesh.said and wanted in mesh.said.face_attributes:
        return mesh.said.face_attributes[wanted], f"{mesh.path}, array '{wanted}'"
    return arrays[wanted], f"{mesh.path}, array '{wanted}'"


def _named_arrays(mesh: Mesh) -> Arrays:
    """Arrays of an npz, or properties of a PLY; those of vertices come before those of faces."""
    if mesh.said is None:
        return mesh.arrays
    arrays: Arrays = {}
    if mesh.path.suffix.lower() == ".ply":
        with about(mesh.path):
            arrays |= ply.read(mesh.path)
    return {**mesh.said.face_attributes, **arrays, **mesh.said.vertex_attributes}


def _place_of(mesh: Mesh, values: NDArray, source: str) -> Place:
    vertices, faces = len(mesh.vertices), len(mesh.faces)
    shapes: dict[Place, tuple[int, ...]] = {
        "vertices": (vertices,),
        "faces": (faces,),
        "corners": (faces, 3),
    }
    for place, shape in shapes.items():
        if np.shape(values) == shape:
            return place
    needed = " or ".join(f"{shape} at {place}" for place, shape in shapes.items())
    raise click.ClickException(f"{source}: has the shape {np.shape(values)}: {needed} is needed")
