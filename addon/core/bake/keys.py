# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked keys: which frames become keys, how they are packed, what the frames between lose.

A key holds where every point sits in one frame. Its rows are packed: the index of a triangle
(32 bits) in a table of the triangles that are used, two barycentrics and the angle carried (32 bits
each), 16 bytes for a point; 12 more where some instances lean, 4 where they are fitted to their
room. A second table says for every frame which key is played, and how far it is to the next one:
docs/bake.md. Where points are bound to the rest shape, the triangles store where they lie on it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..solve.stale import SKETCH_SUMS, sketch
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.records import TRIANGLE_ATTRIBUTES, Binding, Columns, Placed


@dataclass(frozen=True)
class Baked:
    """Packed keys, ready to be stored; columns named as in records.py."""

    keys: Columns  # dapple_face of each row, and as its position: barycentrics 1 and 2, angle;
    # dapple_faded where points appear or vanish, dapple_tilt where instances lean, dapple_clearance
    # where instances are fitted to it
    triangles: Columns  # TRIANGLE_ATTRIBUTES, and where the points are bound to the rest shape
    # REST_TRIANGLE_ATTRIBUTES
    frames: Columns  # FRAME_ATTRIBUTES of each frame

    @property
    def frame_count(self) -> int:
        return len(self.frames["dapple_key"])

    def binding(self, frame: int, count: int) -> tuple[Binding, Binding, float]:
        """Of a whole frame, count points: both keys around it, and the share of the second."""
        key, since, span = (
            int(self.frames[f"dapple_{name}"][frame]) for name in ("key", "since", "span")
        )
        return (
            self._key(key, count),
            self._key(key + min(span, 1), count),
            since / max(span, 1),
        )

    def there(self, frame: int, count: int) -> NDArray[np.bool_]:
        """Which of count points are there in a frame, or on the way."""
        key, span = (int(self.frames[f"dapple_{name}"][frame]) for name in ("key", "span"))
        if "dapple_faded" not in self.keys:
            return np.ones(count, dtype=bool)
        faded = self.keys["dapple_faded"].reshape(-1, count)
        found: NDArray[np.bool_] = np.minimum(faded[key], faded[key + min(span, 1)]) < 1.0
        return found

    def _key(self, key: int, count: int) -> Binding:
        rows = slice(key * count, (key + 1) * count)
        faces, places = self.keys["dapple_face"][rows], self.keys["position"][rows].astype(float)
        corners, loops = (
            np.column_stack([self.triangles[f"dapple_{kind}{k}"][faces] for k in range(3)])
            for kind in "vc"
        )
        first = 1.0 - places[:, 0] - places[:, 1]
        weights = np.column_stack([first, places[:, 0], places[:, 1]])
        return Binding(corners, weights, places[:, 2], loops)


def wrong_index(faces: Ints, triangles: Columns, frames: Columns, count: int) -> str:
    """The first index of stored keys, each of count points, that points to nothing; empty where
    all are right.
    """
    keys = len(faces) // max(count, 1)
    if keys * count != len(faces):
        return f"{len(faces)} rows are not a multiple of {count} points"
    last = frames["dapple_key"] + np.minimum(frames["dapple_span"], 1)
    highest = int(np.max(frames["dapple_vertices"], initial=0))
    limits: list[tuple[str, Any, int]] = [("dapple_face", faces, len(triangles["dapple_v0"]))]
    limits += [(f"dapple_v{k}", triangles[f"dapple_v{k}"], highest) for k in range(3)]
    limits += [("dapple_key", frames["dapple_key"], keys), ("dapple_key + 1", last, keys)]
    for name, values, limit in limits:
        if len(values) and not 0 <= values.min() <= values.max() < limit:
            row = int(np.argmax((values < 0) | (values >= limit)))
            return f"{name}[{row}] is {values[row]}, there are {limit}"
    return ""


@dataclass
class KeyDistance:
    """Distances of the played from the solved points on frames without a key, in spacings."""

    largest: float = 0.0
    total: float = 0.0
    count: int = 0

    @property
    def mean(self) -> float:
        return self.total / max(self.count, 1)

    def add(self, distances: Floats) -> None:
        self.largest = max(self.largest, float(np.max(distances, initial=0.0)))
        self.total += float(distances.sum())
        self.count += len(distances)


@dataclass(frozen=True)
class _Waiting:
    frame: int
    placed: Placed
    vertices: Floats
    spacing: float


