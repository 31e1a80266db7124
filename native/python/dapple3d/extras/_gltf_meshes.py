# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of glTF files: the meshes of all nodes of the scene as one."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _gltf_draco as draco
from . import gltf
from ._gltf_files import Document, load, matrix_of, reading
from ._spaces import with_z_up
from .gltf import SUFFIXES

__all__ = ["SUFFIXES", "read_arrays"]

Floats = NDArray[np.float64]
POINTS, TRIANGLES, STRIP, FAN = 0, 4, 5, 6
DEPTH = 1000  # largest depth of nested nodes
WIDTHS = {"uv": 2, "normals": 3, "colors": 4}
MISSING = {"uv": 0.0, "normals": 0.0, "colors": 1.0}
COMPRESSED = {
    "EXT_meshopt_compression": "meshoptimizer",
    "KHR_meshopt_compression": "meshoptimizer",
}


def read_arrays(path: str | os.PathLike[str], *, may_be_empty: bool) -> dict[str, Any]:
    """The arrays of MeshArrays by name, in meters, z up.

    Raises:
        ValueError: naming the file and what is wrong with it.
        OSError: naming the file.
    """
    document = load(Path(path))
    with reading(path):
        needed = _needed(document)
        refused = [name for name in COMPRESSED if name in needed]
    if refused:
        raise ValueError(
            f"{os.fspath(path)}: its meshes are compressed by {COMPRESSED[refused[0]]} "
            f"({refused[0]}), which is not read: export it without compression"
        )
    if draco.EXTENSION in needed:
        draco.check_installed(path)
    with reading(path):
        parts = list(_parts(document))
    found = _joined(parts) if parts else _nothing()
    if len(found["faces"]) == 0 and not may_be_empty:
        raise ValueError(f"{os.fspath(path)}: holds no faces")
    return found


def _nothing() -> dict[str, Any]:
    return {"vertices": np.empty((0, 3)), "faces": np.empty((0, 3), np.int32)}


def _needed(document: Document) -> set[str]:
    """Extensions that the file or its primitives require."""
    found = set(document.tree.get("extensionsRequired", ()))
    for mesh in document.tree.get("meshes", ()):
        for primitive in mesh["primitives"]:
            if "POSITION" in primitive["attributes"]:
                view = document.tree["accessors"][primitive["attributes"]["POSITION"]]
                if "bufferView" in view or "sparse" in view:
                    continue
            found |= set(primitive.get("extensions", ()))
    return found


def _parts(document: Document) -> Iterator[dict[str, NDArray]]:
    """Each primitive of each mesh with its matrix."""
    worlds = _worlds(document)
    for number, world in worlds.items():
        node = document.tree["nodes"][number]
        if "mesh" not in node:
            continue
        mesh = document.tree["meshes"][node["mesh"]]
        for primitive in mesh["primitives"]:
            weights = node.get("weights", mesh.get("weights", ()))
            part = _primitive(document, primitive, weights)
            if part is None:
                continue
            if "skin" in node:
                matrices = _skinned(document, node["skin"], primitive, worlds)
                yield _placed(part, matrices)
                continue
            for matrix in _instances(document, node, world):
                yield _placed(part, matrix)


def _worlds(document: Document) -> dict[int, Floats]:
    """Where nodes of the scene are, in the order of the scene."""
    tree, found = document.tree, dict[int, Floats]()
    nodes = tree.get("nodes", [])
    scenes = tree.get("scenes")
    children = {child for node in nodes for child in node.get("children", ())}
    roots = scenes[tree.get("scene", 0)].get("nodes", ()) if scenes else range(len(nodes))
    if not scenes:
        roots = [k for k in roots if k not in children]
    pending = [(k, np.eye(4), 0) for k in reversed(list(roots))]
    while pending:
        number, above, depth = pending.pop()
        if depth > DEPTH or number in found:
            raise ValueError(f"node {number} is below itself, or below two others")
        found[number] = world = above @ matrix_of(nodes[number])
        below = nodes[number].get("children", ())
        pending += [(child, world, depth + 1) for child in reversed(below)]
    return found


