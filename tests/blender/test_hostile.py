# SPDX-License-Identifier: GPL-3.0-or-later
"""Invalid data in a .blend leads to an error message that names it."""

import re
import tracemalloc

import addon_host
import bmesh
import bpy
import pytest
import scenes
import test_panels

MOST = 2**31 - 1
POINTS = {
    "dapple_v0": "INT",
    "dapple_v2": "INT",
    "dapple_barycentric": "FLOAT_VECTOR",
    "dapple_angle": "FLOAT",
    "id": "INT",
    "dapple_object_type": "INT",
    "dapple_density": "FLOAT",
    "dapple_rank": "FLOAT",
    "dapple_locked": "BOOLEAN",
    "dapple_faded": "FLOAT",
}
REST = {"dapple_rest": "FLOAT_VECTOR", "dapple_ahead": "FLOAT_VECTOR", "dapple_part": "INT"}
STORES = {
    "Keys": {"dapple_face": "INT", "dapple_faded": "FLOAT", "dapple_tilt": "FLOAT_VECTOR"},
    "Triangles": {"dapple_v0": "INT"},
    "Frames": {
        "dapple_key": "INT",
        "dapple_span": "INT",
        "dapple_vertices": "INT",
        "dapple_sketch0": "FLOAT_VECTOR",
    },
}
WAYS = {
    "INT": ["other type", "other domain", "missing", -9, MOST],
    "FLOAT": ["other type", "other domain", "missing", float("nan"), 1e38],
    "FLOAT_VECTOR": ["other type", "other domain", "missing", float("nan"), float("inf")],
    "BOOLEAN": ["other type", "other domain", "missing"],
}


def broken(mesh, name, kind, way):
    """Make an attribute of a mesh of another type or domain, or one of its values another."""
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
    if isinstance(way, str):
        mesh.attributes.remove(attribute)
        if way == "other type":
            mesh.attributes.new(name, "STRING" if kind == "INT" else "INT", "POINT")
        elif way == "other domain":
            mesh.attributes.new(name, kind, "FACE")
        return
    item = attribute.data[len(attribute.data) // 2]
    if kind == "FLOAT_VECTOR":
        item.vector = (way, 0.0, way)
    else:
        item.value = way


def of_points(name, kind, way):
    return lambda obj: broken(obj.data, name, kind, way)


def of_store(store, name, kind, way):
    return lambda obj: broken(stored(obj, store).data, name, kind, way)


def stored(obj, name):
    return addon_host.part("nodes").get_input(obj.modifiers[0], name)


def with_own_points(name):
    return lambda obj: addon_host.part("nodes").set_input(obj.modifiers[0], name, obj)


def with_input(name, make):
    return lambda obj: addon_host.part("nodes").set_input(obj.modifiers[0], name, make())


def light():
    return bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))


def nothing():
    return bpy.data.objects.new("Nothing", None)


def no_points():
    return bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))


def resized(store, change):
    def change_it(obj):
        mesh = obj.data if store is None else stored(obj, store).data
        if change == "none":
            mesh.clear_geometry()
        elif change == "more":
            mesh.vertices.add(1)
        else:
            edited = bmesh.new()
            edited.from_mesh(mesh)
            edited.verts.ensure_lookup_table()
            edited.verts.remove(edited.verts[-1])
            edited.to_mesh(mesh)
            edited.free()

    return change_it


def with_values(**values):
    """Properties of the scatter, by names in which __ leads into a group."""

    def change_it(obj):
        for path, value in values.items():
            *groups, name = path.split("__")
            owner = obj.dapple
            for group in groups:
                owner = getattr(owner, group)
            setattr(owner, name, value)

    return change_it


def without_modifier(obj):
    obj.modifiers.clear()


