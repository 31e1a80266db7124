# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF meshes that are compressed by Draco (KHR_draco_mesh_compression); needs DracoPy.

Draco allocates whatever the head of its data promises, so that is compared with the accessors and
the size of the data first. https://google.github.io/draco/spec/
"""

import importlib
import os
from io import BytesIO
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._gltf_files import COMPONENTS, MOST_ROWS, UNSIGNED_INT, WIDTHS, Document

EXTENSION = "KHR_draco_mesh_compression"
VERSION = (2, 2)  # of the data; the extension allows no other
MESH, SEQUENTIAL, HAS_METADATA = 1, 0, 0x8000
TRIANGLES, STRIP = 4, 5


def check_installed(path: str | os.PathLike[str]) -> None:
    """Raise ValueError, naming the file, if DracoPy is missing."""
    try:
        _draco()
    except ModuleNotFoundError as error:
        raise ValueError(
            f"{os.fspath(path)}: its meshes are compressed by Draco ({EXTENSION}), and reading "
            'them needs DracoPy, which is missing: pip install "dapple3d[draco]"'
        ) from error


def is_compressed(document: Document, primitive: dict[str, Any]) -> bool:
    """Whether a primitive can only be read by Draco: others have their plain arrays beside it."""
    if EXTENSION not in primitive.get("extensions", {}):
        return False
    position = document.tree["accessors"][primitive["attributes"]["POSITION"]]
    required = EXTENSION in document.tree.get("extensionsRequired", ())
    return required or not ("bufferView" in position or "sparse" in position)


def decompress(document: Document, primitive: dict[str, Any]) -> None:
    """Give a primitive that is_compressed() plain triangles and attributes.

    Raises:
        ValueError: the data is broken, or is not what the accessors promise.
    """
    extension = primitive["extensions"].pop(EXTENSION)
    accessors, attributes = document.tree["accessors"], primitive["attributes"]
    block = _block(document, extension["bufferView"])
    count = accessors[attributes["POSITION"]]["count"]
    _check_promises(block, document, primitive)
    found = _decoded(block)
    faces = getattr(found, "faces", np.empty((0, 3), np.uint32))
    for name, number in extension["attributes"].items():
        if name not in attributes:
            continue
        attribute = found.get_attribute_by_unique_id(number)
        if attribute is None:
            raise ValueError(f"its Draco data has no attribute {number}, which is {name}")
        entry = dict(accessors[attributes[name]])
        if len(attribute["data"]) != count or entry["count"] != count:
            raise ValueError(
                f"its Draco data has {len(attribute['data'])} {name}, its accessors {count} and "
                f"{entry['count']}"
            )
        attributes[name] = _add(document, entry, attribute["data"], name)
    entry = {"componentType": UNSIGNED_INT, "type": "SCALAR", "count": faces.size}
    primitive["indices"] = _add(document, entry, faces.reshape(-1, 1), "indices")
    primitive["mode"] = TRIANGLES


def _draco() -> ModuleType:
    return importlib.import_module("DracoPy")  # it has no types


def _decoded(block: bytes) -> Any:
    draco = _draco()
    try:
        return draco.decode(block)
    except (draco.FileTypeException, TypeError, ValueError, RuntimeError) as error:
        raise ValueError(f"its Draco data cannot be decompressed: {error}") from error


def _block(document: Document, number: int) -> bytes:
    """The bytes of a view."""
    view = document.tree["bufferViews"][number]
    start, length = view.get("byteOffset", 0), view["byteLength"]
    block = bytes(document.blob[start : start + length])
    if len(block) != length:
        raise ValueError(f"its Draco data has {len(block)} of {length} bytes")
    return block


def _add(document: Document, entry: dict[str, Any], values: NDArray, name: str) -> int:
    """An accessor of decompressed values."""
    dtype, width = np.dtype(COMPONENTS[entry["componentType"]]), WIDTHS[entry["type"]]
    if values.shape[1] != width:
        raise ValueError(f"its Draco data has {values.shape[1]} numbers for each of {name}")
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        if not ((values >= limits.min) & (values <= limits.max)).all():
            raise ValueError(f"its Draco data has {name} that their accessor cannot hold")
    for key in ("byteOffset", "sparse"):
        entry.pop(key, None)
    entry["bufferView"] = document.add_view(np.ascontiguousarray(values, dtype))
    return document.add("accessors", entry)


# The head of the data


def _check_promises(block: bytes, document: Document, primitive: dict[str, Any]) -> None:
    """Refuse data with other numbers than the accessors, or more than its size justifies."""
    accessors, mode = document.tree["accessors"], primitive.get("mode", TRIANGLES)
    if mode not in (TRIANGLES, STRIP):
        raise ValueError(f"mode is {mode}: Draco compresses triangles, 4 or 5")
    faces, points = _promised(BytesIO(block))
    if "indices" in primitive and mode == TRIANGLES:
        count = accessors[primitive["indices"]]["count"]
        if count != 3 * faces:
            raise ValueError(f"its Draco data promises {faces} triangles for {count} indices")
    count = accessors[primitive["attributes"]["POSITION"]]["count"]
    if points not in (None, count):
        raise ValueError(f"its Draco data promises {points} vertices for {count}")
    if max(faces, count) > MOST_ROWS * len(block):
        raise ValueError(
            f"its Draco data promises {faces} triangles and {count} vertices in {len(block)} bytes"
        )


def _promised(head: BytesIO) -> tuple[int, int | None]:
    """Numbers of faces and, if they are there, of points."""
    if head.read(5) != b"DRACO":
        raise ValueError("its Draco data does not begin with DRACO")
    version, kind, method = (_byte(head), _byte(head)), _byte(head), _byte(head)
    if kind != MESH:
        raise ValueError("its Draco data holds no mesh")
    if version != VERSION:
        raise ValueError(f"its Draco data has version {version[0]}.{version[1]}: 2.2 is known")
    if (_byte(head) | _byte(head) << 8) & HAS_METADATA:
        _skip_metadata(head)
    if method == SEQUENTIAL:
        return _varint(head), _varint(head)
    _byte(head)  # kind of traversal
    _varint(head)  # vertices, of which those at seams are several points
    return _varint(head), None


def _skip_metadata(head: BytesIO) -> None:
    for _ in range(_varint(head)):
        _varint(head)  # attribute
        _skip_entries(head)
    _skip_entries(head)


def _skip_entries(head: BytesIO) -> None:
    """Skip names and values, those of groups below too, which have a name each."""
    groups = _skip_group(head)
    while groups:
        head.seek(_byte(head), os.SEEK_CUR)
        groups += _skip_group(head) - 1


def _skip_group(head: BytesIO) -> int:
    """Skip the entries of a group; returns the number of groups below it."""
    for _ in range(_varint(head)):
        head.seek(_byte(head), os.SEEK_CUR)
        head.seek(_varint(head), os.SEEK_CUR)
    return _varint(head)


def _byte(head: BytesIO) -> int:
    found = head.read(1)
    if not found:
        raise ValueError("its Draco data ends in its head")
    return found[0]


def _varint(head: BytesIO) -> int:
    """A number of 32 bits in groups of 7, the lowest first."""
    number = 0
    for shift in range(0, 35, 7):
        byte = _byte(head)
        number |= (byte & 0x7F) << shift
        if byte < 0x80:
            return number
    raise ValueError("its Draco data has a number of more than 32 bits")
