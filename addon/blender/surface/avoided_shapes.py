# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of the instances of scatters that points avoid, on the current frame."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.export import LongInts
from ...core.surface.arrays import Floats
from ..base.mesh_arrays import matrix_of
from ..scatter.instance_shapes import InstanceShapes, shapes_of
from ..scatter.modifier import scatter_modifier
from ..scatter.object import is_scatter
from ..scatter.placed_objects import instanced_objects, instanced_vertices
from ..scatter.shown_instances import shown_for_now
from .mesh import evaluated, read_outline


@dataclass(frozen=True)
class KnownShapes:
    """Shapes that were read on an earlier frame."""

    state: bytes | None  # digest of all that they depend on; None: not known
    shapes: InstanceShapes
    ids: LongInts  # (k,) of all points that show meshes


def avoided_shapes(
    others: list[bpy.types.Object], shape: str, known: dict[int, KnownShapes]
) -> tuple[list[InstanceShapes], dict[int, LongInts]]:
    """Shapes of the instances of other scatters, and ids of their points that show meshes, by the
    scatters' session_uid; none if the points keep discs free. `known` has those of earlier frames:
    shapes that stand still are not read again.

    Raises:
        ScatterError: a scatter cannot be shown.
    """
    found, ids = [], {}
    for obj in others if shape != "DISC" else ():
        if is_scatter(obj) and len(obj.data.vertices):
            state, before = _state(obj), known.get(obj.session_uid)
            if before is None or state is None or before.state != state:
                before = KnownShapes(state, *read_shapes(obj, shape))
                known[obj.session_uid] = before
            found.append(before.shapes)
            ids[obj.session_uid] = before.ids
    return found, ids


def read_shapes(obj: bpy.types.Object, shape: str) -> tuple[InstanceShapes, LongInts]:
    """Shapes of the instances of a scatter, also of a hidden one, as shapes_of reads them."""
    with shown_for_now(obj):
        if not obj.visible_get():
            raise ScatterError(
                f"Scatter '{obj.name}' cannot be shown, so the shapes of its instances are not "
                "known: show it, or set Instances below Avoid Collection to Disc"
            )
        return shapes_of(obj, shape)


def _state(obj: bpy.types.Object) -> bytes | None:
    """Digest of what the instances of a scatter follow from frame to frame; None if they follow
    more than that: a bake, another modifier, animated settings, objects that are not plain.
    """
    animated = obj.animation_data is not None or obj.data.animation_data is not None
    if obj.dapple.surface is None or obj.dapple.baked_keys or animated:
        return None
    if _has_other_modifiers(obj) or not all(map(_is_plain, _instanced(obj))):
        return None
    digest = hashlib.blake2b(digest_size=16)
    for array in _followed(obj):
        digest.update(f"{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.digest()


def _has_other_modifiers(obj: bpy.types.Object) -> bool:
    own = scatter_modifier(obj)
    return any(modifier != own for modifier in obj.modifiers)


def _instanced(obj: bpy.types.Object) -> list[bpy.types.Object]:
    kinds = (obj.dapple, *obj.dapple.object_types)
    return [one for kind in kinds for one in instanced_objects(kind)]


def _is_plain(obj: bpy.types.Object) -> bool:
    """Whether an object shows its mesh and no instances of others."""
    if obj.type != "MESH" or obj.instance_type != "NONE":
        return False
    return all(modifier.type not in {"NODES", "PARTICLE_SYSTEM"} for modifier in obj.modifiers)


def _followed(obj: bpy.types.Object) -> Iterator[Floats]:
    """Numbers of all that the instances of a scatter follow, as they are on this frame."""
    scatter, depsgraph = obj.dapple, evaluated()
    lean = scatter.lean_object
    for other in (obj, scatter.surface, *((lean,) if lean is not None else ())):
        yield matrix_of(other.evaluated_get(depsgraph))
    yield read_outline(scatter.surface).vertices
    for kind in (scatter, *scatter.object_types):
        yield from instanced_vertices(kind, depsgraph)
