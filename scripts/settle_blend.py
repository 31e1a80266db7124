# SPDX-License-Identifier: GPL-3.0-or-later
"""The same data-blocks as the same bytes of a .blend, whenever they are written.

A file's blocks are named by the addresses that they had in memory, and nodes by random numbers:
here both are numbered in their order. Pointers that lead to no block, which readers ignore, are 0.
Format: https://developer.blender.org/docs/features/core/blendfile/
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from struct import calcsize, pack_into, unpack_from

_ADDRESS = 8  # offset in the head of a block
_ZONES = ("NodeGeometryForeachGeometryElementInput",)  # at the begin of one
_RAW = 0  # structure of what is none, also lists of pointers
_TEXT = 0  # kind of a custom property
_BYTES = (45, 50)  # kinds of mesh attributes with one byte for each item: small numbers, truths
_DOMAINS = (("vdata", "totvert"), ("edata", "totedge"), ("pdata", "totpoly"), ("ldata", "totloop"))


@dataclass(frozen=True)
class _Format:
    """How a file and its blocks begin; 8 bytes a pointer, little endian."""

    file_head: bytes  # and three or four digits of Blender's version
    file_size: int
    head: str
    order: tuple[int, int, int]  # in the head: where bytes, address, index of the structure are


_FORMATS = (
    _Format(b"BLENDER-v", 12, "<4siQii", (1, 2, 3)),
    _Format(b"BLENDER17-01v", 17, "<4siQqq", (3, 2, 1)),  # since Blender 5.0
)


@dataclass(frozen=True)
class _Block:
    head: int  # where it begins
    code: bytes
    start: int
    size: int
    address: int
    structure: int

    def slots(self, offsets: list[int], size: int) -> Iterator[int]:
        """Places in the file of members at these offsets, in each of the items."""
        for item in range(self.start, self.start + self.size - size + 1, size):
            yield from (item + offset for offset in offsets)


def settled(data: bytes) -> bytes:
    """An uncompressed .blend that depends on its data-blocks alone; ValueError if it cannot be."""
    blocks = _blocks(data)
    table = next(block for block in blocks if block.code == b"DNA1")
    structures = _Structures(data[table.start : table.start + table.size])
    if any(structures.name(block.structure) == "bNestedNodeRef" for block in blocks):
        raise ValueError("nodes are named by others in this .blend: it holds a simulation or bake")
    result = bytearray(data)
    for block, numbers in zip(blocks, _numbers(blocks), strict=True):
        pack_into("<Q", result, block.head + _ADDRESS, numbers.get(block.address, 0))
        if block.code not in (b"DNA1", b"ENDB"):
            _settle_pointers(result, block, structures, numbers)
    for block in blocks:
        if structures.name(block.structure) == "AssetMetaData":
            _clear_asset(result, block, structures)
        _clear_chance(result, block, structures)
    _clear_ends(result, blocks, structures)
    _number_nodes(result, blocks, structures)
    return bytes(result)


def _blocks(data: bytes) -> list[_Block]:
    form = next((form for form in _FORMATS if data.startswith(form.file_head)), None)
    if form is None:
        raise ValueError(f"no uncompressed .blend of a known kind, it begins with {data[:17]!r}")
    found: list[_Block] = []
    at = form.file_size
    while not found or found[-1].code != b"ENDB":
        head = unpack_from(form.head, data, at)
        size, address, structure = (head[place] for place in form.order)
        start = at + calcsize(form.head)
        found.append(_Block(at, head[0], start, size, address, structure))
        at = start + size
    return found


def _numbers(blocks: list[_Block]) -> list[dict[int, int]]:
    """For each block, address -> number of what it can point to: data of its own data-block, and
    all data-blocks. Data of two data-blocks may have had the same address.
    """
    order = {block.start: 16 * number for number, block in enumerate(blocks, 1)}
    shared = {
        block.address: order[block.start]
        for block in blocks
        if block.code != b"DATA" and block.address
    }
    found: list[dict[int, int]] = []
    for block in blocks:
        own = found[-1] if block.code == b"DATA" else dict(shared)
        if block.address:
            own[block.address] = order[block.start]
        found.append(own)
    return found


def _settle_pointers(
    result: bytearray, block: _Block, structures: "_Structures", numbers: dict[int, int]
) -> None:
    raw = block.structure == _RAW
    size = 8 if raw else structures.size(block.structure)
    offsets = [0] if raw else [place for place, _ in structures.pointers(block.structure)]
    for place in block.slots(offsets, size):
        (address,) = unpack_from("<Q", result, place)
        if address in numbers or not raw:
            pack_into("<Q", result, place, numbers.get(address, 0))


def _number_nodes(result: bytearray, blocks: list[_Block], structures: "_Structures") -> None:
    """Also where the begin of a zone names its end; numbers are those of one data-block's nodes."""
    count, numbers = 0, list[dict[int, int]]()
    for block in blocks:
        numbers.append({} if block.code != b"DATA" else numbers[-1])
        if structures.name(block.structure) == "bNode":
            count += 1
            place = block.start + structures.offset(block.structure, "identifier")
            numbers[-1][unpack_from("<i", result, place)[0]] = count
            pack_into("<i", result, place, count)
    for block, own in zip(blocks, numbers, strict=True):
        if structures.name(block.structure) in _ZONES:
            place = block.start + structures.offset(block.structure, "output_node_id")
            pack_into("<i", result, place, own[unpack_from("<i", result, place)[0]])


