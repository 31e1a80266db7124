# SPDX-License-Identifier: GPL-3.0-or-later
"""If an operator fails for any reason, the file is unchanged."""

import addon_host
import bpy
import pytest
import scenes
from test_undo import state


def everything():
    found = state()
    for obj in bpy.data.objects:
        found[f"{obj.name} rests"] = obj.add_rest_position_attribute
    for mesh in bpy.data.meshes:
        found[f"{mesh.name} has"] = sorted(one.name for one in mesh.attributes)
        found[f"{mesh.name} is"] = sorted(mesh.keys())
    found["presets"] = addon_host.part("core.settings.presets").names(
        addon_host.part("blender.presets.stored").folder()
    )
    return repr(found)  # in text form NaN equals itself


def broken(surface):
    surface.data.vertices[3].co.x = float("nan")


def faceless(surface):
    surface.data.clear_geometry()
    surface.data.vertices.add(3)


def rimmed(surface):
    """Neither faces nor the rest position tell the places of this one apart."""
    surface.data.clear_geometry()
    surface.data.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    surface.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.5
    surface.modifiers.new("Subdivision", "SUBSURF")


SURFACES = [broken, faceless, rimmed]


@pytest.mark.empty_file
@pytest.mark.parametrize("spoil", SURFACES)
@pytest.mark.parametrize("attach_to", ["AUTO", "FACES", "REST"])
def test_add(spoil, attach_to):
    surface = scenes.sphere()
    spoil(surface)
    bpy.context.view_layer.update()
    before = everything()
    with pytest.raises(RuntimeError, match="Sphere"):
        bpy.ops.dapple.add_scatter(count=40, attach_to=attach_to)
    assert everything() == before


def spoilt_surface(spoil):
    def spoilt(obj):
        spoil(obj.dapple.surface)

    return spoilt


def negative(obj):
    mesh = obj.dapple.surface.data
    mesh.attributes.new("Grass", "FLOAT", "POINT").data[7].value = -1.0
    obj.dapple.density.attribute = "Grass"


def too_many(obj):
    bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[0].use_count, obj.dapple.object_types[0].count = True, 1000


def without_attribute(obj):
    obj.dapple.density.attribute = "Nowhere"


def without_camera(obj):
    obj.dapple.density.use_camera_view = True


def flat(obj):
    obj.scale.x = 0.0


def without_surface(obj):
    obj.dapple.surface = None


def tiles_on_surface(obj):
    obj.dapple.tiles.object = obj.dapple.surface


CASES = [
    *((name, spoilt_surface(spoil)) for name in ("optimize", "bake") for spoil in SURFACES),
    *(
        (name, spoilt_surface(spoil))
        for name in ("reattach", "live_preview")
        for spoil in SURFACES[1:2]
    ),
    ("optimize", negative),
    ("optimize", too_many),
    ("optimize", without_attribute),
    ("bake", without_attribute),
    ("show_density", without_attribute),
    ("optimize", without_camera),
    ("optimize", flat),
    ("make_tiles", tiles_on_surface),
    *(
        (name, without_surface)
        for name in ("optimize", "bake", "reattach", "make_tiles", "live_preview")
    ),
]


@pytest.mark.parametrize(("name", "spoil"), CASES)
@pytest.mark.parametrize("baked", [False, True])
def test_operators(name, spoil, baked):
    obj = scenes.scattered(scenes.sphere(), 40)
    bpy.context.scene.frame_end = 2
    if baked:
        assert bpy.ops.dapple.bake() == {"FINISHED"}
    spoil(obj)
    bpy.context.view_layer.update()
    before = everything()
    with pytest.raises(RuntimeError):
        getattr(bpy.ops.dapple, name)()
    assert everything() == before


def test_presets():
    obj = scenes.scattered(scenes.sphere(), 40)
    before = everything()
    for call in (
        lambda: bpy.ops.dapple.save_preset(name="a/b"),
        lambda: bpy.ops.dapple.load_preset(name="Gone"),
        lambda: bpy.ops.dapple.remove_preset(name="Gone"),
    ):
        with pytest.raises(RuntimeError, match="preset"):
            call()
        assert everything() == before
    assert obj.dapple.count == 40