@dataclass
class Keyframes:
    """Collects solved frames: every so many of them become keys, and the last of all.

    Where the topology changes, a key ends what was and a key begins what comes; nothing is
    mixed across, but for places of a rest shape, which both have.
    """

    count: int  # frames in all
    every: int = 1
    error: KeyDistance = field(default_factory=KeyDistance)
    _next: int = 0
    _start: int = 0  # first frame of this topology
    _offset: int = 0  # of its triangles in the table of all
    _first_rows: list[int] = field(default_factory=list)  # first keys of all topologies
    _topology: str = ""
    last: tuple[int, Binding] | None = None  # frame of the newest key, and its binding
    _waiting: list[_Waiting] = field(default_factory=list)
    _empty: bool = False  # whether no point was there on the last frame
    _triangles: list[Ints] = field(default_factory=list)
    _rest: list[Columns] = field(default_factory=list)  # of the triangles; empty: none is known
    _rows: list[tuple[Ints, Any]] = field(default_factory=list)
    _faded: list[Floats | None] = field(default_factory=list)
    _tilt: list[Floats | None] = field(default_factory=list)
    _clearance: list[Floats | None] = field(default_factory=list)
    _sketches: list[Floats] = field(default_factory=list)
    _table: Ints = field(default_factory=lambda: np.zeros((0, 4), dtype=np.int32))
    _packed: Baked | None = None

    def __post_init__(self) -> None:
        self._table = np.zeros((self.count, 4), dtype=np.int32)

    def add(
        self, placed: Placed, bound: SurfaceArrays, surface: SurfaceArrays, spacing: float
    ) -> None:
        """The next frame: bound is the first frame of its topology, surface its own."""
        if bound.topology != self._topology or self._empty:
            self._begin(bound)
        frame = self._enter(surface)
        if (frame - self._start) % self.every == 0 or frame == self.count - 1:
            self._add_key(frame, placed)
        else:
            self._waiting.append(_Waiting(frame, placed, surface.vertices, spacing))

    def add_empty(self, placed: Placed, bound: SurfaceArrays, surface: SurfaceArrays) -> None:
        """The next frame, whose surface has no faces: all rows, on the faces of bound, are gone.

        Frames without faces that follow each other are one key, which is mixed with no other.
        """
        if not self._topology:
            self._begin(bound)
        frame = self._enter(replace(surface, vertices=np.empty((0, 3))))
        self._table[frame, 3] = len(surface.vertices)
        if self._empty:
            self._table[frame, :3] = len(self._rows) - 1, 0, 0
            return
        self._end_topology()
        self.last, self._empty = None, True
        self._add_key(frame, placed)
        self.last = None

    def _enter(self, surface: SurfaceArrays) -> int:
        """Index of the next frame, whose surface is noted."""
        frame = self._next
        self._next += 1
        self._table[frame, 3] = len(surface.vertices)
        self._sketches.append(sketch(surface))
        return frame

    def packed(self) -> Baked:
        """All keys, over the triangles that they use; no more can be added then."""
        if self._packed is None:
            self._packed = self._pack()
        return self._packed

    def _pack(self) -> Baked:
        self._fill_up()
        triangles = np.concatenate(self._triangles)
        used = np.zeros(len(triangles), dtype=bool)
        for faces, _ in self._rows:
            used[faces] = True
        keys = self._all_rows(np.cumsum(used, dtype=np.int32) - 1)
        names = ("key", "since", "span", "vertices")
        sketches = np.array(self._sketches, dtype=np.float32)
        return Baked(
            keys,
            self._packed_triangles(triangles, used),
            {
                **{f"dapple_{name}": self._table[:, k].copy() for k, name in enumerate(names)},
                **{f"dapple_sketch{k}": sketches[:, k] for k in range(SKETCH_SUMS)},
            },
        )

    def _all_rows(self, place: Ints) -> Columns:
        """Columns of all keys, their triangles by place; a key is let go as soon as it is in them:
        together they may fill the memory.
        """
        count = sum(len(faces) for faces, _ in self._rows)
        keys: Columns = {
            "dapple_face": np.empty(count, dtype=np.int32),
            "position": np.empty((count, 3), dtype=np.float32),
        }
        if any(faded is not None for faded in self._faded):
            keys["dapple_faded"] = np.zeros(count, dtype=np.float32)
        if any(tilt is not None for tilt in self._tilt):
            keys["dapple_tilt"] = np.zeros((count, 3), dtype=np.float32)
        if any(clearance is not None for clearance in self._clearance):
            keys["dapple_clearance"] = np.zeros(count, dtype=np.float32)
        at = 0
        for faces, places, faded, tilt, clearance in self._taken():
            rows = slice(at, at + len(faces))
            keys["dapple_face"][rows], keys["position"][rows] = place[faces], places
            if faded is not None:
                keys["dapple_faded"][rows] = faded
            if tilt is not None:  # of points that appear later none leans
                keys["dapple_tilt"][rows][: len(tilt)] = tilt
            if clearance is not None:
                keys["dapple_clearance"][rows][: len(clearance)] = clearance
            at += len(faces)
        return keys

    def _taken(self) -> Iterator[tuple[Ints, Any, Floats | None, Floats | None, Floats | None]]:
        """The rows of each key, which are not kept."""
        for store in (self._rows, self._faded, self._tilt, self._clearance):
            store.reverse()
        while self._rows:
            yield *self._rows.pop(), self._faded.pop(), self._tilt.pop(), self._clearance.pop()

    def _packed_triangles(self, triangles: Ints, used: NDArray[np.bool_]) -> Columns:
        columns: Columns = dict(zip(TRIANGLE_ATTRIBUTES, triangles[used].T.copy(), strict=True))
        for name in self._rest[0] if self._rest else ():
            columns[name] = np.concatenate([rest[name] for rest in self._rest])[used]
        return columns

    def _fill_up(self) -> None:
        """Give each key rows for the points that appear later, which are not there yet."""
        for key in range(len(self._rows) - 2, -1, -1):
            own, later = self._rows[key], self._rows_after(key)
            more = len(later[0])
            if more:
                faded = self._faded[key]
                assert faded is not None
                self._rows[key] = (
                    np.concatenate([own[0], later[0]]),
                    np.concatenate([own[1], later[1]]),
                )
                self._faded[key] = np.concatenate([faded, np.ones(more, dtype=np.float32)])

    def _rows_after(self, key: int) -> tuple[Ints, Any]:
        """Where points will appear; on faces that are not there yet, as many like the first row."""
        (faces, places), (later_faces, later_places) = self._rows[key], self._rows[key + 1]
        if key + 1 not in self._first_rows:
            return later_faces[len(faces) :], later_places[len(faces) :]
        first = np.zeros(len(later_faces) - len(faces), dtype=np.int64)
        return faces[first], places[first]

    def _end_topology(self) -> None:
        """Have the last frame be a key."""
        if self._waiting:
            last = self._waiting.pop()
            self._add_key(last.frame, last.placed)

    def _begin(self, bound: SurfaceArrays) -> None:
        self._end_topology()
        self._drop_unused()
        self._empty = False
        self._offset = sum(map(len, self._triangles))
        self._first_rows.append(len(self._rows))
        self._triangles.append(np.column_stack([bound.faces, bound.face_corners]))
        self._topology, self._start = bound.topology, self._next
        if bound.rest is None:
            self.last = None
        else:
            self._rest.append(_rest_of(bound))

    def _drop_unused(self) -> None:
        """Keep those triangles of the topology that ends which its keys use."""
        if not self._rows:
            return
        begin = self._first_rows[-1]
        rows = self._rows[begin:]
        used = np.zeros(len(self._triangles[-1]), dtype=bool)
        for faces, _ in rows:
            used[faces - self._offset] = True
        place = np.cumsum(used, dtype=np.int32) - 1 + np.int32(self._offset)
        self._rows[begin:] = [(place[faces - self._offset], places) for faces, places in rows]
        self._triangles[-1] = self._triangles[-1][used]
        for name, values in (self._rest[-1] if self._rest else {}).items():
            self._rest[-1][name] = values[used]

    def _add_key(self, frame: int, placed: Placed) -> None:
        key = len(self._rows)
        self._table[frame, :3] = key, 0, 0
        if self.last is not None:
            begin, binding = self.last
            for between in range(begin, frame):
                self._table[between, :3] = key - 1, between - begin, frame - begin
            for waiting in self._waiting:
                share = (waiting.frame - begin) / (frame - begin)
                self.error.add(_distances(waiting, binding, placed.binding, share))
        self._waiting.clear()
        self.last = frame, placed.binding
        places = np.column_stack([placed.binding.barycentric[:, 1:], placed.binding.angle])
        self._rows.append((placed.faces + np.int32(self._offset), places.astype(np.float32)))
        self._faded.append(_single(placed.faded))
        self._tilt.append(_single(placed.tilt))
        self._clearance.append(_single(placed.clearance))


