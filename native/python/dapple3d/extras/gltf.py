# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF files: instances by EXT_mesh_gpu_instancing, for game engines and the web.

>>> from dapple3d import instances
>>> from dapple3d.extras import gltf
>>> gltf.write("points.glb", instances.of_samples(samples))
>>> gltf.read("points.glb").positions

glTF is JSON and a block of bytes, in meters with y up. It holds 32-bit floats and no motion of
instances. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, and the extension beside it.
"""

import base64
import json
import os
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ..instances import Instances, Mesh, Reference, Scatter, Up, of_matrices
from ..reading import WRONG_ENTRY
from ..writing import replacing

__all__ = ["SUFFIXES", "read", "write", "write_scatters"]

SUFFIXES: Final = (".glb", ".gltf")
"""Suffixes of the files that write() and read() know: binary, and text with the bytes inside."""

EXTENSION = "EXT_mesh_gpu_instancing"
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
EMBEDDED = "data:application/octet-stream;base64,"
FLOAT, UNSIGNED_INT = 5126, 5125
COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MOST_ZEROS = 1000  # rows of zeros that are accepted per byte of the file
LARGEST_ID = 2**24  # integers up to this are exact as 32-bit floats
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
UNKNOWN = {"EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_materials_variants"}
# Extensions whose buffers have no bytes: decompressing others fills them.
FALLBACKS = {"EXT_meshopt_compression", "KHR_meshopt_compression"}
MERGED = ("bufferViews", "accessors", "images", "samplers", "textures", "materials", "meshes")


@dataclass
class Document:
    """A file that is being written or was read."""

    tree: dict[str, Any] = field(default_factory=dict)
    blob: bytearray = field(default_factory=bytearray)
    merged: dict[Path, dict[str, int]] = field(default_factory=dict)  # where files begin in lists
    plain: int | None = None

    def plain_material(self) -> int:
        """The material of meshes that have none: by the rules of glTF they would be metal, which is
        black without surroundings that it reflects.
        """
        if self.plain is None:
            self.plain = self.add("materials", {"pbrMetallicRoughness": {"metallicFactor": 0.0}})
        return self.plain

    def add(self, name: str, entry: Any) -> int:
        """Add an entry to a list and return its index."""
        entries = self.tree.setdefault(name, [])
        entries.append(entry)
        return len(entries) - 1

    def add_array(self, values: NDArray, *, target: int | None = None, bounds: bool = False) -> int:
        """The accessor of float32 (n,) or (n, k), or of uint32 (n,)."""
        self.blob.extend(bytes(-len(self.blob) % 4))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": values.nbytes}
        self.blob.extend(values.tobytes())
        entry = {
            "bufferView": self.add("bufferViews", view | ({"target": target} if target else {})),
            "componentType": FLOAT if values.dtype.kind == "f" else UNSIGNED_INT,
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
        }
        if bounds:
            entry |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self.add("accessors", entry)

    def array(self, number: int) -> NDArray:
        """The values of an accessor."""
        entry = self.tree["accessors"][number]
        dtype, width = np.dtype(COMPONENTS[entry["componentType"]]), WIDTHS[entry["type"]]
        if "bufferView" in entry:
            values = self._rows(entry, dtype, width, entry["count"])
        else:
            self._check_sparse(entry)
            values = np.zeros((entry["count"], width), dtype)
        if "sparse" in entry:
            values = values.copy()
            sparse, indices = entry["sparse"], entry["sparse"]["indices"]
            kind = np.dtype(COMPONENTS[indices["componentType"]])
            places = self._rows(indices, kind, 1, sparse["count"])[:, 0]
            values[places] = self._rows(sparse["values"], dtype, width, sparse["count"])
        values = values.astype(np.float64)
        if entry.get("normalized"):
            values = np.maximum(values / np.iinfo(dtype).max, -1.0)
        return values[:, 0] if width == 1 else values

    def _check_sparse(self, entry: dict[str, Any]) -> None:
        """Refuse accessors without a view that are larger than the file justifies."""
        if entry["count"] > MOST_ZEROS * (len(self.blob) + 1):
            raise ValueError(f"an accessor promises {entry['count']} rows of nothing")

    def _rows(self, entry: dict[str, Any], dtype: np.dtype, width: int, count: int) -> NDArray:
        """The bytes of a view, checked against the length of the buffer."""
        view = self.tree["bufferViews"][entry["bufferView"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        stride = view.get("byteStride") or dtype.itemsize * width
        shape, strides = (count, width), (stride, dtype.itemsize)
        found: NDArray = np.ndarray(shape, dtype, self.blob, start, strides)
        return found


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
        file.write(_encoded(document, target.suffix.lower()))


def single_frame(scatter: Scatter, format_name: str) -> Instances:
    """The only frame; ValueError if there are several."""
    if len(scatter.frames) != 1:
        raise ValueError(
            f"{scatter.name} has {len(scatter.frames)} frames: {format_name} holds one"
        )
    return scatter.frames[0]


def check_space(up: str, meters_per_unit: float) -> None:
    """Raise ValueError unless the space of points is described."""
    if up not in ("Y", "Z"):
        raise ValueError(f"up is {up!r}: Y or Z is needed")
    if not (np.isfinite(meters_per_unit) and meters_per_unit > 0):
        raise ValueError(f"meters_per_unit is {meters_per_unit}: a number > 0 is needed")


def _encoded(document: Document, suffix: str) -> bytes:
    document.blob.extend(bytes(-len(document.blob) % 4))
    buffer: dict[str, Any] = {"byteLength": len(document.blob)}
    if suffix == ".gltf":
        buffer["uri"] = EMBEDDED + base64.b64encode(document.blob).decode()
    text = json.dumps(document.tree | {"buffers": [buffer]}, separators=(",", ":")).encode()
    if suffix == ".gltf":
        return text
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
    chunks += struct.pack("<II", len(document.blob), BINARY_CHUNK) + document.blob
    return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks


def _add_scatter(
    document: Document, scatter: Scatter, up: Up, meters_per_unit: float, target: Path
) -> int:
    """The parent node of the nodes of all prototypes."""
    found = single_frame(scatter, "glTF")
    _check_ids(found)
    moved = standing(found, up, meters_per_unit)
    children = []
    ball = None if scatter.prototypes else _ball(scatter.radius)
    for k in scatter.used.tolist() if len(found) else ():
        shape = ball or scatter.prototypes[k]
        there = _Placed.of(moved, found.placed == k)
        if isinstance(shape, Reference):
            parts = _merge(document, shape, target)
        else:
            parts = [(_add_mesh(document, shape, up, meters_per_unit), np.eye(4))]
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


def single(name: str, values: NDArray) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):
        found = np.ascontiguousarray(values, "<f4")
    wrong = ~np.isfinite(found).all(axis=tuple(range(1, found.ndim)))
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(f"{name}[{k}] is no 32-bit float: {values[k].tolist()}")
    return found


def standing(found: Instances, up: Up, factor: float) -> Instances:
    """In meters, y up."""
    positions, turns, scales = found.positions * factor, found.orientations, found.scales
    for name, values in (("positions", positions), ("scales", scales)):
        if values is not None:
            single(name, values)
    if up == "Z":
        positions = with_y_up(positions)
        if turns is not None:
            turns = np.column_stack([turns[:, 0], with_y_up(turns[:, 1:])])
        if scales is not None:
            scales = scales[:, [0, 2, 1]]
    return Instances(positions, turns, scales, ids=found.ids)


def with_y_up(vectors: NDArray) -> NDArray:
    return vectors[:, [0, 2, 1]] * [1.0, 1.0, -1.0]


def with_z_up(vectors: NDArray) -> NDArray:
    return vectors[:, [0, 2, 1]] * [1.0, -1.0, 1.0]


def matrices_of(
    positions: NDArray, turns: NDArray | None, scales: NDArray | None
) -> NDArray[np.float64]:
    """Matrices (n, 4, 4) of column vectors, of what is scaled, then turned, then moved."""
    found = np.tile(np.eye(4), (len(positions), 1, 1))
    if turns is not None:
        found[:, :3, :3] = rotation_matrices(turns)
    if scales is not None:
        found[:, :3, :3] *= scales[:, None, :]
    found[:, :3, 3] = positions
    return found


def rotation_matrices(turns: NDArray) -> NDArray:
    """Rotation matrices (n, 3, 3) of quaternions: v + 2 w (u x v) + 2 u x (u x v)."""
    cross = np.zeros((len(turns), 3, 3))
    x, y, z = turns[:, 1:].T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= np.swapaxes(cross, 1, 2)
    return np.eye(3) + 2.0 * turns[:, :1, None] * cross + 2.0 * cross @ cross


def _add_mesh(document: Document, mesh: Mesh, up: Up, factor: float) -> int:
    vertices = mesh.vertices * factor
    if up == "Z":
        vertices = with_y_up(vertices)
    faces = np.ascontiguousarray(mesh.faces, "<u4").ravel()
    places = document.add_array(single("vertices", vertices), target=34962, bounds=True)
    corners = document.add_array(faces, target=34963)
    material = document.plain_material()
    primitive = {"attributes": {"POSITION": places}, "indices": corners, "material": material}
    return document.add("meshes", {"primitives": [primitive]})


def _ball(radius: float) -> Mesh:
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


# Prototypes from other files


def _merge(
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


def matrix_of(node: dict[str, Any]) -> NDArray[np.float64]:
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    turn = np.roll(np.array([node.get("rotation", (0, 0, 0, 1))], np.float64), 1, axis=1)
    matrix[:3, :3] = rotation_matrices(turn)[0] * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


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


@contextmanager
def reading(path: str | os.PathLike[str]) -> Iterator[None]:
    """Report any exception caused by a broken file as ValueError."""
    try:
        yield
    except (ValueError, struct.error) as error:
        raise ValueError(f"{os.fspath(path)}: could not be read as glTF: {error}") from error
    except WRONG_ENTRY as error:
        raise ValueError(
            f"{os.fspath(path)}: could not be read as glTF: an entry is missing or wrong: {error}"
        ) from error


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


def load(path: Path) -> Document:
    """A file with the bytes of all its buffers.

    Raises:
        ValueError: naming the file and what is wrong with it.
        OSError: naming the file.
    """
    content = path.read_bytes()
    with reading(path):
        binary = content[:4] == b"glTF"
        outdated = binary and struct.unpack_from("<I", content, 4)[0] == 1
        if not outdated:
            tree, blob = _chunks(content) if binary else (json.loads(content), b"")
            outdated = str(tree.get("asset", {}).get("version", "")).startswith("1.")
        if not outdated:
            return Document(tree, _gathered(tree, blob, path))
    raise ValueError(f"{path}: is of glTF 1.0, which is not read: save it as glTF 2.0")


def _gathered(tree: dict[str, Any], blob: bytes, path: Path) -> bytearray:
    """All buffers joined; offsets of views are changed to match."""
    buffers, bytes_of_all, starts = tree.get("buffers", ()), bytearray(), list[int]()
    for k, buffer in enumerate(buffers):
        bytes_of_all.extend(bytes(-len(bytes_of_all) % 8))
        starts.append(len(bytes_of_all))
        if "uri" in buffer:
            bytes_of_all.extend(_bytes_of(buffer["uri"], path))
        elif k == 0:
            bytes_of_all.extend(blob)
        elif not FALLBACKS.intersection(buffer.get("extensions", ())):
            raise ValueError(f"buffer {k} is nowhere")
    if len(buffers) > 1:
        for view in tree.get("bufferViews", ()):
            view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
            view["buffer"] = 0
    return bytes_of_all


def _chunks(content: bytes) -> tuple[dict[str, Any], bytes]:
    found, at = {}, 12
    while at < len(content):
        length, kind = struct.unpack_from("<II", content, at)
        found[kind] = content[at + 8 : at + 8 + length]
        at += 8 + length
    return json.loads(found[JSON_CHUNK]), found.get(BINARY_CHUNK, b"")


def _bytes_of(uri: str, path: Path) -> bytes:
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    place = Path(os.path.normpath(path.parent / unquote(uri)))
    if not place.is_relative_to(os.path.normpath(path.parent)) or not place.is_file():
        raise ValueError(f"its buffer {uri!r} is no file in its folder")
    return place.read_bytes()
