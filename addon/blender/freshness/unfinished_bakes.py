# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of the frames of unfinished bakes: their place, how they follow the .blend, their removal.

Those of NAME.blend are in NAME.dapple/SCATTER-KEY-START. KEY is stored with the scatter and
identifies it even if it or the file is renamed. START is a digest of the inputs of the bake, so
that frames of different settings are kept apart.
"""

import hashlib
import re
import secrets
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ...core.bake.sidecar import Sidecar, start_digest
from ...core.base.errors import ScatterError
from ...core.base.native import missing
from ...core.settings.values import Settings
from ...core.surface.records import ROW_ATTRIBUTES
from ..base.handlers import Evaluation, Subscriber
from ..base.translation import translated
from ..scatter.object import is_scatter, settings_of
from ..scatter.points import own_columns

_FOLDER = re.compile(r".*?-([0-9a-f]{8})(-[0-9a-f]{8})?")
_KEY = re.compile("[0-9a-f]{8}")
_Way = tuple[Settings, str, int]  # what a bake begins with besides the points
_START_COLUMNS = {**ROW_ATTRIBUTES, "id": "INT", "dapple_object_type": "INT"}


@dataclass
class _Known:
    """Values that are looked up only once, as the panel needs them at every redraw."""

    base: Path | None = None  # where the work files are, until the next saving
    edits: dict[int, int] = field(default_factory=dict)  # how often a scatter's points changed
    starts: dict[int, tuple[Any, str]] = field(default_factory=dict)
    counts: dict[int, tuple[Any, tuple[int, int]]] = field(default_factory=dict)


_known = _Known()


def work_files(obj: bpy.types.Object, first: int | None = None) -> Sidecar:
    """The sidecar of a bake that starts with the current scatter, at a given frame or that of the
    scene.
    """
    return _files_with_start(obj, _start(obj, _way(obj, first)))


def _files_with_start(obj: bpy.types.Object, start: str) -> Sidecar:
    key = _keys()[obj.session_uid]
    for folder in _folders(_base(), key):
        if folder.name.endswith(f"-{key}-{start}"):
            return Sidecar(folder)
    name = re.sub(r"[^\w.-]", "_", obj.name)
    return Sidecar(_base() / f"{name}-{key}-{start}")


def all_work_files(obj: bpy.types.Object) -> list[Sidecar]:
    """All files that bakes of a scatter have left."""
    key = _keys().get(obj.session_uid)
    return [] if key is None else [Sidecar(folder) for folder in _folders(_base(), key)]


def unfinished(obj: bpy.types.Object) -> int:
    """Number of solved frames from which Bake continues."""
    return _counted(obj)[0]


def left_over(obj: bpy.types.Object) -> int:
    """Number of solved frames that cannot be used with the current settings and points."""
    return _counted(obj)[1]


def finished_files(obj: bpy.types.Object) -> list[Sidecar]:
    """The work files of the bake that a scatter plays."""
    return [files for files in all_work_files(obj) if _is_finished(obj, files)]


def new_key() -> str:
    """A key for a new scatter."""
    return secrets.token_hex(4)


def unsaved_note() -> str:
    """A note for a file that was never saved; empty if it was."""
    if bpy.data.filepath:
        return ""
    return translated("Save the file to keep the frames of a stopped bake after Blender closes")


def _base() -> Path:
    if bpy.data.filepath:
        return Path(bpy.data.filepath).with_suffix(".dapple")
    return _temporary()


def _temporary() -> Path:
    """Folder for a file that was never saved."""
    return Path(bpy.app.tempdir) / "dapple"


def _folders(base: Path, key: str) -> list[Path]:
    """Folders with a key, independent of the name of the scatter."""
    return [path for path, own in _keyed(base) if own == key]


def _keyed(base: Path) -> Iterator[tuple[Path, str]]:
    """All folders of work files with their keys."""
    if base.is_dir():
        for path in sorted(base.iterdir()):
            found = _FOLDER.fullmatch(path.name)
            if found and path.is_dir():
                yield path, found[1]


def _keys() -> dict[int, str]:
    """Keys of the file's scatters, by session_uid; a copy does not have the key of its original."""
    keys: dict[int, str] = {}
    seen = set()
    for obj in filter(is_scatter, bpy.data.objects):  # by name: copies come later
        key = obj.dapple.bake_key
        if not _KEY.fullmatch(key):  # of an older version, or no name for a folder
            key = _digest(obj.name)
        key = _digest(key + obj.name) if key in seen else key
        seen.add(key)
        keys[obj.session_uid] = key
    return keys


def _digest(text: str) -> str:
    return hashlib.blake2b(text.encode(), digest_size=4).hexdigest()


def _way(obj: bpy.types.Object, first: int | None = None) -> _Way:
    first = bpy.context.scene.frame_start if first is None else first
    return settings_of(obj), _bake_method(obj), first