def with_foreign_group(obj):
    """One that says that it is ours, but has none of the inputs."""
    nodes = addon_host.part("nodes")
    group = bpy.data.node_groups.new("Foreign", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    group[nodes.VERSION_KEY], group["dapple_kinds"] = nodes.VERSION, 2
    obj.modifiers[0].node_group = group


def with_odd_version(obj):
    obj.modifiers[0].node_group[addon_host.part("nodes").VERSION_KEY] = "nine"


def with_place(value):
    def change_it(obj):
        obj.data.vertices[3].co = (value, 0.0, 0.0)

    return change_it


def with_surface(make):
    def change_it(obj):
        made = make()
        if made is not None:
            bpy.context.collection.objects.link(made)
        obj.dapple.surface = made

    return change_it


WRONG = {
    **{
        f"points {name} {way}": of_points(name, kind, way)
        for name, kind in POINTS.items()
        for way in WAYS[kind]
    },
    **{
        f"{store} {name} {way}": of_store(store, name, kind, way)
        for store, names in STORES.items()
        for name, kind in names.items()
        for way in WAYS[kind]
    },
    **{
        f"{store} is {make.__name__}": with_input(store, make)
        for store in (*STORES, "Preview", "Surface")
        for make in (light, nothing, no_points)
    },
    **{f"{store} is the scatter": with_own_points(store) for store in STORES},
    **{
        f"{store or 'points'} {change}": resized(store, change)
        for store in (None, *STORES)
        for change in ("none", "more", "fewer")
    },
    **{
        f"Key Points {value}": with_input("Key Points", lambda v=value: v)
        for value in (-3, 0, MOST)
    },
    **{f"a place at {value}": with_place(value) for value in (float("nan"), 1e38)},
    **{
        f"surface is {make.__name__}": with_surface(make)
        for make in (light, nothing, no_points, lambda: None)
    },
    "no modifier": without_modifier,
    "a foreign node group": with_foreign_group,
    "an odd version": with_odd_version,
    "class -100": with_values(object_type_index=-100),
    "parts": with_values(attached_parts=MOST, attached_to="REST"),
    "class far": with_values(object_type_index=MOST),
    "overlap negative": with_values(report__overlap_first=-7, report__worst_overlap=0.5),
    "overlap far": with_values(report__overlap_second=MOST, report__worst_overlap=0.5),
    "overlap never": with_values(report__overlap_frame=MOST, report__worst_overlap=0.5),
    "details": with_values(report__details='{"energies": [1e400, 2], "gaps": [-5, 1e99]}'),
    "details of no kind": with_values(report__details='{"energies": 3, "gaps": {"a": []}}'),
    "settings of no kind": with_values(solved_settings='{"object_types": 5, "density": [1]}'),
    "settings deep": with_values(solved_settings="[" * 100_000),
    "sources of no kind": with_values(solved_from='{"exact": [], "near": {"a": 3}}'),
    "baked frames": with_values(baked_frames=MOST),
    "baked start": with_values(baked_start=-MOST),
    "baked keys": with_values(baked_keys=MOST),
    "vertices": with_values(surface_vertices=-1),
    "topology": with_values(surface_topology="a b c " * 1000),
    "key of work files": with_values(bake_key="/../../../../../x"),
    "bound to rest": with_values(attached_to="REST"),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Files of a baked scatter with two classes, one bound to faces and one to the rest."""
    folder, made = tmp_path_factory.mktemp("hostile"), {}
    for kind in ("FACES", "REST"):
        bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
        obj = scenes.scattered(scenes.tail(frames=2), count=12)
        obj.dapple.attach_to, bpy.context.scene.frame_start = kind, 1
        bpy.context.scene.frame_end = 2
        for _ in range(2):
            bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[0].radius = 0.05
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        obj.data.attributes["dapple_locked"].data[6].value = True
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        made[kind] = folder / f"{kind}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(made[kind]))
    return made


def opened(path, change):
    """The broken scatter, active."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = next(one for one in bpy.data.objects if one.name.endswith("Scatter"))
    change(obj)
    bpy.context.view_layer.update()
    scenes.activate(obj)
    return obj


def told(action, obj):
    """Do something, which may be refused with an error message; whether it was done."""
    errors = addon_host.part("core.base.errors")
    try:
        action(obj)
    except errors.ScatterError as error:
        said = str(error)
    except RuntimeError as error:
        said = str(error).removeprefix("Error: ").strip()
    else:
        return True
    assert "Traceback" not in said
    assert len(said) > 20, said
    return False


def play(obj):
    for frame in (1, 2):
        bpy.context.scene.frame_set(frame)
        scenes.positions(obj)


def draw(obj):
    test_panels.drawn()
    pictures, details = addon_host.part("core.pictures"), addon_host.part("core.solve.figures")
    found = details.details_from(obj.dapple.report.details)
    pictures.curve(found.energies)
    pictures.bars(found.gaps)


def look(obj):
    """Messages of the panel and the modifier about it."""
    addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)
    scenes.node_warnings(obj) if obj.modifiers else None


def preview(obj):
    if bpy.ops.dapple.live_preview.poll():
        bpy.ops.dapple.live_preview()
        addon_host.part("blender.display.preview").tick()
        if addon_host.part("blender.display.preview").is_on(obj):
            bpy.ops.dapple.live_preview()


def show_density(obj):
    overlay = addon_host.part("blender.density.overlay")
    bpy.ops.dapple.show_density()
    overlay.tick()
    if overlay.is_on(obj):
        bpy.ops.dapple.show_density()


def keep_off(obj):
    """Another scatter keeps off the broken one."""
    things = bpy.data.collections.new("Things")
    things.objects.link(obj)
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    other = scenes.scattered(bpy.context.object, count=5)
    try:
        other.dapple.density.avoid_collection = things
        bpy.ops.dapple.optimize()
    finally:
        scenes.activate(obj)


def select_overlap(obj):
    if bpy.ops.dapple.select_overlap.poll():
        bpy.ops.dapple.select_overlap()


def operator(name, **options):
    def call(obj):
        if getattr(bpy.ops.dapple, name).poll():
            getattr(bpy.ops.dapple, name)(**options)

    return call


READING = (play, draw, look, select_overlap, show_density, preview, keep_off)
WRITING = (
    operator("make_tiles"),
    operator("lock_points", every=True),
    operator("bake"),
    operator("reattach"),
    operator("edit_object_types", action="REMOVE"),
    operator("optimize"),
    operator("clear_bake"),
    operator("discard_unfinished_bake"),
)


def expect_sentences(path, change):
    """Everything is done, or refused with an error message."""
    obj = opened(path, change)
    for action in READING:
        told(action, obj)
    for action in WRITING:
        if told(action, obj):
            obj = opened(path, change)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", WRONG)
def test_whatever_a_file_holds_a_sentence_is_said_of_it(files, name):
    expect_sentences(files["FACES"], WRONG[name])


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("name", "way"), [(name, way) for name, kind in REST.items() for way in WAYS[kind]]
)
def test_whatever_a_rest_binding_holds_a_sentence_is_said_of_it(files, name, way):
    def change(obj):
        broken(obj.data, name, REST[name], way)
        obj.dapple.surface.modifiers["Subdivision"].levels = 2  # triggers another search

    expect_sentences(files["REST"], change)


