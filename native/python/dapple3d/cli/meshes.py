# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces from files: PLY, OBJ, STL, OFF, and npz with densities."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli import ply
from dapple3d.cli.files import Arrays, about, load_npy, load_npz

Place = Literal["vertices", "faces", "corners"]


@dataclass(frozen=True)
class Mesh:
    """What a file holds, unchecked: Surface does that.

    vertices: (v, 3) float64, or (frames, v, 3) in an npz of a motion.
    faces: (m, 3) int32.
    arrays: the others of an npz, by name.
    """

    path: Path
    vertices: NDArray
    faces: NDArray
    arrays: Arrays = field(default_factory=dict)


@dataclass(frozen=True)
class Density:
    """Values where they are; none is 1 everywhere."""

    values: NDArray | None = None
    at: Place = "vertices"
    source: str = ""


def read_mesh(path: Path) -> Mesh:
    """Read a mesh, by the extension of its file.

    Raises:
        FileError, ClickException: naming the file and what is wrong with it.
    """
    if path.suffix.lower() != ".npz":
        return Mesh(path, *dapple.read_mesh(path))
    arrays = load_npz(path)
    for name in ("vertices", "faces"):
        if name not in arrays:
            raise click.ClickException(
                f"{path}: has no array '{name}', only {', '.join(arrays) or 'none'}"
            )
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
    values, source = _density_values(mesh, wanted)
    if values is None:
        return Density()
    return Density(values, at or _place_of(mesh, values, source), source)


@dataclass(frozen=True)
class Loaded:
    """The checked surface of a mesh with its density."""

    mesh: Mesh
    surface: dapple.Surface
    density: Density

    def doubled(self) -> str:
        """The end of a line about the surface: how many faces do not count."""
        doubled = self.surface.doubled_faces
        if not doubled:
            return ""
        return (
            "; 1 doubled face counts once"
            if doubled == 1
            else f"; {doubled} doubled faces count once"
        )

    def describe(self) -> dict[str, Any]:
        """What a report says about its input."""
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
    *,
    weld: bool = True,
    merge_doubled: bool = True,
) -> Loaded:
    """Check a mesh, and give it the density that an option names.

    Args:
        mesh: from read_mesh().
        density, at: as for read_density().
        weld: whether border edges at the same place are connected.
        merge_doubled: whether faces that lie on each other count as one.

    Raises:
        ClickException: naming the file, the rule and the first offender.
    """
    with about(mesh.path):
        unwelded: dict[str, Any] = {} if weld else {"weld": None}
        surface = dapple.Surface(mesh.vertices, mesh.faces, merge_doubled=merge_doubled, **unwelded)
    found = read_density(mesh, density, at)
    return Loaded(mesh, with_density(surface, found), found)


def with_density(surface: dapple.Surface, density: Density) -> dapple.Surface:
    """The surface with the density, if there is one; errors name where it comes from."""
    if density.values is None:
        return surface
    with about(density.source):
        return surface.with_density(density.values, density_at=density.at)


def _density_values(mesh: Mesh, wanted: str | None) -> tuple[NDArray | None, str]:
    if wanted is None:
        return mesh.arrays.get("density"), f"{mesh.path}, array 'density'"
    if wanted.lower().endswith(".npy"):
        return load_npy(Path(wanted)), wanted
    arrays = mesh.arrays
    if mesh.path.suffix.lower() == ".ply":
        with about(mesh.path):
            arrays = ply.read(mesh.path)
    if wanted not in arrays:
        known = f"it has {', '.join(arrays)}" if arrays else "it holds none"
        raise click.ClickException(
            f"{mesh.path}: has no density '{wanted}' ({known}); a file's name ends with .npy"
        )
    return arrays[wanted], f"{mesh.path}, array '{wanted}'"


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
