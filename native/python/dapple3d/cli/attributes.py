# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of a mesh, interpolated at points on it."""

from dataclasses import replace

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli.files import Arrays
from dapple3d.cli.meshes import Mesh
from dapple3d.cli.points import NAMES, Points, check_carried


def with_attributes(mesh: Mesh, samples: dapple.Samples, points: Points) -> Points:
    """The points with texture coordinates, colors, polygons and other numbers of the mesh.

    Raises:
        ClickException: the mesh has none.
    """
    found = _of_npz(mesh, samples) if mesh.said is None else _of_file(mesh.said, samples)
    if not found:
        raise click.ClickException(
            f"{mesh.path}: has no texture coordinates, colors, polygons or other attributes"
        )
    fields = {name: found.pop(name) for name in ("uv", "colors", "polygons") if name in found}
    return replace(points, **fields, attributes=found)


def _of_file(said: dapple.MeshArrays, samples: dapple.Samples) -> Arrays:
    found: Arrays = {}
    for name in ("uv", "colors"):
        values = getattr(said, name)
        if values is not None:
            found[name] = _at_corners(values, samples)
    if said.polygons is not None:
        found["polygons"] = said.polygons[samples.faces]
    for name, values in said.face_attributes.items():
        found[name] = values[samples.faces]
    for name, values in said.vertex_attributes.items():
        found[name] = _at_corners(values[said.faces], samples)
    return _free(found)


def _of_npz(mesh: Mesh, samples: dapple.Samples) -> Arrays:
    """Arrays matched by their shapes, vertices first; arrays that do not fit are skipped."""
    vertices, faces = len(mesh.vertices), len(mesh.faces)
    found: Arrays = {}
    for name, values in mesh.arrays.items():
        if values.dtype.kind not in "fiub" or name == "normals" or values.ndim == 0:
            continue
        if len(values) == vertices and values.ndim < 3 and name != "polygons":
            found[name] = _at_corners(values.astype(np.float64)[mesh.faces], samples)
        elif values.shape[:2] == (faces, 3):
            found[name] = _at_corners(values.astype(np.float64), samples)
        elif values.shape == (faces,):
            found[name] = values[samples.faces]
    for name, values in found.items():
        check_carried(str(mesh.path), name, values)
    return _free(found)


def _at_corners(values: NDArray, samples: dapple.Samples) -> NDArray[np.float64]:
    """Values (m, 3) or (m, 3, k) of the corners, interpolated at the points."""
    there: NDArray[np.float64] = np.einsum(
        "nc,nc...->n...", samples.barycentric, values[samples.faces].astype(np.float64)
    )
    return there


def _free(found: Arrays) -> Arrays:
    """The arrays without those whose names have another meaning for points."""
    return {name: values for name, values in found.items() if name not in NAMES}
