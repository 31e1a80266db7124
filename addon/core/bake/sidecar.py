# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in progress of a bake: one file for each solved frame, so that it can go on after a stop.

Frames that are solved in pieces have a second file each where they are ahead: window_bake.py.
A file is an npz of plain arrays (docs/bake.md lists them). It is written under another name,
flushed to the disk and renamed, so a frame is there as a whole or not at all. Its fingerprint
covers all that the frame was solved from, its digest what it holds and of which frame; a file that
is torn, changed, exchanged, foreign or of other input is as good as none.
"""

import hashlib
import io
import json
import os
import shutil
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic_file import replacing
from ..base.native import package
from ..settings.values import Settings
from ..solve.solve import Report
from ..surface.arrays import SurfaceArrays
from ..surface.binding import attached_to
from ..surface.records import Binding, Columns, Placed

FORMAT = 2
_OURS = ("frame_*", "ahead_*")
_MORE = "more_"  # how names of arrays begin that only populations have


@dataclass(frozen=True)
class Solved:
    """What the tracker found in one frame, in full precision."""

    placed: Placed
    report: Report
    settled: bool = False  # dapple.Tracker.settled, to go on from here
    more: Columns = field(default_factory=dict)  # of a population: who is there, what it remembers


class Fingerprint:
    """Digest of all that a frame is solved from: version, settings, start, every frame so far."""

    def __init__(self, settings: Settings, start: Binding, arrays: Iterable[Any]) -> None:
        version = package().__version__
        head = json.dumps([FORMAT, version, asdict(settings)], sort_keys=True)
        self._digest = hashlib.blake2b(head.encode(), digest_size=16)
        for array in (start.corners, start.barycentric, start.angle, *arrays):
            self._add(array)

    def note(self, text: str) -> None:
        """What else all frames are solved from."""
        self._digest.update(text.encode())

    def note_array(self, array: Any) -> None:
        """The same for numbers."""
        self._add(array)

    def add(self, frame: SurfaceArrays) -> str:
        """The fingerprint with one more frame."""
        self._digest.update(frame.topology.encode())
        self._add(frame.vertices)
        if frame.normals is not None:
            self._add(frame.normals)
        if frame.rest is not None:
            self._add(frame.rest)
        return self.now()

    def now(self) -> str:
        """The fingerprint of all that was added."""
        return self._digest.copy().hexdigest()

    def _add(self, array: Any) -> None:
        values = np.ascontiguousarray(array)
        self._digest.update(f"{values.dtype.str}{values.shape}".encode())
        self._digest.update(values.tobytes())


def start_digest(settings: Settings, way: str, first: int, columns: Columns) -> str:
    """What a bake begins with, in a few letters: settings, way of baking, first frame, points."""
    head = json.dumps([FORMAT, package().__version__, asdict(settings), way, first], sort_keys=True)
    digest = hashlib.blake2b(head.encode(), digest_size=4)
    for name, values in sorted(columns.items()):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class Sidecar:
    """A folder of solved frames."""

    folder: Path

    def path(self, frame: int, *, ahead: bool = False) -> Path:
        """File of a frame of the scene."""
        return self.folder / f"{'ahead' if ahead else 'frame'}_{frame:06d}.npz"

    def load(
        self,
        frame: int,
        fingerprint: str,
        points: int | None,
        surface: SurfaceArrays,
        *,
        ahead: bool = False,
    ) -> Solved | None:
        """The frame if it was solved from the same input: so many points, or any, on a surface with
        these faces.
        """
        try:
            with np.load(self.path(frame, ahead=ahead), allow_pickle=False) as stored:
                if str(stored["fingerprint"]) != fingerprint:
                    return None
                arrays = {name: stored[name] for name in stored.files}
            if str(arrays.pop("digest")) != _digest(self.path(frame, ahead=ahead), arrays):
                return None
            return _checked(arrays, points, surface)
        except Exception:  # whatever broken bytes make numpy and zipfile raise
            return None

    def fingerprint(self, frame: int) -> str:
        """Of a frame's file; empty where there is none."""
        try:
            with np.load(self.path(frame), allow_pickle=False) as stored:
                return str(stored["fingerprint"])
        except Exception:  # whatever broken bytes make numpy and zipfile raise
            return ""

    def store(self, frame: int, fingerprint: str, solved: Solved, *, ahead: bool = False) -> None:
        """Keep a frame, on the disk when this returns; OSError if that fails."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.path(frame, ahead=ahead)
        part = path.with_suffix(f".{os.getpid()}.part")
        tilt = solved.placed.tilt
        arrays: dict[str, Any] = {
            "fingerprint": np.array(fingerprint),
            "faces": solved.placed.faces,
            "barycentric": solved.placed.binding.barycentric,
            "angle": solved.placed.binding.angle,
            "report": np.array(json.dumps(asdict(solved.report))),
            "settled": np.array(solved.settled),
        }
        arrays |= {} if tilt is None else {"tilt": tilt}
        arrays |= {_MORE + name: np.asarray(values) for name, values in solved.more.items()}
        packed = io.BytesIO()  # numpy leaves an archive on the disk open when a write fails
        np.savez(packed, digest=np.array(_digest(path, arrays)), **arrays)
        with replacing(path, part):
            part.write_bytes(packed.getbuffer())

    def frames(self) -> int:
        """Number of files of frames that are done, whatever they hold."""
        return len(list(self.folder.glob("frame_*.npz")))

    def move(self, folder: Path) -> None:
        """Take the frames to another folder, over those that are there; OSError if that fails."""
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(path for one in _OURS for path in self.folder.glob(one + ".npz")):
            shutil.move(path, folder / path.name)
        self.clear()

    def clear(self) -> None:
        """Remove the frames and what a killed process left; other files stay."""
        for ours in _OURS:
            for suffix in (".npz", ".part"):
                for path in self.folder.glob(ours + suffix):
                    path.unlink(missing_ok=True)
        for folder in (self.folder, self.folder.parent):
            try:
                folder.rmdir()
            except OSError:  # not there, or not empty
                return


def _digest(path: Path, arrays: dict[str, Any]) -> str:
    """Of the arrays of a file, which belong to the frame that it is named by."""
    digest = hashlib.blake2b(path.stem.encode(), digest_size=16)
    for name, array in sorted(arrays.items()):
        values = np.ascontiguousarray(array)
        digest.update(f"{name} {values.dtype.str}{values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()


def _checked(stored: dict[str, Any], points: int | None, surface: SurfaceArrays) -> Solved:
    """The stored frame; ValueError if its arrays cannot be of such a frame."""
    points = len(stored["faces"]) if points is None else points
    wanted = {
        "faces": ("i4", (points,)),
        "barycentric": ("f8", (points, 3)),
        "angle": ("f8", (points,)),
    }
    if "tilt" in stored:
        wanted["tilt"] = ("f8", (points, 3))
    for name, (kind, shape) in wanted.items():
        if stored[name].dtype != np.dtype(kind) or stored[name].shape != shape:
            raise ValueError(f"{name} has another type or shape")
        if not np.isfinite(stored[name]).all():
            raise ValueError(f"{name} is not finite")
    if points and not 0 <= stored["faces"].min() <= stored["faces"].max() < len(surface.faces):
        raise ValueError("faces has an index out of range")
    binding = replace(
        attached_to(surface, stored["faces"], stored["barycentric"]), angle=stored["angle"]
    )
    report = Report(**json.loads(str(stored["report"])))
    placed = Placed(stored["faces"], binding, tilt=stored.get("tilt"))
    more = {name[len(_MORE) :]: stored[name] for name in stored if name.startswith(_MORE)}
    return Solved(placed, report, bool(stored["settled"]), more)
