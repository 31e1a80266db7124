# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to damage a file: anywhere in its bytes, or in what a checksum or a tree of it holds."""

import io
import json
import struct
import zipfile
import zlib
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

WORDS = (
    *(b"0", b"-1", b"1", b"3", b"255", b"65536", b"4294967295", b"99999999999999999999", b"1e308"),
    *(
        b"nan",
        b"inf",
        b"-inf",
        b"1e999",
        b"0x10",
        b"",
        b" ",
        b"\n",
        b"\0",
        b"\xff",
        b'"',
        b",",
        b"#",
    ),
    *(b"x", b"y", b"class", b"frame", b"object", b"vertex", b"face", b"element vertex 2", b"OFF"),
    *(
        b"property int x",
        b"property list uchar int vertex_indices",
        b"end_header",
        b"format ascii 1.0",
    ),
)
VALUES: tuple[Any, ...] = (
    *(None, True, 0, -1, 1, 2, 3, 5126, 5121, 2**31, 2**64, 1e300, float("nan"), float("inf")),
    *("", "x", "SCALAR", "VEC3", "data:,", "/", [], {}, [1], [[]], {"a": 1}),
)
TYPES = ("<f8", ">f4", "<i4", "|u1", "<u8", "|b1", "<c16", "<U3", "|S2", "<M8[s]", "<i8")


def damaged(data: bytes, suffix: str, random: Random) -> bytes:
    """One to four damages, of which the first may be in what the format wraps."""
    inner = INNER.get(suffix)
    if inner and random.random() < 0.8:
        return inner(data, random)
    for _ in range(random.randint(1, 4)):
        data = random.choice((_bits, _cut, _repeated, _word, _words))(data, random)
    return data


def _place(data: bytes, random: Random) -> int:
    return random.randrange(len(data) + 1)


def _bits(data: bytes, random: Random) -> bytes:
    at = _place(data, random)
    return data[:at] + bytes([random.randrange(256)]) + data[at + 1 :]


def _cut(data: bytes, random: Random) -> bytes:
    at = _place(data, random)
    return data[:at] + data[at + random.randint(1, 40) :] if random.random() < 0.7 else data[:at]


def _repeated(data: bytes, random: Random) -> bytes:
    at, other = _place(data, random), _place(data, random)
    return data[:at] + data[other : other + random.randint(1, 40)] + data[at:]


def _word(data: bytes, random: Random) -> bytes:
    at = _place(data, random)
    return data[:at] + random.choice(WORDS) + data[at:]


def _words(data: bytes, random: Random) -> bytes:
    """Replace one word by another."""
    words = data.split(b" ")
    words[random.randrange(len(words))] = random.choice(WORDS)
    return b" ".join(words)


def _in_zip(data: bytes, random: Random) -> bytes:
    """Bytes or arrays within npz, where the checksum would give them away."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = random.choice(list(parts))
    match random.randrange(4):
        case 0:
            parts[name] = _npy(_other_array(parts[name], random))
        case 1:
            del parts[name]
        case 2:
            parts[name] = _bits(parts[name], random)
        case _:
            parts[name] = _in_header(parts[name], random)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for key, content in parts.items():
            archive.writestr(key, content)
    return out.getvalue()


def _npy(array: np.ndarray) -> bytes:
    out = io.BytesIO()
    np.save(out, array, allow_pickle=False)
    return out.getvalue()


def _other_array(content: bytes, random: Random) -> np.ndarray:
    """Of another type or shape, or with another value."""
    array: np.ndarray = np.load(io.BytesIO(content))
    match random.randrange(4):
        case 0:
            return np.zeros(array.shape, random.choice(TYPES))
        case 1:
            return np.resize(array, [random.randrange(4) for _ in range(random.randrange(4))])
        case 2:
            return array[..., :-1] if array.ndim else array
        case _:
            values = array.astype(np.float64)
            if values.size:
                values.flat[random.randrange(values.size)] = random.choice(
                    (np.nan, np.inf, -1.0, 0.5, 1e300, 2.0**31)
                )
            return values


def _in_header(content: bytes, random: Random) -> bytes:
    """Another word in what says type and shape, whose length stays."""
    length = struct.unpack_from("<H", content, 8)[0]
    header = content[10 : 10 + length].decode("latin-1")
    old = random.choice(("<f8", "<i4", "False", "(", ")", ",", "'", "descr", "shape", "3"))
    new = random.choice(("True", "|O", "<U99", "-1", "99999999999", "((", "", "'", "1.5", "{", "a"))
    header = header.replace(old, new, 1)[:length].ljust(length)
    return content[:10] + header.encode("latin-1") + content[10 + length :]


def _in_tree(tree: Any, random: Random) -> None:
    """Another value somewhere, or none."""
    places: list[tuple[Any, Any]] = []
    left = [tree]
    while left:
        found = left.pop()
        keys = list(found) if isinstance(found, dict) else list(range(len(found)))
        places += [(found, key) for key in keys]
        left += [found[key] for key in keys if isinstance(found[key], (dict, list))]
    if not places:
        return
    found, key = random.choice(places)
    if random.random() < 0.3:
        del found[key]
    else:
        found[key] = random.choice(VALUES)


def _in_gltf(data: bytes, random: Random) -> bytes:
    tree = json.loads(data)
    for _ in range(random.randint(1, 3)):
        _in_tree(tree, random)
    return json.dumps(tree).encode()


def _in_glb(data: bytes, random: Random) -> bytes:
    length = struct.unpack_from("<I", data, 12)[0]
    tree = _in_gltf(data[20 : 20 + length], random)
    tree += b" " * (-len(tree) % 4)
    return data[:12] + struct.pack("<I", len(tree)) + data[16:20] + tree + data[20 + length :]


def _in_png(data: bytes, random: Random) -> bytes:
    """Bytes of a chunk, with the checksum that fits."""
    chunks, at = [], 8
    while at < len(data):
        length = struct.unpack_from(">I", data, at)[0]
        chunks.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    k = random.randrange(len(chunks))
    kind, content = chunks[k]
    chunks[k] = kind, _bits(content, random) if random.random() < 0.7 else _cut(content, random)
    if random.random() < 0.2:
        chunks.insert(k, random.choice(chunks))
    return data[:8] + b"".join(
        struct.pack(">I", len(content))
        + kind
        + content
        + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in chunks
    )


INNER: dict[str, Callable[[bytes, Random], bytes]] = {
    ".npz": _in_zip,
    ".gltf": _in_gltf,
    ".glb": _in_glb,
    ".png": _in_png,
}
