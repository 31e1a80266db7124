# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing results into the file: the scatter object and its baked keys."""

from collections.abc import Container
from typing import Any

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.errors import ScatterError
from ..core.keys import Baked, wrong_index
from ..core.locked import Locked
from ..core.population import Born
from ..core.records import (
    ADDED_ATTRIBUTES,
    FRAME_ATTRIBUTES,
    GONE_ATTRIBUTES,
    KEY_ATTRIBUTES,
    LEAN_ATTRIBUTES,
    POINT_ATTRIBUTES,
    REST_ATTRIBUTES,
    REST_TRIANGLE_ATTRIBUTES,
    ROW_ATTRIBUTES,
    SCHEMA,
    SCHEMA_KEY,
    TRIANGLE_ATTRIBUTES,
    Binding,
    Columns,
    binding_from,
    check_binding,
    check_columns,
    check_ids,
    repeated,
    unbound,
)
from ..core.rest import AtRest
from ..core.solve import Report, Scattered, with_own_ids
from ..core.sources import Sources, digest_of, on_other_faces, sources_from, sources_of
from ..core.stale import settings_text
from ..core.surface import Floats, Ints, SurfaceArrays
from ..nodes import (
    GROUP_NAME,
    INPUTS,
    KEPT_SINCE,
    ensure_group,
    get_input,
    has_input,
    is_current,
    set_input,
    version_of,
)
from .library import own_mesh
from .meshio import read_columns, read_points, to_local, to_world, write_columns, write_points
from .scatter import (
    bake_settings_of,
    copy_report,
    is_fluid,
    scatter_modifier,
    write_instance_inputs,
    write_report,
    write_warning,
)

# What check_binding looks at, which knows points that were added by hand, and the surface.
_BOUND = {"dapple_v0", "dapple_v1", "dapple_v2", "dapple_barycentric"}
_STORES = ("Keys", "Triangles", "Frames")  # inputs of the node group that hold a bake


def new_scatter(surface: bpy.types.Object, collection: bpy.types.Collection) -> bpy.types.Object:
    """Empty scatter object on a surface."""
    name = f"{surface.name} Scatter"
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    obj.data[SCHEMA_KEY] = SCHEMA
    collection.objects.link(obj)
    obj.dapple.surface = surface
    ensure_modifier(obj)
    return obj


