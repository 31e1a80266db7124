# SPDX-License-Identifier: GPL-3.0-or-later
"""Add: a new scatter over a surface, with the settings of the Default preset that fit there."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy

from ...core.base.errors import ChangedError, ScatterError
from ...core.base.steps import Steps, Task
from ...core.density.hidden import share_in_parts
from ...core.settings.presets import Values, settings_with
from ...core.solve.solve import Scattered, scatter
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.rest import AtRest
from ..base.object_handles import ObjectHandle
from ..freshness.unfinished_bakes import new_key
from ..presets.fit import fallbacks, first_values, left_out_note
from ..presets.stored import apply
from ..scatter.store import new_scatter
from ..solve.session_solutions import write_solved
from ..surface.current_binding import rest_of
from ..surface.joined_parts import parts_of
from ..surface.joined_surface import home_of, surface_over
from ..surface.reading import as_read, read
from ..surface.rest_position import kind_of_binding, rest_position, rest_position_kept


@dataclass(frozen=True)
class Added:
    """The result of Add."""

    obj: bpy.types.Object
    note: str  # skipped settings of the Default preset, and why; empty if none
    hidden: float  # share of the surface for which Outside Only was turned on; 0 if it was not


@dataclass(frozen=True)
class _Solved:
    values: Values
    hidden: float  # see Added
    arrays: SurfaceArrays
    scattered: Scattered
    rest: AtRest | None


def add_steps(
    context: bpy.types.Context, collection: bpy.types.Collection | None = None, **chosen: Any
) -> Steps:
    """Scatter over the selected objects or a collection; returns Added.

    Settings that are not given (count, seed, attach_to) are those of the Default preset, as far as
    they fit.
    """
    with surface_over(context, collection) as surface, rest_position_kept(surface):
        values, note = first_values(surface.get(), context)
        solved, left_out = yield from _as_far_as_it_fits(surface, values, chosen)
        with _new(surface.get()) as obj:
            obj.dapple.bake_key = new_key()
            apply(obj, solved.values)
            write_solved(obj, solved.arrays, solved.scattered, solved.rest)
    return Added(obj, left_out or note, solved.hidden)


def _as_far_as_it_fits(surface: ObjectHandle, preset: Values, chosen: dict[str, Any]) -> Any:
    """The first solution with fewer and fewer settings of the preset, and a note of the skipped
    ones.
    """
    first: ScatterError | None = None
    for values, left_out in fallbacks(preset, chosen):
        try:
            solved = yield from _solved(surface, _with_chosen(values, chosen))
        except ChangedError:
            raise
        except ScatterError as error:
            first = first or error
            if not values:
                raise
        else:
            return solved, left_out and left_out_note(f"{left_out} ({first})")
    raise AssertionError("without a preset the error is raised")


def _with_chosen(values: Values, chosen: dict[str, Any]) -> Values:
    own = {**values.get("", {}), **chosen}
    if "count" in chosen:
        own["amount"] = "COUNT"
    return {**values, "": own}


def _solved(surface: ObjectHandle, values: Values) -> Any:
    settings = settings_with(values)
    kind = kind_of_binding(surface.get(), bpy.context, values[""].get("attach_to", "AUTO"))
    arrays = read(surface.get(), settings)
    several = len(parts_of(surface.get())) > 1
    values, hidden, found = yield Task(lambda worker: _scattered(values, arrays, several, worker))
    settings = settings_with(values)
    with as_read(arrays, surface, settings), rest_position(surface, kind):
        rest = rest_of(surface.get(), arrays, found.binding, kind)
    return _Solved(values, hidden, arrays, found, rest)


def _scattered(
    values: Values, arrays: SurfaceArrays, several: bool, worker: Any
) -> tuple[Values, float, Scattered]:
    """The values, with Outside Only if parts are hidden and no preset decides otherwise; the share
    that is hidden, see Added; and the points.
    """
    density, hidden = values.get("density", {}), 0.0
    if "use_outside" not in density and (hidden := share_in_parts(arrays, several)):
        values = {**values, "density": {**density, "use_outside": True}}
    return values, hidden, scatter(arrays, settings_with(values), worker)


@contextmanager
def _new(surface: bpy.types.Object) -> Iterator[bpy.types.Object]:
    """A new scatter object, which is removed if the code inside fails."""
    groups = set(bpy.data.node_groups)
    obj = new_scatter(surface, *home_of(surface, bpy.context))
    try:
        yield obj
    except BaseException:
        bpy.data.meshes.remove(obj.data)  # and the object with it
        bpy.data.batch_remove(set(bpy.data.node_groups) - groups)
        raise
