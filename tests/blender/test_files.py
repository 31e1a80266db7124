# SPDX-License-Identifier: GPL-3.0-or-later
"""Save and reload; playback in a process that has never heard of the add-on."""

from pathlib import Path

import addon_host
import bpy
import child
import numpy as np
import scenes

BARE = """
import numpy as np
sys.modules["dapple3d"] = None  # hides the native package too
bpy.ops.wm.open_mainfile(filepath=arguments[0])
scene, found = bpy.context.scene, []
for frame, subframe in ((1, 0.0), (4, 0.0), (4, 0.5), (9, 0.0)):
    scene.frame_set(frame, subframe=subframe)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found.append([np.array(i.matrix_world) for i in depsgraph.object_instances if i.is_instance])
assert not any(name.endswith(".dapple") for name in sys.modules)
assert not hasattr(bpy.types.Object, "dapple")
np.save(arguments[1], np.array(found, dtype=np.float64))
"""

MOMENTS = ((1, 0.0), (4, 0.0), (4, 0.5), (9, 0.0))


def matrices(obj):
    found = []
    for frame, subframe in MOMENTS:
        bpy.context.scene.frame_set(frame, subframe=subframe)
        found.append(scenes.instance_matrices(obj))
    return np.array(found)


def baked_file(path):
    obj = scenes.scattered(scenes.tail())
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = matrices(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return obj.name, expected


def test_save_and_reload(tmp_path):
    path = tmp_path / "péinture d'été.blend"
    name, expected = baked_file(path)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[name]
    assert np.allclose(matrices(obj), expected, atol=1e-6)
    assert obj.dapple.baked_keys == 6
    assert obj.dapple.surface.name == "Tail"
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}


def test_playback_without_the_add_on(tmp_path):
    _, expected = baked_file(tmp_path / "baked.blend")
    child.run(BARE, tmp_path / "baked.blend", tmp_path / "found.npy")
    assert expected.shape[1] == 60
    assert np.allclose(np.load(tmp_path / "found.npy"), expected, atol=1e-6)


def test_appending_the_scatter_brings_surface_and_keys(tmp_path):
    path = tmp_path / "baked.blend"
    name, expected = baked_file(path)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(path)) as (_, wanted):
        wanted.objects = [name]
    obj = bpy.data.objects[name]
    for item in (obj, obj.dapple.surface):
        bpy.context.scene.collection.objects.link(item)
    assert np.allclose(matrices(obj), expected, atol=1e-6)


def test_the_keys_lie_outside_every_scene():
    obj = scenes.scattered(scenes.tail())
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    store = addon_host.part("nodes").get_input(obj.modifiers[0], "Keys")
    assert list(store.users_collection) == []
    assert Path(bpy.data.filepath) == Path()
