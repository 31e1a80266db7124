# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of scatters as renders show them, read from the scene frame by frame."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.export import Exported, Placed
from ..base.mesh_arrays import read_columns
from ..base.quiet import quiet

_NO_ID = 2**31 - 1  # fills up persistent ids
_SHOWN = {"display_as": "INSTANCES", "viewport_share": 1.0, "detail_in_viewport": False}
Key = tuple[
    int, int
]  # of an instanced mesh: session_uid, and object type if it is a shape of the scatter


@dataclass
class _Rows:
    """Instances of a scatter on one frame."""

    matrices: list[Any] = field(default_factory=list)
    ids: list[int] = field(default_factory=list)
    prototypes: list[int] = field(default_factory=list)


@dataclass
class Collector:
    """Reads scatters frame by frame.

    exported: instances, in the order of the scatters.

    of_mesh: what is kept of an instanced mesh; takes the evaluated object and a name.

    meshes: what is kept of them, copies by default: a list for each scatter, in the order of its
    objects.

    left_out: names of objects that are not meshes.
    """

    scatters: Sequence[bpy.types.Object]
    of_mesh: Callable[[bpy.types.Object, str], Any] = field(default_factory=lambda: _copied)
    exported: list[Exported] = field(init=False)
    meshes: list[list[Any]] = field(init=False)
    left_out: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.exported = [Exported(obj.name) for obj in self.scatters]
        self.meshes = [[] for _ in self.scatters]
        self._keys: list[dict[Key, int]] = [{} for _ in self.scatters]
        self._classes = [_classes_of(obj) for obj in self.scatters]

    def read(self) -> None:
        """Read the current frame."""
        numbers = {obj.session_uid: k for k, obj in enumerate(self.scatters)}
        rows = [_Rows() for _ in self.scatters]
        for one in bpy.context.evaluated_depsgraph_get().object_instances:
            if one.is_instance and one.parent is not None:
                k = numbers.get(one.parent.original.session_uid)
                if k is not None:
                    self._take(k, one, rows[k])
        for k, found in enumerate(rows):
            self.exported[k].frames.append(self._placed(k, found))

    def check(self) -> None:
        """ScatterError if a scatter has no instance on any frame."""
        for obj, found in zip(self.scatters, self.exported, strict=True):
            check_shown(obj, any(len(frame.ids) for frame in found.frames))

    def free(self) -> None:
        """Remove the copies."""
        for mesh in [mesh for meshes in self.meshes for mesh in meshes]:
            bpy.data.meshes.remove(mesh)
        self.meshes = [[] for _ in self.scatters]

    def _take(self, k: int, one: Any, rows: _Rows) -> None:
        if one.object.type != "MESH":
            self.left_out.add(one.object.name)
            return
        number = next(number for number in reversed(one.persistent_id) if number != _NO_ID)
        rows.matrices.append(np.array(one.matrix_world))
        rows.ids.append(number)
        rows.prototypes.append(self._prototype(k, one, self._classes[k].get(number, 0)))

    def _prototype(self, k: int, one: Any, kind: int) -> int:
        """Index of an instanced mesh; a shape of the node group itself has one per object type."""
        original = one.object.original
        own = original == self.scatters[k]
        key = (original.session_uid, kind if own else -1)
        if key not in self._keys[k]:
            self._keys[k][key] = len(self._keys[k])
            name = f"{original.name} Cone" if own else original.name
            self.exported[k].objects.append(name)
            self.meshes[k].append(self.of_mesh(one.object, name))
        return self._keys[k][key]

    def _placed(self, k: int, rows: _Rows) -> Placed:
        classes = self._classes[k]
        return Placed(
            np.array(rows.matrices, np.float64).reshape(-1, 4, 4),
            np.array(rows.ids, np.int64),
            np.array([classes.get(number, 0) for number in rows.ids], np.int32),
            np.array(rows.prototypes, np.int32),
        )


def check_shown(obj: bpy.types.Object, shows_some: bool) -> None:
    """ScatterError unless a scatter shows instances."""
    if not shows_some:
        hidden = not obj.visible_get()
        why = "it is hidden in the viewport" if hidden else "optimize it first"
        raise ScatterError(f"Scatter '{obj.name}' shows no instances: {why}")


def _copied(obj: bpy.types.Object, name: str) -> bpy.types.Mesh:
    """A copy of a mesh with the materials that the object shows."""
    mesh = obj.data.copy()
    mesh.name = name
    mesh.materials.clear()
    for slot in obj.material_slots:
        mesh.materials.append(slot.material.original if slot.material else None)
    return mesh


def _classes_of(obj: bpy.types.Object) -> dict[int, int]:
    """The object type of each id."""
    found = read_columns(obj.data, {"id": "INT", "dapple_object_type": "INT"})
    return dict(zip(found["id"].tolist(), found["dapple_object_type"].tolist(), strict=True))


@contextmanager
def as_rendered(scatters: Sequence[bpy.types.Object]) -> Iterator[None]:
    """Show all instances of the scatters, including those that the viewport leaves out."""
    with quiet(), ExitStack() as back:
        for obj in scatters:
            for name, value in _SHOWN.items():
                before = getattr(obj.dapple, name)
                if before != value:
                    setattr(obj.dapple, name, value)
                    back.callback(setattr, obj.dapple, name, before)
        yield


@contextmanager
def shown_for_now(obj: bpy.types.Object) -> Iterator[None]:
    """Show a scatter in the view layer, however it is hidden, so that its instances are there."""
    root = bpy.context.scene.collection.objects
    with quiet(), ExitStack() as back:
        if obj.hide_viewport:
            obj.hide_viewport = False
            back.callback(setattr, obj, "hide_viewport", True)
        if not obj.visible_get() and obj.name not in root:
            root.link(obj)  # a collection may hide it
            back.callback(root.unlink, obj)
        if obj.hide_get():
            obj.hide_set(False)
            back.callback(obj.hide_set, True)
        yield
