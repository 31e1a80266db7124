# SPDX-License-Identifier: GPL-3.0-or-later
"""Unfinished bakes: one file for each solved frame, so that a stopped bake can continue.

Frames that are solved in pieces have a second file if they overlap the next piece: window_bake.py.
A file is an npz of plain arrays (docs/bake.md lists them). It is written under another name,
flushed to the disk and renamed, so it is either complete or missing. Its fingerprint covers all
inputs of the frame, its digest the content and the number of the frame; a file that is damaged,
modified, swapped or made from other inputs is ignored.
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
_MORE = "more_"  # prefix of the names of a population's arrays


@dataclass(frozen=True)
class Solved:
    """The tracker's result for one frame, in full precision."""

    placed: Placed
    report: Report
    settled: bool = False  # dapple.Tracker.settled, needed to continue
    more: Columns = field(default_factory=dict)  # existing points and state of a population


class Fingerprint:
    """Digest of all inputs of a frame: version, settings, start, every frame so far."""

    def __init__(self, settings: Settings, start: Binding, arrays: Iterable[Any]) -> None:
        version = package().__version__
        head = json.dumps([FORMAT, version, asdict(settings)], sort_keys=True)
        self._digest = hashlib.blake2b(head.encode(), digest_size=16)
        for array in (start.corners, start.barycentric, start.angle, *arrays):
            self._add(array)

    def note(self, text: str) -> None:
        """Add another input of all frames."""
        self._digest.update(text.encode())

    def note_array(self, array: Any) -> None:
        """The same for arrays."""
        self._add(array)

    def add(self, frame: SurfaceArrays) -> str:
        """The fingerprint including one more frame."""
        self._digest.update(frame.topology.encode())
        self._add(frame.vertices)
        if frame.normals is not None:
            self._add(frame.normals)
        if frame.rest is not None:
            self._add(frame.rest)
        return self.now()

    def now(self) -> str:
        """The fingerprint of everything added so far."""
        return self._digest.copy().hexdigest()

    def _add(self, array: Any) -> None:
        values = np.ascontiguousarray(array)
        self._digest.update(f"{values.dtype.str}{values.shape}".encode())
        self._digest.update(values.tobytes())


def start_digest(settings: Settings, way: str, first: int, columns: Columns) -> str:
    """Short digest of a bake's start: settings, kind of bake, first frame, points."""
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
        """The frame if it was solved from the same input.

        It must have this number of points, if given, on a surface with these faces.
        """
        try:
            with np.load(self.path(frame, ahead=ahead), allow_pickle=False) as stored:
                if str(stored["fingerprint"]) != fingerprint:
                    return None
                arrays = {name: stored[name] for name in stored.files}
            if str(arrays.pop("digest")) != _digest(self.path(frame, ahead=ahead), arrays):
                return None
            return _checked(arrays, points, surface)
        except Exception:  # numpy and zipfile raise various errors for damaged files
            return None

    def fingerprint(self, frame: int) -> str:
        """Fingerprint of a frame's file; empty if there is none."""
        try:
            with np.load(self.path(frame), allow_pickle=False) as stored:
                return str(stored["fingerprint"])
        except Exception:  # whatever broken bytes make numpy and zipfile raise
            return ""

    def store(self, frame: int, fingerprint: str, solved: Solved, *, ahead: bool = False) -> None:
        """Write a frame to the disk; OSError if that fails."""
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
        """Number of files of finished frames, whatever they contain."""
        return len(list(self.folder.glob("frame_*.npz")))

    def move(self, folder: Path) -> None:
        """Move the frames to another folder and overwrite existing ones; OSError if that fails."""
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(path for one in _OURS for path in self.folder.glob(one + ".npz")):
            shutil.move(path, folder / path.name)
        self.clear()

    def clear(self) -> None:
        """Remove the frames and the remains of killed processes; other files stay."""
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
    """Digest of a file's arrays and of its name, which contains the frame."""
    digest = hashlib.blake2b(path.stem.encode(), digest_size=16)
    for name, array in sorted(arrays.items()):
        values = np.ascontiguousarray(array)
        digest.update(f"{name} {values.dtype.str}{values.shape}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()


def _checked(stored: dict[str, Any], points: int | None, surface: SurfaceArrays) -> Solved:
    """The stored frame; ValueError if its arrays are not valid."""
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
