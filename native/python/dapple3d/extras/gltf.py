# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF files: instances by EXT_mesh_gpu_instancing, for game engines and the web.

>>> from dapple3d import instances
>>> from dapple3d.extras import gltf
>>> gltf.write("points.glb", instances.of_samples(samples))
>>> gltf.read("points.glb").positions

glTF is JSON and a block of bytes, in meters with y up. It holds 32-bit floats and no motion of
instances. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, and the extension beside it.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..instances import Instances, Mesh, Reference, Scatter, Up, of_matrices
from ..writing import replacing
from ._gltf_files import Document, encoded, load, reading
from ._gltf_prototypes import add_mesh, ball, merge
from ._spaces import check_space, matrices_of, single, single_frame, standing, with_z_up

__all__ = ["SUFFIXES", "read", "write", "write_scatters"]

SUFFIXES: Final = (".glb", ".gltf")
"""Suffixes of the files that write() and read() know: binary, and text with the bytes inside."""

EXTENSION = "EXT_mesh_gpu_instancing"
LARGEST_ID = 2**24  # integers up to this are exact as 32-bit floats


# Writing


def write(
    path: str | os.PathLike[str],
    instances: Instances,
    *,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
    prototypes: Sequence[Reference | Mesh] = (),
    name: str = "points",
) -> None:
    """Write instances as nodes with EXT_mesh_gpu_instancing, one for each mesh of a prototype.

    Their attributes are TRANSLATION, ROTATION, SCALE and _ID; ids are floats, so at most
    16,777,216. Velocities, normals and classes that differ from prototypes are not written.

    Args:
        path: ends with one of SUFFIXES.
        instances: of one time.
        up: the axis that points up; it becomes y, as in glTF.
        meters_per_unit: length of a unit of the positions, which become meters.
        prototypes: the prototypes of classes 0, 1, ..., or those that the instances refer to. All
            meshes of the glTF file of a Reference are copied, or those of its node if it names
            one; they are in meters, with y up. Empty: a small ball for each class.
        name: of the parent node.

    Raises:
        ValueError: an argument is wrong; it names the first offender.
        OSError: naming the file.
    """
    scatter = Scatter(name, [instances], prototypes)
    write_scatters(path, [scatter], up=up, meters_per_unit=meters_per_unit)


