# SPDX-License-Identifier: GPL-3.0-or-later
"""Save and reload; playback in a process that has never heard of the add-on."""

import os
import subprocess
import sys
from pathlib import Path

import addon_host
import bpy
import numpy as np
import pytest
import scenes

BARE = """
import os, sys
import numpy as np
import bpy
sys.modules["dapple"] = None  # the native package is not there either
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
scene, found = bpy.context.scene, []
for frame, subframe in ((1, 0.0), (4, 0.0), (4, 0.5), (9, 0.0)):
    scene.frame_set(frame, subframe=subframe)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found.append([np.array(i.matrix_world) for i in depsgraph.object_instances if i.is_instance])
assert not any(name.endswith(".dapple") for name in sys.modules)
assert not hasattr(bpy.types.Object, "dapple")
np.save(sys.argv[2], np.array(found, dtype=np.float64))
sys.stdout.flush()
os._exit(0)
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


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="needs bpy as a module of Python")
def test_playback_without_the_add_on(tmp_path):
    _, expected = baked_file(tmp_path / "baked.blend")
    found = tmp_path / "found.npy"
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "nothing")}
    subprocess.run(
        [sys.executable, "-c", BARE, str(tmp_path / "baked.blend"), str(found)],
        env=environment,
        check=True,
        timeout=120,
    )
    assert expected.shape[1] == 60
    assert np.allclose(np.load(found), expected, atol=1e-6)


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