def _instances(document: Document, node: dict[str, Any], world: Floats) -> list[Floats]:
    """Matrix of the node, or those of its instances."""
    if gltf.EXTENSION not in node.get("extensions", {}):
        return [world]
    return [world @ matrix for matrix in gltf.instance_matrices(document, node)]


def _primitive(
    document: Document, primitive: dict[str, Any], weights: Any
) -> dict[str, NDArray] | None:
    """Vertices, faces and attributes of the vertices; None for points and lines."""
    mode, attributes = primitive.get("mode", TRIANGLES), primitive["attributes"]
    if mode < TRIANGLES or "POSITION" not in attributes:
        return None
    if draco.is_compressed(document, primitive):
        draco.decompress(document, primitive)
        mode = primitive["mode"]
    vertices = _rows(document, attributes["POSITION"], 3)
    for weight, target in zip(weights, primitive.get("targets", ()), strict=False):
        if weight and "POSITION" in target:
            vertices = vertices + float(weight) * _rows(document, target["POSITION"], 3)
    part: dict[str, NDArray] = {"vertices": vertices, "faces": _indexed(document, primitive, mode)}
    wrong = (part["faces"] < 0) | (part["faces"] >= len(vertices))
    if wrong.any():
        raise ValueError(f"an index is {part['faces'][wrong][0]}: there are {len(vertices)}")
    part |= _at_vertices(document, attributes)
    for name in WIDTHS:
        if name in part and len(part[name]) != len(vertices):
            raise ValueError(f"there are {len(part[name])} {name} for {len(vertices)} vertices")
    return part


def _indexed(document: Document, primitive: dict[str, Any], mode: int) -> NDArray[np.int64]:
    """Faces of the indices, or of the vertices in their order."""
    if "indices" in primitive:
        indices = document.array(primitive["indices"]).astype(np.int64)
    else:
        count = document.tree["accessors"][primitive["attributes"]["POSITION"]]["count"]
        indices = np.arange(count)
    if indices.ndim != 1:
        raise ValueError("indices are no single numbers")
    return _faces(indices, mode)


def _at_vertices(document: Document, attributes: dict[str, int]) -> dict[str, NDArray]:
    part: dict[str, NDArray] = {}
    if "TEXCOORD_0" in attributes:
        part["uv"] = _rows(document, attributes["TEXCOORD_0"], 2) * [1.0, -1.0] + [0.0, 1.0]
    if "NORMAL" in attributes:
        part["normals"] = _rows(document, attributes["NORMAL"], 3)
    if "COLOR_0" in attributes:
        colors = document.array(attributes["COLOR_0"])
        opacity = np.ones((len(colors), 4 - colors.shape[1]))
        part["colors"] = np.clip(np.column_stack([colors, opacity]), 0.0, 1.0)
    return part


def _rows(document: Document, accessor: int, width: int) -> Floats:
    values = document.array(accessor)
    if values.ndim != 2 or values.shape[1] != width:
        raise ValueError(f"accessor {accessor} has not {width} numbers a row")
    return values