def _start(obj: bpy.types.Object, way: _Way) -> str:
    """Digest of settings and points; a scatter that cannot be baked has one that no bake has."""
    try:
        return start_digest(*way, own_columns(obj, _START_COLUMNS))
    except ScatterError:
        return _digest("")


def _known_start(obj: bpy.types.Object) -> str:
    """The same, computed again only if handlers have noticed changes of points."""
    way, edits = _way(obj), _known.edits.get(obj.session_uid, 0)
    token = (way, obj.data.session_uid, len(obj.data.vertices), edits)
    known = _known.starts.get(obj.session_uid)
    if known is None or known[0] != token:
        known = _known.starts[obj.session_uid] = token, _start(obj, way)
    return known[1]


def _bake_method(obj: bpy.types.Object) -> str:
    """The settings that determine how a frame depends on earlier ones."""
    settings = obj.dapple
    if settings.population == "KEEP_DENSITY":
        return f"{settings.population}-{settings.fade_duration}"
    return str(settings.smoothing)


def _counted(obj: bpy.types.Object) -> tuple[int, int]:
    """Numbers of frames from which Bake continues, and of other frames."""
    found = all_work_files(obj)
    if not found or missing():
        return 0, 0
    own = _files_with_start(obj, _known_start(obj)).folder
    times = tuple((files.folder.name, files.folder.stat().st_mtime_ns) for files in found)
    token = (own, obj.dapple.bake_fingerprint, times)
    known = _known.counts.get(obj.session_uid)
    if known is None or known[0] != token:
        known = _known.counts[obj.session_uid] = token, count_frames(obj, found, own)
    return known[1]


def count_frames(obj: bpy.types.Object, found: list[Sidecar], own: Path) -> tuple[int, int]:
    going_on = others = 0
    for files in found:
        if _is_finished(obj, files):
            continue
        if files.folder == own:
            going_on += files.frames()
        else:
            others += files.frames()
    return going_on, others


def _is_finished(obj: bpy.types.Object, files: Sidecar) -> bool:
    """Whether work files are those of the bake that a scatter plays."""
    settings = obj.dapple
    if not settings.bake_fingerprint:
        return False
    last = settings.baked_start + settings.baked_frames - 1
    return files.fingerprint(last) == settings.bake_fingerprint


def saved(path: str) -> None:
    """Move the work files with the file, and remove those of bakes that it contains."""
    if not bpy.data.filepath or Path(path) != Path(bpy.data.filepath):
        return  # a copy, or the startup file: the work files are still those of the open one
    before, _known.base = _known.base or _temporary(), _base()
    try:
        if before != _known.base:
            _move_from(before)
        for obj in filter(is_scatter, bpy.data.objects):
            _tidy(obj)
        _remove_unknown()
    except OSError as error:
        print(f"Dapple: work files in '{before}' could not be moved or removed: {error}")


def _move_from(source: Path) -> None:
    """Move the work files of the file's scatters to their current folder."""
    known = set(_keys().values())
    for folder, key in list(_keyed(source)):
        if key in known:
            Sidecar(folder).move(_base() / folder.name)


def _tidy(obj: bpy.types.Object) -> None:
    """Remove the files of a saved bake, and other files from which Bake would not continue."""
    found = all_work_files(obj)
    if not any(_is_finished(obj, files) for files in found):
        return
    own = work_files(obj)
    for files in found:
        if files != own or _is_finished(obj, files):
            files.clear()


def _remove_unknown() -> None:
    """Remove the work files of scatters that the saved file does not contain."""
    known = set(_keys().values())
    if bpy.data.filepath.endswith(".blend"):  # a backup has its work files in common
        for folder, key in list(_keyed(_base())):
            if key not in known:
                Sidecar(folder).clear()


def _loaded() -> None:
    """Find the work files of a file that was renamed while it was closed."""
    _forget()
    _known.base = _base()
    if not bpy.data.filepath or not _keys():
        return
    try:
        for folder in _base().parent.glob("*.dapple"):
            if folder != _base() and not folder.with_suffix(".blend").exists():
                _move_from(folder)
    except OSError as error:
        print(f"Dapple: work files beside '{bpy.data.filepath}' could not be moved: {error}")


def _forget() -> None:
    for cache in (_known.edits, _known.starts, _known.counts):
        cache.clear()


def _edited(evaluation: Evaluation) -> None:
    """Note scatters whose points may have changed."""
    for _, update in evaluation.objects():
        if update.geometry:
            _known.edits[update.uid] = _known.edits.get(update.uid, 0) + 1


SUBSCRIBER = Subscriber(
    updated=_edited, saved=saved, loaded=_loaded, undone=_forget, enabled=_loaded, disabled=_forget
)
