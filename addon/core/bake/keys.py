# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked keyframes: which frames become keyframes, how they are packed, the error in between.

A keyframe stores the place of every point in one frame. Its rows are packed into 16 bytes per
point: the index of a triangle (32 bits) in a table of the used triangles, two barycentric
coordinates and the angle (32 bits each); 12 more bytes where instances are tilted, 4 where they are
fitted to their clearance. A second table gives the keyframe of every frame and the distance to the
next one: docs/bake.md. If points are bound to the rest shape, the triangles also store their places
on it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..solve.stale import SKETCH_SUMS, sketch
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.records import TRIANGLE_ATTRIBUTES, Binding, Columns, Placed


@dataclass(frozen=True)
class Baked:
    """Packed keyframes, ready to be stored; columns are named as in records.py."""

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
        """For a frame and a number of points: both keyframes around it, and the weight of the
        second.
        """
        key, since, span = (
            int(self.frames[f"dapple_{name}"][frame]) for name in ("key", "since", "span")
        )
        return (
            self._key(key, count),
            self._key(key + min(span, 1), count),
            since / max(span, 1),
        )

    def there(self, frame: int, count: int) -> NDArray[np.bool_]:
        """Which of the points exist in a frame, or are fading."""
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
    """The first invalid index in stored keyframes, each with `count` points; empty if all are
    valid.
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
    """Distances between played and solved points on frames without a keyframe, in spacings."""

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
    """Collects solved frames and makes every n-th one and the last one a keyframe.

    Where the topology changes, one keyframe ends the old topology and another one begins the new.
    They are not interpolated, except for places on a rest shape, which both have.
    """

    count: int  # total number of frames
    every: int = 1
    # Called for each frame without a keyframe, counted from 0: with the points as they are played,
    # where they were solved, and the vertices of the surface.
    played: Callable[[int, Floats, Placed, Floats], None] | None = None
    error: KeyDistance = field(default_factory=KeyDistance)
    _next: int = 0
    _start: int = 0  # first frame of the current topology
    _offset: int = 0  # start of its triangles in the whole table
    _first_rows: list[int] = field(default_factory=list)  # first keyframe of each topology
    _topology: str = ""
    last: tuple[int, Binding] | None = None  # frame and binding of the newest keyframe
    _waiting: list[_Waiting] = field(default_factory=list)
    _empty: bool = False  # whether the last frame had no points
    _triangles: list[Ints] = field(default_factory=list)
    _rest: list[Columns] = field(default_factory=list)  # rest shape of the triangles, if any
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
        """Add the next frame: `bound` is the first frame of its topology, `surface` its own."""
        if bound.topology != self._topology or self._empty:
            self._begin(bound)
        frame = self._enter(surface)
        if (frame - self._start) % self.every == 0 or frame == self.count - 1:
            self._add_key(frame, placed)
        else:
            self._waiting.append(_Waiting(frame, placed, surface.vertices, spacing))

    def add_empty(self, placed: Placed, bound: SurfaceArrays, surface: SurfaceArrays) -> None:
        """Add a frame whose surface has no faces: all rows are marked as faded out.

        Consecutive frames without faces share one keyframe, which is not interpolated.
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
        """Index of the next frame; remembers its surface."""
        frame = self._next
        self._next += 1
        self._table[frame, 3] = len(surface.vertices)
        self._sketches.append(sketch(surface))
        return frame

    def packed(self) -> Baked:
        """All keyframes with the triangles that they use. Nothing can be added afterward."""
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
        """Columns of all keyframes, with the triangles by their place in the table.

        Each keyframe is freed once it is copied, as all of them may fill the memory.
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
            if tilt is not None:  # points that appear later have no tilt
                keys["dapple_tilt"][rows][: len(tilt)] = tilt
            if clearance is not None:
                keys["dapple_clearance"][rows][: len(clearance)] = clearance
            at += len(faces)
        return keys

    def _taken(self) -> Iterator[tuple[Ints, Any, Floats | None, Floats | None, Floats | None]]:
        """The rows of each keyframe, which are freed."""
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
        """Add rows to each keyframe for the points that appear later."""
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
        """Where points will appear; on faces that do not exist yet, copies of the first row."""
        (faces, places), (later_faces, later_places) = self._rows[key], self._rows[key + 1]
        if key + 1 not in self._first_rows:
            return later_faces[len(faces) :], later_places[len(faces) :]
        first = np.zeros(len(later_faces) - len(faces), dtype=np.int64)
        return faces[first], places[first]

    def _end_topology(self) -> None:
        """Make the last frame a keyframe."""
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
        """Remove the triangles of the finished topology that no keyframe uses."""
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
                mixed = _mixed(waiting, binding, placed.binding, share)
                self.error.add(_distances(waiting, mixed))
                if self.played is not None:
                    self.played(waiting.frame, mixed, waiting.placed, waiting.vertices)
        self._waiting.clear()
        self.last = frame, placed.binding
        places = np.column_stack([placed.binding.barycentric[:, 1:], placed.binding.angle])
        self._rows.append((placed.faces + np.int32(self._offset), places.astype(np.float32)))
        self._faded.append(_single(placed.faded))
        self._tilt.append(_single(placed.tilt))
        self._clearance.append(_single(placed.clearance))


def _rest_of(bound: SurfaceArrays) -> Columns:
    """Columns of all triangles, named as in REST_TRIANGLE_ATTRIBUTES."""
    assert bound.rest is not None
    corners: Columns = {
        f"dapple_r{k}": bound.rest[bound.faces[:, k]].astype(np.float32) for k in range(3)
    }
    return {**corners, "dapple_part": bound.parts}


def _single(values: Floats | None) -> Any:
    """Values in the single precision of stored keyframes."""
    return None if values is None else values.astype(np.float32)


def padded(tilts: Floats, count: int) -> Floats:
    """Tilts (k, 3), extended to `count` rows by zeros for points that appear later."""
    found: Floats = np.concatenate([tilts, np.zeros((count - len(tilts), 3))])
    return found


def _mixed(waiting: _Waiting, before: Binding, after: Binding, share: float) -> Floats:
    """Points of two interpolated keyframes on the surface of a frame, without those that appear in
    between, which are not in the first keyframe.
    """
    first = before.positions(waiting.vertices)
    second = after.positions(waiting.vertices)[: len(first)]
    found: Floats = (1.0 - share) * first + share * second
    return found


def _distances(waiting: _Waiting, mixed: Floats) -> Floats:
    """Distances of interpolated points from the solved ones, in spacings."""
    solved = waiting.placed.binding.positions(waiting.vertices)[: len(mixed)]
    return np.linalg.norm(mixed - solved, axis=1) / max(waiting.spacing, 1e-30)