def _faces(indices: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Triangles of a list, a strip (every second one turned) or a fan."""
    if mode == TRIANGLES:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3)
    if len(indices) < 3:
        return np.empty((0, 3), np.int64)
    if mode == FAN:
        first = np.full(len(indices) - 2, indices[0])
        return np.column_stack([first, indices[1:-1], indices[2:]])
    if mode != STRIP:
        raise ValueError(f"mode is {mode}: 0 to 6 are known")
    faces = np.column_stack([indices[:-2], indices[1:-1], indices[2:]])
    faces[1::2] = faces[1::2][:, [1, 0, 2]]
    return faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]


def _skinned(
    document: Document, number: int, primitive: dict[str, Any], worlds: dict[int, Floats]
) -> Floats:
    """(v, 4, 4): the weighted mean of the joint matrices of each vertex."""
    skin = document.tree["skins"][number]
    joints = np.array([worlds.get(k, np.eye(4)) for k in skin["joints"]])
    if "inverseBindMatrices" in skin:
        inverse = document.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4)
        joints = joints @ inverse[: len(joints)].swapaxes(1, 2)
    which, weights = _bound(document, primitive["attributes"])
    total: Any = 0.0
    for joint, weight in zip(which.T, weights.T, strict=True):
        total = total + weight[:, None, None] * joints[joint]
    matrices: Floats = total / weights.sum(axis=1)[:, None, None]
    return matrices


def _bound(document: Document, attributes: dict[str, int]) -> tuple[NDArray[np.int64], Floats]:
    """Joints of the vertices and their weights; those without weights follow their first joint, as
    in Blender and three.js.
    """
    which, weights = list[NDArray](), list[NDArray]()
    for k in range(len(attributes)):
        if f"JOINTS_{k}" not in attributes or f"WEIGHTS_{k}" not in attributes:
            break
        which.append(_rows(document, attributes[f"JOINTS_{k}"], 4))
        weights.append(_rows(document, attributes[f"WEIGHTS_{k}"], 4))
    if not which:
        raise ValueError("a skinned mesh has no JOINTS_0 and WEIGHTS_0")
    found = np.concatenate(weights, axis=1)
    found[np.isnan(found)] = 0.0
    found[found.sum(axis=1) <= 0.0] = np.eye(1, found.shape[1])
    return np.concatenate(which, axis=1).astype(np.int64), found


def _placed(part: dict[str, NDArray], matrices: Floats) -> dict[str, NDArray]:
    """Transformed by one matrix or one per vertex; mirroring reverses the faces."""
    linear, shift = matrices[..., :3, :3], matrices[..., :3, 3]
    placed = dict(part)
    placed["vertices"] = (linear @ part["vertices"][:, :, None])[..., 0] + shift
    if "normals" in part:
        turns = _cofactors(linear)
        placed["normals"] = (turns @ part["normals"][:, :, None])[..., 0]
    if matrices.ndim == 2 and np.linalg.det(linear) < 0.0:
        placed["faces"] = part["faces"][:, ::-1]
        if "normals" in placed:
            placed["normals"] = -placed["normals"]
    return placed


def _cofactors(linear: Floats) -> Floats:
    """The matrix of normals for a matrix of vectors, which may be singular."""
    x, y, z = (linear[..., :, k] for k in range(3))
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)


def _joined(parts: list[dict[str, NDArray]]) -> dict[str, Any]:
    """All parts joined, z up; attributes of vertices are at the corners."""
    starts = np.cumsum([0, *(len(part["vertices"]) for part in parts)])
    vertices = np.concatenate([part["vertices"] for part in parts])
    faces = np.concatenate([part["faces"] + k for part, k in zip(parts, starts, strict=False)])
    if len(vertices) > np.iinfo(np.int32).max:
        raise ValueError(f"holds {len(vertices)} vertices: numbers of 32 bits are needed")
    found: dict[str, Any] = {
        "vertices": with_z_up(vertices),
        "faces": faces.astype(np.int32),
        "polygons": np.arange(len(faces), dtype=np.int32),
    }
    for name, width in WIDTHS.items():
        if any(name in part for part in parts):
            rows = np.concatenate([_or_missing(part, name, width) for part in parts])
            rows = with_z_up(rows) if name == "normals" else rows
            found[name] = rows[faces].astype(np.float32 if name == "colors" else np.float64)
    return found


def _or_missing(part: dict[str, NDArray], name: str, width: int) -> NDArray:
    return part.get(name, np.full((len(part["vertices"]), width), MISSING[name]))
