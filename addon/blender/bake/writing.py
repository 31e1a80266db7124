# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing a finished bake: its points, its keys, and the faces that it has seen."""

import bpy

from ...core.bake.baker import Baker
from ...core.bake.population import PopulationBaker
from ...core.surface.rest import at_rest
from ..base.all_or_nothing import all_or_nothing
from ..base.mesh_arrays import to_local
from ..scatter.key_writing import write_baked
from ..scatter.modifier import ensure_modifier, write_surface_inputs
from ..scatter.store import write_binding, write_scattered
from .start import Begun, frozen_in


def write_bake(obj: bpy.types.Object, begun: Begun, baker: Baker, kind: str) -> None:
    """Store what a baker has solved; what cannot be stored is found before anything is lost."""
    begun.note(baker.grounds.moving)
    rest = at_rest(baker.begin, baker.first_surface) if kind == "REST" else None
    born = baker.born() if isinstance(baker, PopulationBaker) else None
    if born is not None:
        to_local(obj, born.positions)  # where that cannot be, nothing is lost yet
    with all_or_nothing(bpy.context, [obj]):
        if begun.solved is not None:
            write_scattered(obj, baker.first_surface, begun.solved, rest)
        elif "REST" in (kind, obj.dapple.bound_to):
            write_binding(obj, baker.first_surface, baker.begin, rest)
        write_baked(obj, baker.baked(), baker.first, baker.report(), born, begun.sources)
        _write_known(obj, begun, baker)


def _write_known(obj: bpy.types.Object, begun: Begun, baker: Baker) -> None:
    """What a bake was solved from, and all faces that it has seen."""
    obj.dapple.bake_fingerprint = baker.fingerprint
    obj.dapple.baked_frozen = " ".join(frozen_in(begun, baker))
    known = dict.fromkeys([*obj.dapple.surface_topology.split(), *baker.topologies])
    obj.dapple.surface_topology = " ".join(known)
    write_surface_inputs(obj, ensure_modifier(obj))