SAID = {
    "points dapple_object_type -9": r"dapple_object_type\[6\] is -9, it must be from 0 to ",
    f"points dapple_object_type {MOST}": r"dapple_object_type\[6\] is 2147483647, it must be",
    "points dapple_angle nan": r"dapple_angle\[6\] is not finite: nan",
    "points dapple_faded other type": "Attribute 'dapple_faded' of 'Tail Scatter' is INT on POINT",
    "Frames is light": "Frames 'Light' of 'Tail Scatter' is a light, not a mesh",
    "Frames is the scatter": "Frames of 'Tail Scatter' is the mesh of its own points: bake again",
    "Keys none": "'Tail Scatter Keys' has no INT attribute 'dapple_face' on its points",
    "Keys fewer": "The keyframes are damaged: 23 rows are not a multiple of 12 points",
}


@pytest.mark.parametrize("name", SAID)
def test_the_first_value_that_is_wrong_is_named(files, name):
    obj = opened(files["FACES"], WRONG[name])
    said = [addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)]
    try:
        bpy.ops.dapple.make_tiles()
    except RuntimeError as error:
        said.append(str(error))
    assert any(re.search(SAID[name], one) for one in said), said


def test_a_class_far_off_takes_no_memory(files):
    obj = opened(files["FACES"], of_points("dapple_object_type", "INT", 10**8))
    tracemalloc.start()
    try:
        for action in WRITING[:4]:
            told(action, obj)
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()