def write_scatters(
    path: str | os.PathLike[str],
    scatters: Sequence[Scatter],
    *,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
) -> None:
    """Write several scatters into one file, below a node for each; see write().

    Raises:
        ValueError: an argument is wrong, or a scatter has several frames.
        OSError: naming the file.
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target}: a glTF file ends with {', '.join(SUFFIXES)}")
    check_space(up, meters_per_unit)
    document = Document({"asset": {"version": "2.0", "generator": "Dapple"}})
    roots = [_add_scatter(document, one, up, meters_per_unit, target) for one in scatters]
    document.tree |= {"scene": 0, "scenes": [{"nodes": roots}]}
    used = {EXTENSION, *document.tree.get("extensionsUsed", ())}
    document.tree |= {"extensionsUsed": sorted(used), "extensionsRequired": [EXTENSION]}
    with replacing(target) as file:
        file.write(encoded(document, target.suffix.lower()))


def _add_scatter(
    document: Document, scatter: Scatter, up: Up, meters_per_unit: float, target: Path
) -> int:
    """The parent node of the nodes of all prototypes."""
    found = single_frame(scatter, "glTF")
    _check_ids(found)
    moved = standing(found, up, meters_per_unit)
    children = []
    own = None if scatter.prototypes else ball(scatter.radius)
    for k in scatter.used.tolist() if len(found) else ():
        shape = own or scatter.prototypes[k]
        there = _Placed.of(moved, found.placed == k)
        if isinstance(shape, Reference):
            parts = merge(document, shape, target)
        else:
            parts = [(add_mesh(document, shape, up, meters_per_unit), np.eye(4))]
        for part, (mesh, matrix) in enumerate(parts):
            node = {"name": f"{scatter.name}_{k}", "mesh": mesh}
            node["extensions"] = {EXTENSION: {"attributes": there.through(matrix).added(document)}}
            node["extras"] = {"prototype": k, "part": part}
            children.append(document.add("nodes", node))
    node = {"name": scatter.name} | ({"children": children} if children else {})
    return document.add("nodes", node)


@dataclass(frozen=True)
class _Placed:
    """Instances in meters, y up; rotations are w, x, y, z."""

    positions: NDArray
    rotations: NDArray
    scales: NDArray
    ids: NDArray | None

    @staticmethod
    def of(found: Instances, which: NDArray) -> "_Placed":
        count = len(found)
        turns, scales = found.orientations, found.scales
        if turns is None:
            turns = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
        if scales is None:
            scales = np.ones((count, 3))
        ids = None if found.ids is None else found.ids[which]
        return _Placed(found.positions[which], turns[which], scales[which], ids)

    def through(self, matrix: NDArray) -> "_Placed":
        """Instances of a mesh that has a matrix of its own in the prototype."""
        if np.array_equal(matrix, np.eye(4)):
            return self
        here = matrices_of(self.positions, self.rotations, self.scales)
        found, skewed = of_matrices(here @ matrix)
        if skewed.any():
            raise ValueError(
                f"scales[{int(skewed.argmax())}] differs along the axes, and the prototype has "
                "turned parts: glTF cannot hold that"
            )
        assert found.orientations is not None
        assert found.scales is not None
        return _Placed(found.positions, found.orientations, found.scales, self.ids)

    def added(self, document: Document) -> dict[str, int]:
        """Accessors of the attributes."""
        arrays = {
            "TRANSLATION": self.positions,
            "ROTATION": np.roll(self.rotations, -1, axis=1),
            "SCALE": self.scales,
        }
        if self.ids is not None:
            arrays["_ID"] = self.ids
        return {name: document.add_array(single(name, values)) for name, values in arrays.items()}


def _check_ids(found: Instances) -> None:
    """Raise ValueError, naming the first id that is not exact as a 32-bit float."""
    if found.ids is None:
        return
    wrong = np.flatnonzero((found.ids > LARGEST_ID) | (found.ids < -LARGEST_ID))
    if len(wrong):
        k = wrong[0]
        raise ValueError(f"ids[{k}] is {found.ids[k]}: glTF holds whole numbers up to {LARGEST_ID}")


# Reading


def read(path: str | os.PathLike[str], *, up: Up = "Z") -> Instances:
    """Read all instances of a file, in the order of its nodes; lengths are in meters.

    Args:
        path: ends with one of SUFFIXES.
        up: the axis that points up; the y axis of glTF is rotated to it.

    Raises:
        ValueError: there are none, or the file is broken.
        OSError: naming the file.
    """
    document = load(Path(path))
    with reading(path):
        nodes = [node for node in document.tree.get("nodes", ()) if _is_first(node)]
    if not nodes:
        raise ValueError(f"{path}: has no node with {EXTENSION}")
    with reading(path):
        return _instances(document, nodes, up)


def instance_matrices(document: Document, node: dict[str, Any]) -> NDArray[np.float64]:
    """Matrices (n, 4, 4) of the instances of a node."""
    found = _read_node(document, node, 0)
    return matrices_of(found["positions"], found["orientations"], found["scales"])


def _instances(document: Document, nodes: list[dict[str, Any]], up: Up) -> Instances:
    parts = [_read_node(document, node, k) for k, node in enumerate(nodes)]
    names = set.intersection(*(set(part) for part in parts))
    arrays = {name: np.concatenate([part[name] for part in parts]) for name in names}
    if up == "Z":
        arrays["positions"] = with_z_up(arrays["positions"])
        turns = arrays["orientations"]
        arrays["orientations"] = np.column_stack([turns[:, 0], with_z_up(turns[:, 1:])])
        arrays["scales"] = arrays["scales"][:, [0, 2, 1]]
    return Instances(**arrays)


def _is_first(node: dict[str, Any]) -> bool:
    """Whether a node has instances that are not a further part of a prototype."""
    return EXTENSION in node.get("extensions", {}) and not node.get("extras", {}).get("part")


def _read_node(document: Document, node: dict[str, Any], number: int) -> dict[str, NDArray]:
    attributes = node["extensions"][EXTENSION]["attributes"]
    found = {name: document.array(accessor) for name, accessor in attributes.items()}
    if not found:
        raise ValueError(f"{EXTENSION} of instances {number} has no attributes")
    count = len(next(iter(found.values())))
    turns = found.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
    arrays = {
        "positions": found.get("TRANSLATION", np.zeros((count, 3))),
        "orientations": np.roll(turns, 1, axis=1),
        "scales": found.get("SCALE", np.ones((count, 3))),
        "classes": np.full(count, node.get("extras", {}).get("prototype", number)),
    }
    return arrays | ({"ids": found["_ID"].astype(np.int64)} if "_ID" in found else {})