def _rest_of(bound: SurfaceArrays) -> Columns:
    """Columns named as in REST_TRIANGLE_ATTRIBUTES, of all triangles."""
    assert bound.rest is not None
    corners: Columns = {
        f"dapple_r{k}": bound.rest[bound.faces[:, k]].astype(np.float32) for k in range(3)
    }
    return {**corners, "dapple_part": bound.parts}


def _single(values: Floats | None) -> Any:
    """In the single precision in which keys are stored."""
    return None if values is None else values.astype(np.float32)


def padded(tilts: Floats, count: int) -> Floats:
    """Leans (k, 3) and as many of none as make them so many: of points that appear later."""
    found: Floats = np.concatenate([tilts, np.zeros((count - len(tilts), 3))])
    return found


def _distances(waiting: _Waiting, before: Binding, after: Binding, share: float) -> Floats:
    """Of the two keys mixed on the surface of a frame from where its points were solved."""
    known = len(before.corners)  # points that appear in between have no place before
    first = before.positions(waiting.vertices)
    second = after.positions(waiting.vertices)[:known]
    solved = waiting.placed.binding.positions(waiting.vertices)[:known]
    apart = np.linalg.norm((1.0 - share) * first + share * second - solved, axis=1)
    return apart / max(waiting.spacing, 1e-30)