def ensure_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier:
    """The modifier with the group of this version; keys of an older one were cleared."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        modifier = obj.modifiers.new(GROUP_NAME, "NODES")
    # One that is linked may stay: an override keeps only what it changes in the linked modifier.
    if not is_current(modifier.node_group, len(obj.dapple.classes)):
        before = _inputs(modifier)
        modifier.node_group = ensure_group(len(obj.dapple.classes))
        for name, value in before.items():
            if has_input(modifier, name):
                set_input(modifier, name, value)
        write_surface_inputs(obj, modifier)
        write_instance_inputs(obj)
    return modifier


def _inputs(modifier: bpy.types.NodesModifier) -> dict[str, Any]:
    """What a node group for another number of classes is told, by name; none of old versions."""
    if version_of(modifier.node_group) < KEPT_SINCE:
        return {}
    names = [name for name, kind in INPUTS if kind != "NodeSocketGeometry"]
    return {name: get_input(modifier, name) for name in names if has_input(modifier, name)}


def write_surface_inputs(obj: bpy.types.Object, modifier: bpy.types.NodesModifier) -> None:
    """Tell the node group what the points are bound to."""
    set_input(modifier, "Surface", obj.dapple.surface)
    set_input(modifier, "Surface Vertices", obj.dapple.surface_vertices)
    set_input(modifier, "Rest Binding", obj.dapple.bound_to == "REST")
    set_input(modifier, "Rest Parts", obj.dapple.bound_parts)
    set_input(modifier, "Rest Vertices", _rest_vertices(obj))
    set_input(modifier, "Spacing", obj.dapple.report.spacing)


def _rest_vertices(obj: bpy.types.Object) -> int:
    """Vertices of the surface on which faces are played, which is faster, and the same; 0: none.

    Where the artist chose the rest position, modifiers may make other faces of as many vertices.
    """
    surface, topologies = obj.dapple.surface, obj.dapple.surface_topology.split()
    by_itself = obj.dapple.bind_to == "AUTO" and surface is not None and not is_fluid(surface)
    return obj.dapple.surface_vertices if by_itself and len(topologies) == 1 else 0


def write_scattered(
    obj: bpy.types.Object, arrays: SurfaceArrays, solved: Scattered, rest: AtRest | None = None
) -> None:
    """Store a result: points, bindings, figures. Keys of an older result go."""
    places = to_local(obj, solved.positions)
    clear_keys(obj)
    mesh = own_mesh(obj)
    write_points(mesh, places)
    write_columns(mesh, solved.columns, {**POINT_ATTRIBUTES, **ADDED_ATTRIBUTES})
    mesh[SCHEMA_KEY] = SCHEMA
    obj.dapple.solved_settings = settings_text(solved.settings)
    obj.dapple.solved_from = sources_of(arrays, solved.settings, solved.mass).text()
    obj.dapple.locked_count = int(solved.columns["dapple_locked"].sum())
    write_report(obj, solved.report)
    obj.dapple.report.details = solved.details.text()
    write_binding(obj, arrays, solved.binding, rest)
    write_warning(obj)


def write_binding(
    obj: bpy.types.Object, arrays: SurfaceArrays, binding: Binding, rest: AtRest | None = None
) -> None:
    """Store where the points sit on a surface, or on its rest shape. Keys of an older one go."""
    clear_keys(obj)
    write_columns(own_mesh(obj), binding.rows(), ROW_ATTRIBUTES)
    if rest is not None:
        write_columns(obj.data, rest.columns, REST_ATTRIBUTES)
        obj.dapple.bound_parts = rest.parts
    obj.dapple.bound_to = "FACES" if rest is None else "REST"
    obj.dapple.surface_vertices = len(arrays.vertices)
    obj.dapple.surface_topology = arrays.topology
    obj.dapple.solved_from = _on_faces(obj.dapple.solved_from, arrays)
    obj.dapple.solved_points = points_digest(obj)
    write_surface_inputs(obj, ensure_modifier(obj))
    write_instance_inputs(obj)


def _on_faces(stored: str, arrays: SurfaceArrays) -> str:
    """What a solution was solved from; once it is bound to other faces, in their shape."""
    before = sources_from(stored)
    if before is None or before.exact.get("faces") == arrays.topology:
        return stored
    return on_other_faces(before, arrays).text()


def points_digest(obj: bpy.types.Object) -> str:
    """Digest of the points as they are stored and bound, without added points."""
    types = {"position": "FLOAT_VECTOR", **ROW_ATTRIBUTES, "id": "INT", "dapple_class": "INT"}
    return digest_of(own_columns(obj, types).values())


def read_binding(obj: bpy.types.Object, vertex_count: int) -> tuple[Binding, Columns]:
    """Stored binding and point columns, checked against the surface; without added points."""
    binding = binding_from(own_columns(obj, ROW_ATTRIBUTES))
    check_binding(binding, vertex_count, obj.name)
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return binding, columns


def read_at_rest(obj: bpy.types.Object) -> AtRest:
    """Where the points are on the rest shape; older files know no parts of it."""
    types = dict(REST_ATTRIBUTES)
    if "dapple_part" not in obj.data.attributes:
        del types["dapple_part"]
    columns = {"dapple_part": np.zeros(int(own_points(obj).sum()), np.int32)}
    return AtRest({**columns, **own_columns(obj, types)}, obj.dapple.bound_parts)


def columns_with_own_ids(obj: bpy.types.Object) -> Columns:
    """Point columns without added points; those that an artist added or copied have new ids."""
    ranked = "dapple_rank" in obj.data.attributes
    types = {**POINT_ATTRIBUTES, "dapple_rank": "FLOAT"} if ranked else POINT_ATTRIBUTES
    columns = own_columns(obj, types)
    new = unbound(binding_from(own_columns(obj, ROW_ATTRIBUTES))) | repeated(columns["id"])
    return with_own_ids(columns, new, obj.dapple.seed)


def write_own_ids(obj: bpy.types.Object, columns: Columns) -> None:
    """Store what columns_with_own_ids told; keys were cleared."""
    types = {**POINT_ATTRIBUTES, **ADDED_ATTRIBUTES}
    write_columns(own_mesh(obj), columns, {name: types[name] for name in columns})
    obj.dapple.report.count = len(columns["id"])
    obj.dapple.solved_points = points_digest(obj)


def point_columns_of(obj: bpy.types.Object) -> Columns:
    """Point columns without added points."""
    return own_columns(obj, POINT_ATTRIBUTES)


def locked_points(obj: bpy.types.Object) -> Locked | None:
    """Points that stay where they are, as they lie in the file; None if there are none."""
    if "dapple_locked" not in obj.data.attributes:
        return None
    kept = read_columns(obj.data, {"dapple_locked": "BOOLEAN"})["dapple_locked"] & own_points(obj)
    if not kept.any():
        return None
    types = {"id": "INT", "dapple_class": "INT", "position": "FLOAT_VECTOR"}
    columns = {name: values[kept] for name, values in read_columns(obj.data, types).items()}
    check_columns(columns, obj.name)
    places = to_world(obj, read_points(obj.data)[kept])
    return Locked(places, columns["id"], columns["dapple_class"])


def places_of(obj: bpy.types.Object) -> Floats:
    """Stored positions (n, 3) in world space, without added points."""
    places = read_points(obj.data)[own_points(obj)]
    check_columns({"position": places}, obj.name)
    return to_world(obj, places)


def own_columns(obj: bpy.types.Object, types: dict[str, str]) -> Columns:
    """Columns of the points without those that a bake has added."""
    own = own_points(obj)
    found = {name: values[own] for name, values in read_columns(obj.data, types).items()}
    check_columns({name: one for name, one in found.items() if name not in _BOUND}, obj.name)
    return found


def own_points(obj: bpy.types.Object) -> NDArray[np.bool_]:
    """Per point whether it was optimized, not added by a bake with births."""
    if "dapple_gone" not in obj.data.attributes:
        return np.ones(len(obj.data.vertices), dtype=bool)
    return read_columns(obj.data, GONE_ATTRIBUTES)["dapple_gone"] < 0.5


def _add_points(obj: bpy.types.Object, born: Born) -> None:
    mesh, count = own_mesh(obj), len(obj.data.vertices)
    added = {name: kind for name, kind in ADDED_ATTRIBUTES.items() if name in mesh.attributes}
    types = {**ROW_ATTRIBUTES, **POINT_ATTRIBUTES, **added}
    before = read_columns(mesh, types)
    mesh.vertices.add(len(born.positions))
    places = np.concatenate([read_points(mesh)[:count], to_local(obj, born.positions)])
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    after = {**born.binding.rows(), **born.columns}
    joined = {name: np.concatenate([values, after[name]]) for name, values in before.items()}
    joined["dapple_gone"] = np.repeat([0.0, 1.0], [count, len(born.positions)])
    write_columns(mesh, joined, {**types, **GONE_ATTRIBUTES})
    mesh.update()


def _drop_added(obj: bpy.types.Object) -> None:
    own = own_points(obj)
    if own.all():
        return
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    edited.verts.ensure_lookup_table()
    added = [edited.verts[k] for k in np.flatnonzero(~own)]
    bmesh.ops.delete(edited, geom=added, context="VERTS")
    edited.to_mesh(own_mesh(obj))
    edited.free()
    obj.dapple.locked_count = _count_locked(obj)


def _count_locked(obj: bpy.types.Object) -> int:
    if "dapple_locked" not in obj.data.attributes:
        return 0
    return int(read_columns(obj.data, {"dapple_locked": "BOOLEAN"})["dapple_locked"].sum())


def write_baked(
    obj: bpy.types.Object,
    baked: Baked,
    start: int,
    report: Report,
    born: Born | None = None,
    begun: Sources | None = None,
) -> None:
    """Store baked keys, the first frame of the bake being start, and the points they add.

    Begun is what the first frame was solved from.
    """
    clear_keys(obj)
    if born is not None:
        _add_points(obj, born)
    modifier = ensure_modifier(obj)
    places = baked.keys["position"]
    types = KEY_ATTRIBUTES
    if "dapple_gone" in baked.keys:
        types = {**types, **GONE_ATTRIBUTES}
    if "dapple_lean" in baked.keys:
        types = {**types, **LEAN_ATTRIBUTES}
    set_input(modifier, "Keys", _stored(obj, "Keys", baked.keys, types, places))
    for name, columns, types in (
        ("Triangles", baked.triangles, _triangle_types(baked.triangles)),
        ("Frames", baked.frames, FRAME_ATTRIBUTES),
    ):
        set_input(modifier, name, _stored(obj, name, columns, types))
    set_input(modifier, "Key Points", len(obj.data.vertices))
    set_input(modifier, "First Frame", start)
    obj.dapple.baked_start, obj.dapple.baked_frames = start, baked.frame_count
    obj.dapple.baked_keys = len(places) // max(len(obj.data.vertices), 1)
    obj.dapple.baked_settings = settings_text(bake_settings_of(obj))
    obj.dapple.baked_from = begun.text() if begun else ""
    write_surface_inputs(obj, modifier)
    copy_report(obj.dapple.report, obj.dapple.solved)
    write_report(obj, report)
    write_warning(obj)
    obj.update_tag()


def _triangle_types(there: Container[str]) -> dict[str, str]:
    types = {**TRIANGLE_ATTRIBUTES, **REST_TRIANGLE_ATTRIBUTES}
    return {name: kind for name, kind in types.items() if name in there}


def _stored(
    obj: bpy.types.Object,
    name: str,
    columns: Columns,
    types: dict[str, str],
    places: Floats | None = None,
) -> bpy.types.Object:
    """Object outside every scene, whose points store columns."""
    label = f"{obj.name} {name}"
    store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
    count = len(columns[next(iter(types))])
    write_points(store.data, np.zeros((count, 3)) if places is None else places)
    write_columns(store.data, columns, types)
    return store


def stored_object(obj: bpy.types.Object, name: str) -> bpy.types.Object:
    """The object that holds a baked scatter's Keys, Triangles or Frames; ScatterError if none."""
    modifier = scatter_modifier(obj)
    found = get_input(modifier, name) if modifier and has_input(modifier, name) else None
    if found is None:
        raise ScatterError(f"Scatter '{obj.name}' has no baked {name}: bake again")
    if not isinstance(found, bpy.types.Object) or found.type != "MESH":
        kind = getattr(found, "type", "number").lower()
        raise ScatterError(
            f"{name} '{getattr(found, 'name', found)}' of '{obj.name}' is a {kind}, not a mesh: "
            "bake again"
        )
    return found


