# SPDX-License-Identifier: GPL-3.0-or-later
"""The open file: its scatters, and saving it completely or not at all."""

import shutil
from contextlib import suppress
from pathlib import Path

import bpy

from ...core.base.atomic_file import part_of, remove_parts, replacing
from ...core.base.errors import ScatterError
from ...core.base.native import missing
from ..base.translation import english
from ..freshness.unfinished_bakes import finished_files, saved
from ..scatter.linked_data import is_in_view_layer, read_only
from ..scatter.object import is_scatter
from .arguments import Arguments

Stamp = tuple[int, int]


class Shot:
    """The open file at the start of the command."""

    def __init__(self, options: Arguments) -> None:
        self._check(options)
        self.path = Path(bpy.data.filepath)
        self.target = (options.output or self.path).absolute()
        self._stamp = _stamp(self.path)
        self.scatters = _chosen(options.scatters)

    def save(self) -> None:
        """Save the file; if that fails, the previous file stays."""
        if self.target == self.path and _stamp(self.path) != self._stamp:
            raise ScatterError(
                f"'{self.path}' was changed by another program meanwhile: it was not saved. Run "
                "the command again, or use --output"
            )
        try:
            with replacing(self.target.resolve(), part_of(self.target)) as part:
                bpy.ops.wm.save_as_mainfile(filepath=str(part), copy=True)
        except (OSError, RuntimeError) as error:
            text = (
                f"'{self.target}' could not be saved: {str(error).strip()}{self._disk_space_note()}"
            )
            raise ScatterError(text) from error
        remove_parts(self.target)
        self._tidy()

    def _disk_space_note(self) -> str:
        """The free space of the disk if it is small: Blender reports a full disk unclearly."""
        try:
            free = shutil.disk_usage(self.target.parent).free
            needed = self.path.stat().st_size
        except OSError:
            return ""
        return f" ({free / 1e6:.1f} MB are left on the disk)" if free < 2 * needed else ""

    def _tidy(self) -> None:
        """Remove the work files of bakes that are in the saved file."""
        if self.target == self.path:
            saved(str(self.path))
        else:
            for files in [files for obj in self.scatters for files in finished_files(obj)]:
                files.clear()

    @staticmethod
    def _check(options: Arguments) -> None:
        if missing():
            raise ScatterError(missing())
        if not bpy.data.filepath:
            raise ScatterError("No file is open: write 'blender -b FILE.blend --command dapple'")
        if bpy.context.mode != "OBJECT":
            raise ScatterError(
                f"'{bpy.data.filepath}' is not in Object Mode: save it in Object Mode"
            )
        for path in filter(None, (options.output, options.json)):
            if not path.absolute().parent.is_dir():
                raise ScatterError(f"'{path}': the folder does not exist")
            if path.is_dir():
                raise ScatterError(f"'{path}' is a folder")
        if options.output is not None and options.output.suffix != ".blend":
            raise ScatterError(f"'{options.output}' must end in .blend")


def _stamp(path: Path) -> Stamp | None:
    """Identifies the contents of a file; None if there is no file."""
    with suppress(OSError):
        found = path.stat()
        return found.st_mtime_ns, found.st_size
    return None


def _chosen(names: list[str]) -> list[bpy.types.Object]:
    """The scatters with these names; without names all writable ones of the scene."""
    there = {obj.name: obj for obj in filter(is_scatter, bpy.context.scene.objects)}
    for name in names:
        if name not in there:
            known = ", ".join(f"'{one}'" for one in sorted(there)) or "none"
            scene = bpy.context.scene.name
            raise ScatterError(f"There is no scatter '{name}'; those of '{scene}': {known}")
        if _trouble(there[name]):
            raise ScatterError(_trouble(there[name]))
    if names:
        return [there[name] for name in dict.fromkeys(names)]
    return [there[name] for name in sorted(there) if not _trouble(there[name])]


def _trouble(obj: bpy.types.Object) -> str:
    """Why a scatter cannot be processed."""
    if not is_in_view_layer(obj):
        layer = bpy.context.view_layer.name
        return f"Scatter '{obj.name}' is not in the view layer '{layer}'"
    return read_only(obj, english)
