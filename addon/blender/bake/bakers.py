# SPDX-License-Identifier: GPL-3.0-or-later
"""The baker that the settings of a scatter ask for, from its first frame on."""

import bpy

from ...core.bake.baker import Baker, Start
from ...core.bake.keys import Keyframes
from ...core.bake.over_time import may_move
from ...core.bake.population import PopulationBaker
from ...core.bake.window_bake import TogetherBaker
from ...core.base.errors import ScatterError
from ...core.solve.solve import Scattered, nearest_binding
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.records import Binding, Columns, as_stored, check_ids
from ...core.surface.rest import with_distinct_parts
from ..freshness.unfinished_bakes import work_files
from ..scatter.object import follows_masks, settings_of
from ..scatter.points import places_of, point_columns_of
from ..surface.bound import current_binding, other_faces


def new_baker(
    obj: bpy.types.Object,
    surface: bpy.types.Object,
    arrays: SurfaceArrays,
    first: int,
    count: int,
    solved: Scattered | None,
) -> Baker:
    """A baker of so many frames; solved are the points if they were optimized anew."""
    rebind = obj.dapple.on_topology_change == "REBIND" or arrays.rest is not None
    if solved is not None:
        binding, columns = as_stored(solved.binding), solved.columns
    else:
        binding, columns = _binding(obj, surface, arrays)
    if arrays.rest is not None:
        arrays = with_distinct_parts(binding, arrays)
    start = Start(binding, columns["id"], columns["dapple_class"], settings_of(obj))
    keyframes = Keyframes(count, obj.dapple.key_every)
    smoothing, kept = obj.dapple.bake_smoothing, work_files(obj, first)
    follows = follows_masks(obj) and may_move(start.settings)
    fits = any(one.fit > 0.0 for one in (obj.dapple, *obj.dapple.classes))
    common = (arrays, start, keyframes, kept, first, rebind)
    if obj.dapple.count_over_time == "KEEP_DENSITY":
        fade = obj.dapple.fade_frames
        return PopulationBaker(*common, follows, fits, fade=fade)
    if smoothing == "FORWARD":
        return Baker(*common, follows, fits)
    return TogetherBaker(*common, fits=fits, closed=smoothing == "LOOP")


def _binding(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays
) -> tuple[Binding, Columns]:
    """The stored binding, or one to the places nearest to the points as they were optimized."""
    if obj.dapple.bound_to == "REST" or not other_faces(obj, arrays):
        return current_binding(obj, surface, arrays)
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return nearest_binding(places_of(obj), arrays), columns


def _check_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> None:
    reason = "" if obj.dapple.bound_to == "REST" else other_faces(obj, arrays)
    if reason and obj.dapple.on_topology_change != "REBIND":
        raise ScatterError(
            f"Scatter '{obj.name}' is out of date: {reason}. Optimize the scatter first, or "
            "set New Topology to Reattach"
        )