def _clear_asset(result: bytearray, block: _Block, structures: "_Structures") -> None:
    """Bytes that Blender never set: the catalog's name, which it knows by its UUID, and gaps."""
    for name, _, begin, end in structures.members(block.structure):
        if name.startswith(("catalog_simple_name", "_pad")):
            result[block.start + begin : block.start + end] = bytes(end - begin)


def _clear_chance(result: bytearray, block: _Block, structures: "_Structures") -> None:
    """Numbers that are others in each session: of a node tree inside a material, which Blender
    counts when it reads one, and for the colors of a mesh's face sets.
    """
    for name, kind, begin, end in structures.members(block.structure):
        if name == "face_sets_color_seed":
            result[block.start + begin : block.start + end] = bytes(end - begin)
        elif name == "id" and structures.is_head(kind):
            at = block.start + begin + structures.offset_in(kind, "session_uid")
            result[at : at + 4] = bytes(4)


def _clear_ends(result: bytearray, blocks: list[_Block], structures: "_Structures") -> None:
    """Up to three bytes that were never set, behind texts and bytes of meshes: memory for them
    comes in fours.
    """
    for block in blocks:
        if block.structure != _RAW:
            for start in block.slots([0], structures.size(block.structure)):
                item = _Item(result, blocks, structures, block.structure, start)
                for address, count in (*item.texts(), *item.value(), *item.layers()):
                    _clear_end(result, blocks[address // 16 - 1] if address else None, count)


def _clear_end(result: bytearray, block: _Block | None, count: int | None) -> None:
    """Of a block that holds this number of bytes, or a text up to its end."""
    if block and block.structure == _RAW:
        data = bytes(result[block.start : block.start + block.size])
        used = len(data.split(b"\0", 1)[0]) + 1 if count is None else count
        if len(data) - used < 4:
            result[block.start : block.start + block.size] = data[:used].ljust(len(data), b"\0")


@dataclass(frozen=True)
class _Item:
    """A structure in a file whose pointers are numbers of blocks already."""

    data: bytearray
    blocks: list[_Block]
    structures: "_Structures"
    structure: int
    start: int

    def number(self, *names: str) -> int:
        begin, end = self.structures.place(self.structure, *names)
        return int.from_bytes(self.data[self.start + begin : self.start + end], "little")

    def texts(self) -> Iterator[tuple[int, None]]:
        for place, text in self.structures.pointers(self.structure):
            if text:
                yield unpack_from("<Q", self.data, self.start + place)[0], None

    def value(self) -> Iterator[tuple[int, int]]:
        """Of a custom property that is a text."""
        if self.structures.name(self.structure) == "IDProperty" and self.number("type") == _TEXT:
            yield self.number("data", "*pointer"), self.number("len")

    def layers(self) -> Iterator[tuple[int, int]]:
        """Of a mesh: its attributes with one byte for each item."""
        if self.structures.name(self.structure) != "Mesh":
            return
        for domain, count in _DOMAINS:
            address = self.number(domain, "*layers")
            for layer in self._items(address) if address else ():
                if layer.number("type") in _BYTES:
                    yield layer.number("*data"), self.number(count)

    def _items(self, address: int) -> "Iterator[_Item]":
        block = self.blocks[address // 16 - 1]
        for start in block.slots([0], self.structures.size(block.structure)):
            yield _Item(self.data, self.blocks, self.structures, block.structure, start)


class _Structures:
    """The structures of a file (block DNA1): their members, in their order."""

    def __init__(self, table: bytes) -> None:
        self._table, self._at = table, len("SDNANAME")
        names = self._words()
        self._at += len("TYPE")
        self._types = self._words()
        self._at += len("TLEN")
        self._sizes = self._shorts(len(self._types))
        self._at += -self._at % 4 + len("STRC")
        self._structures = [self._structure(names) for _ in range(self._count())]
        self._of_type = {kind: index for index, (kind, _) in enumerate(self._structures)}
        self.pointers = cache(lambda structure: list(self._pointers(structure)))

    def name(self, structure: int) -> str:
        return self._types[self._structures[structure][0]]

    def size(self, structure: int) -> int:
        return self._sizes[self._structures[structure][0]]

    def offset(self, structure: int, name: str) -> int:
        """Where the member of this name begins."""
        found = (start for member, _, start, _ in self.members(structure) if member == name)
        return next(found)

    def is_head(self, kind: int) -> bool:
        """Whether a type is that with which each data-block begins."""
        return self._types[kind] == "ID"

    def offset_in(self, kind: int, name: str) -> int:
        """Where the member of this name begins in a type."""
        return self.offset(self._of_type[kind], name)

    def _pointers(self, structure: int, start: int = 0) -> Iterator[tuple[int, bool]]:
        """Where they are, and whether they lead to texts."""
        for name, kind, begin, end in self.members(structure):
            if name.startswith(("*", "(*")):
                text = self._types[kind] == "char" and not name.startswith("**")
                yield from ((place, text) for place in range(start + begin, start + end, 8))
            elif kind in self._of_type:
                for item in range(start + begin, start + end, self._sizes[kind]):
                    yield from self._pointers(self._of_type[kind], item)

    def place(self, structure: int, *names: str) -> tuple[int, int]:
        """Begin and end of a member, or of a member's member."""
        members = self.members(structure)
        kind, begin, end = next(found for name, *found in members if name == names[0])
        if len(names) == 1:
            return begin, end
        inner_begin, inner_end = self.place(self._of_type[kind], *names[1:])
        return begin + inner_begin, begin + inner_end

    def members(self, structure: int) -> Iterator[tuple[str, int, int, int]]:
        """Name, type, offset and end of each."""
        begin = 0
        for kind, name in self._structures[structure][1]:
            end = begin + (8 if name.startswith(("*", "(*")) else self._sizes[kind])
            for length in re.findall(r"\[(\d+)\]", name):
                end = begin + (end - begin) * int(length)
            yield name, kind, begin, end
            begin = end

    def _count(self) -> int:
        (count,) = unpack_from("<i", self._table, self._at)
        self._at += 4
        return int(count)

    def _shorts(self, count: int) -> list[int]:
        found = unpack_from(f"<{count}h", self._table, self._at)
        self._at += 2 * count
        return list(found)

    def _words(self) -> list[str]:
        found = []
        for _ in range(self._count()):
            end = self._table.index(b"\0", self._at)
            found.append(self._table[self._at : end].decode())
            self._at = end + 1
        self._at += -self._at % 4
        return found

    def _structure(self, names: list[str]) -> tuple[int, list[tuple[int, str]]]:
        kind, count = self._shorts(2)
        members = self._shorts(2 * count)
        pairs = zip(members[::2], members[1::2], strict=True)
        return kind, [(member, names[name]) for member, name in pairs]