def key_tables(obj: bpy.types.Object) -> tuple[Ints, Columns, Columns, int]:
    """Of a bake: the triangle of each row, the triangles, the frames; and the points of a key."""
    keys, triangles, frames = (stored_object(obj, name).data for name in _STORES)
    return (
        read_columns(keys, KEY_ATTRIBUTES)["dapple_face"],
        read_columns(triangles, TRIANGLE_ATTRIBUTES),
        read_columns(frames, FRAME_ATTRIBUTES),
        key_points(obj),
    )


def check_keys(obj: bpy.types.Object) -> None:
    """ScatterError if a bake points to what is not there."""
    wrong = wrong_index(*key_tables(obj))
    if wrong:
        raise ScatterError(f"Scatter '{obj.name}': the keyframes are damaged ({wrong}): bake again")


def key_points(obj: bpy.types.Object) -> int:
    """Points of each key; ScatterError where that is no number."""
    modifier = scatter_modifier(obj)
    there = modifier is not None and has_input(modifier, "Key Points")
    found = get_input(modifier, "Key Points") if there else None
    if not isinstance(found, int) or found < 0:
        raise ScatterError(
            f"Scatter '{obj.name}' does not know the number of its points: bake again"
        )
    return found


def stores_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects that hold a bake, as far as they are there."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return []
    found = (get_input(modifier, name) for name in _STORES if has_input(modifier, name))
    return [store for store in found if isinstance(store, bpy.types.Object)]


