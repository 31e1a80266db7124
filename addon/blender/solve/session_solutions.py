# SPDX-License-Identifier: GPL-3.0-or-later
"""Solutions that are remembered during the session, to find what has changed since then.

They are stored by the digest of their points, so that they are found again after an undo. They are
not saved in files.
"""

from collections import OrderedDict

import bpy

from ...core.solve.carried_points import PreviousResult
from ...core.solve.incremental import as_placed
from ...core.solve.solve import Scattered, Solved
from ...core.surface.arrays import Ints, SurfaceArrays
from ...core.surface.records import POINT_ATTRIBUTES, ROW_ATTRIBUTES, Binding, Columns, binding_from
from ...core.surface.rest import AtRest
from ...core.surface.sources import Sources
from ..base.all_or_nothing import all_or_nothing
from ..base.handlers import Subscriber
from ..scatter.points import edited_places, own_columns, point_columns_of, points_digest
from ..scatter.store import write_binding, write_own_ids, write_scattered

_MOST = 4  # each needs much memory, for a surface with all its data

_known: OrderedDict[str, tuple[Solved, Ints]] = OrderedDict()  # with the ids of the points


def write_solved(
    obj: bpy.types.Object,
    arrays: SurfaceArrays,
    scattered: Scattered,
    rest: AtRest | None = None,
    sources: Sources | None = None,
) -> None:
    """Store a result, and remember its solution. The sources of the surface may be known."""
    with all_or_nothing(bpy.context, [obj]):
        write_scattered(obj, arrays, scattered, rest, sources)
    if scattered.solved is not None:
        _remember(obj.dapple.solved_points, scattered.solved, scattered.columns["id"])


def write_reattached(
    obj: bpy.types.Object,
    arrays: SurfaceArrays,
    binding: Binding,
    columns: Columns,
    rest: AtRest | None,
) -> None:
    """Store the binding of reattached points, with the result of columns_with_own_ids."""
    with all_or_nothing(bpy.context, [obj]):
        write_binding(obj, arrays, binding, rest)
        write_own_ids(obj, columns)


def known_as_placed(obj: bpy.types.Object, before: str, binding: Binding) -> None:
    """Keep a remembered solution after some of its points were placed by hand; `before` is the
    digest of the points as they were solved.
    """
    if before not in _known:
        return
    (solved, ids), columns = _known[before], point_columns_of(obj)
    if obj.dapple.surface_topology.split() != [solved.arrays.topology]:
        return
    placed = as_placed(solved, ids, binding, columns["id"], columns["dapple_object_type"])
    _remember(points_digest(obj), placed, columns["id"])


def _remember(points: str, solved: Solved, ids: Ints) -> None:
    _known[points] = solved, ids
    _known.move_to_end(points)
    while len(_known) > _MOST:
        _known.popitem(last=False)


def previous_result(obj: bpy.types.Object) -> PreviousResult:
    """The points of a scatter as they are stored, with their solution if it is remembered."""
    columns = own_columns(obj, {**POINT_ATTRIBUTES, "dapple_rank": "FLOAT"})
    binding = binding_from(own_columns(obj, ROW_ATTRIBUTES))
    solved, _ = _known.get(points_digest(obj), (None, None))
    return PreviousResult(binding, columns, solved, edited_places(obj))


def solved_arrays(obj: bpy.types.Object) -> SurfaceArrays | None:
    """The surface that the points of a scatter were solved on, if it is remembered."""
    solved, _ = _known.get(obj.dapple.solved_points, (None, None))
    return None if solved is None else solved.arrays


SUBSCRIBER = Subscriber(before_load=_known.clear, disabled=_known.clear)
