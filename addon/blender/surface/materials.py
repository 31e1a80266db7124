# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of a surface: which there are, and which faces have those that were chosen."""

from collections.abc import Iterable

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.settings.values import MATERIAL
from ...core.surface.mesh_snapshot import RawValues
from .joined import parts_of


def surface_materials(
    surface: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> list[bpy.types.Material]:
    """Those of the objects that a surface consists of, then those that modifiers add."""
    slots = [slot.material for part in parts_of(surface) for slot in part.material_slots]
    evaluated = surface.evaluated_get(depsgraph)
    made = getattr(evaluated.data, "materials", ()) if evaluated.is_evaluated else ()
    slots += [one.original for one in made if one is not None]
    return list(dict.fromkeys(one for one in slots if one is not None))


def read_materials(obj: bpy.types.Object, mesh: bpy.types.Mesh, names: Iterable[str]) -> RawValues:
    """Of each face of the evaluated mesh of an object, whether it has one of these materials.

    Raises:
        ScatterError: the surface has none of them.
    """
    wanted, slots = set(names), _slots(obj, mesh)
    chosen = np.array([one in wanted for one in slots] or [False], dtype=np.float32)
    if not chosen.any():
        listed = ", ".join(f"'{name}'" for name in names)
        raise ScatterError(
            f"Surface '{obj.name}' has none of the materials that the mask Material asks for: "
            f"{listed}"
        )
    indices = np.zeros(len(mesh.polygons), dtype=np.int32)
    stored = mesh.attributes.get(MATERIAL)
    if stored is not None and stored.domain == "FACE" and len(indices):
        stored.data.foreach_get("value", indices)
    return RawValues(MATERIAL, "FACE", chosen[np.clip(indices, 0, len(chosen) - 1)])


def _slots(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> list[str]:
    """Full names of the materials that faces have by their indices; "" of empty slots.

    A slot of the object takes the place of the same one of its mesh, as in renders.
    """
    found = [one.original if one is not None else None for one in mesh.materials]
    for k, slot in enumerate(obj.material_slots[: len(found)]):
        if slot.link == "OBJECT":
            found[k] = slot.material
    return [one.name_full if one is not None else "" for one in found]