def read_baked(obj: bpy.types.Object) -> Baked:
    """The keys of a baked scatter."""
    keys, triangles, frames = (stored_object(obj, name).data for name in _STORES)
    return Baked(
        read_columns(keys, {**KEY_ATTRIBUTES, "position": "FLOAT_VECTOR"}),
        read_columns(triangles, _triangle_types(triangles.attributes)),
        read_columns(frames, FRAME_ATTRIBUTES),
    )


def clear_keys(obj: bpy.types.Object) -> None:
    """Forget baked keys and the points they added.

    The others stick to the surface where they were optimized, with the figures that they had.
    """
    _drop_added(obj)
    if obj.dapple.baked_keys:
        _write_solved_report(obj)
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    stores = stores_of(obj)
    for name in _STORES:
        if has_input(modifier, name):
            set_input(modifier, name, None)
    obj.dapple.baked_keys = obj.dapple.baked_frames = 0
    obj.dapple.bake_fingerprint = obj.dapple.baked_settings = obj.dapple.baked_from = ""
    obj.update_tag()
    for store in stores:
        if store.users == 0 and store.library is None:
            data = store.data
            bpy.data.objects.remove(store)
            if data is not None and data.users == 0:
                bpy.data.batch_remove([data])


def _write_solved_report(obj: bpy.types.Object) -> None:
    """Show the figures of the solution again; older bakes have not kept more than the points."""
    if obj.dapple.solved.count:
        copy_report(obj.dapple.solved, obj.dapple.report)
    else:
        obj.dapple.report.count = len(obj.data.vertices)
