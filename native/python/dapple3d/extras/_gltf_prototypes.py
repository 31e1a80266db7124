# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that instances in a glTF file show: copied from other files, or made of arrays."""

import os
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ..instances import Mesh, Reference, Up
from . import _gltf_draco as draco
from ._gltf_files import Document, load, matrix_of, reading
from ._spaces import single, with_y_up

# Keys whose integers are indices into a list of the file.
COUNTING = {
    "bufferView": "bufferViews",
    "index": "textures",
    "indices": "accessors",
    "material": "materials",
    "sampler": "samplers",
    "source": "images",
}
# Extensions whose integers have another meaning.
UNKNOWN = {"EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_materials_variants"}
MERGED = ("bufferViews", "accessors", "images", "samplers", "textures", "materials", "meshes")


def add_mesh(document: Document, mesh: Mesh, up: Up, factor: float) -> int:
    """Add a mesh in meters, y up, and return its index."""
    vertices = mesh.vertices * factor
    if up == "Z":
        vertices = with_y_up(vertices)
    faces = np.ascontiguousarray(mesh.faces, "<u4").ravel()
    places = document.add_array(single("vertices", vertices), target=34962, bounds=True)
    corners = document.add_array(faces, target=34963)
    material = document.plain_material()
    primitive = {"attributes": {"POSITION": places}, "indices": corners, "material": material}
    return document.add("meshes", {"primitives": [primitive]})


def ball(radius: float) -> Mesh:
    """An octahedron, subdivided twice."""
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)])
    corners = np.eye(3) * signs[:, :, None]
    turned = signs.prod(axis=1) < 0
    corners[turned] = corners[turned][:, ::-1]
    for _ in range(2):
        a, b, c = corners.swapaxes(0, 1)
        ab, bc, ca = a + b, b + c, c + a
        parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
        corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    vertices, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Mesh(radius * vertices, faces.reshape(-1, 3).astype(np.int32))


def merge(
    document: Document, reference: Reference, target: Path
) -> list[tuple[int, NDArray[np.float64]]]:
    """Copy meshes with their dependencies; their indices and matrices below the node."""
    other = load(Path(reference.path))
    with reading(reference.path):
        used = list(other.tree.get("extensionsUsed", ()))
        if not all(isinstance(name, str) for name in used):
            raise ValueError(f"extensionsUsed is {used}: names are needed")
        refused = UNKNOWN.intersection(used)
    if refused:
        raise ValueError(f"{reference.path}: uses {min(refused)}, which cannot be taken over")
    if draco.EXTENSION in used:
        draco.check_installed(reference.path)
        with reading(reference.path):
            _decompress(other)
    starts = _starts(other, reference)
    with reading(reference.path):
        found = _meshes_below(other, starts)
    if not found:
        raise ValueError(f"{reference.path}: has no mesh")
    with reading(reference.path):
        for number in {mesh for mesh, _ in found}:
            _check_indices(other, number)
    key = Path(reference.path).resolve()
    if key not in document.merged:
        document.merged[key] = {name: len(document.tree.get(name, ())) for name in MERGED}
        with reading(reference.path):
            _take_over(document, other, key, target)
    first = document.merged[key]["meshes"]
    return [(mesh + first, matrix) for mesh, matrix in found]


def _decompress(document: Document) -> None:
    """Leave plain meshes only."""
    for mesh in document.tree.get("meshes", ()):
        for primitive in mesh["primitives"]:
            if draco.is_compressed(document, primitive):
                draco.decompress(document, primitive)
            primitive.get("extensions", {}).pop(draco.EXTENSION, None)
    document.tree["extensionsUsed"].remove(draco.EXTENSION)


def _check_indices(document: Document, number: int) -> None:
    """Raise ValueError if a primitive of a mesh has an index without a vertex."""
    for primitive in document.tree["meshes"][number]["primitives"]:
        if "indices" not in primitive or "POSITION" not in primitive["attributes"]:
            continue
        vertices = len(document.array(primitive["attributes"]["POSITION"]))
        indices = document.array(primitive["indices"])
        wrong = np.flatnonzero(indices >= vertices)
        if len(wrong):
            k = wrong[0]
            raise ValueError(
                f"index {k} of mesh {number} is {indices[k]:g}: there are {vertices} vertices"
            )


def _take_over(document: Document, other: Document, source: Path, target: Path) -> None:
    """Copy all lists of the other file that meshes refer to, and its bytes."""
    offsets = document.merged[source]
    document.blob.extend(bytes(-len(document.blob) % 4))
    start = len(document.blob)
    document.blob.extend(other.blob)
    for name in MERGED:
        for entry in other.tree.get(name, ()):
            moved = _renumbered(entry, offsets)
            if name == "bufferViews":
                moved |= {"buffer": 0, "byteOffset": moved.get("byteOffset", 0) + start}
            if name == "images" and "uri" in moved:
                moved["uri"] = _relative(moved["uri"], source, target)
            document.add(name, moved)
    used = document.tree.setdefault("extensionsUsed", [])
    used += [one for one in other.tree.get("extensionsUsed", ()) if one not in used]


def _renumbered(value: Any, offsets: dict[str, int], key: str = "") -> Any:
    """The entry with its indices shifted behind the entries that exist."""
    if key == "extras":
        return value
    if isinstance(value, list):
        return [_renumbered(one, offsets, key) for one in value]
    if isinstance(value, dict):
        inner = {name: "indices" if key in ("attributes", "targets") else name for name in value}
        return {name: _renumbered(one, offsets, inner[name]) for name, one in value.items()}
    counted = COUNTING.get(key)
    return value + offsets[counted] if counted and isinstance(value, int) else value


def _relative(uri: str, source: Path, target: Path) -> str:
    if uri.startswith("data:"):
        return uri
    place = source.resolve().parent / unquote(uri)
    return Path(os.path.relpath(place, target.resolve().parent)).as_posix()


def _starts(other: Document, reference: Reference) -> list[int]:
    """The named node, or all nodes of the scene."""
    with reading(reference.path):
        if not reference.prim:
            scene = other.tree.get("scenes", [{}])[other.tree.get("scene", 0)]
            return list(scene.get("nodes", ()))
        nodes = other.tree.get("nodes", [])
        named = [k for k, node in enumerate(nodes) if node.get("name") == reference.prim]
    if not named:
        raise ValueError(f"{reference.path}: has no node '{reference.prim}'")
    return named[:1]


def _meshes_below(
    other: Document, starts: list[int], above: NDArray | None = None
) -> list[tuple[int, NDArray[np.float64]]]:
    """Meshes and their matrices."""
    found = []
    for number in starts:
        node = other.tree["nodes"][number]
        matrix = matrix_of(node) if above is None else above @ matrix_of(node)
        if "mesh" in node:
            found.append((int(node["mesh"]), matrix))
        found += _meshes_below(other, node.get("children", []), matrix)
    return found
