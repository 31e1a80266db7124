# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF as a file: a tree of JSON, the bytes of its buffers and the arrays in them."""

import base64
import json
import os
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ..reading import WRONG_ENTRY
from ._spaces import rotation_matrices

MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
EMBEDDED = "data:application/octet-stream;base64,"
FLOAT, UNSIGNED_INT = 5126, 5125
COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MOST_ROWS = 1000  # of zeros or of compressed data that are accepted per byte of the file
# Extensions whose buffers have no bytes: decompressing others fills them.
FALLBACKS = {"EXT_meshopt_compression", "KHR_meshopt_compression"}


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

    def add_view(self, values: NDArray, *, target: int | None = None) -> int:
        """The view of an array (n,) or (n, k); rows begin at multiples of 4 bytes if k > 1."""
        self.blob.extend(bytes(-len(self.blob) % 4))
        size = values.nbytes // len(values) if len(values) and values.ndim > 1 else 0
        if size % 4:
            rows = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), size)
            values = np.pad(rows, ((0, 0), (0, -size % 4)))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": values.nbytes}
        view |= {"byteStride": values.shape[1]} if size % 4 else {}
        self.blob.extend(values.tobytes())
        return self.add("bufferViews", view | ({"target": target} if target else {}))

    def add_array(self, values: NDArray, *, target: int | None = None, bounds: bool = False) -> int:
        """The accessor of float32 (n,) or (n, k), or of uint32 (n,)."""
        entry = {
            "bufferView": self.add_view(values, target=target),
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
        if entry["count"] > MOST_ROWS * (len(self.blob) + 1):
            raise ValueError(f"an accessor promises {entry['count']} rows of nothing")

    def _rows(self, entry: dict[str, Any], dtype: np.dtype, width: int, count: int) -> NDArray:
        """The bytes of a view, checked against the length of the buffer."""
        view = self.tree["bufferViews"][entry["bufferView"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        stride = view.get("byteStride") or dtype.itemsize * width
        shape, strides = (count, width), (stride, dtype.itemsize)
        found: NDArray = np.ndarray(shape, dtype, self.blob, start, strides)
        return found


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


def encoded(document: Document, suffix: str) -> bytes:
    """The content of a file that ends with the suffix."""
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


def matrix_of(node: dict[str, Any]) -> NDArray[np.float64]:
    """The transform of a node."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    turn = np.roll(np.array([node.get("rotation", (0, 0, 0, 1))], np.float64), 1, axis=1)
    matrix[:3, :3] = rotation_matrices(turn)[0] * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix
