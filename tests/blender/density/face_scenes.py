# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces whose faces have values, for tests of densities."""

import bpy
import scenes

FLAT = 1e-4  # lengths


def cube():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def optimized(obj, **density):
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return scenes.positions(obj)


def on_top(points):
    return int((points[:, 2] > 1.0 - FLAT).sum())


def with_materials(surface, index_of, names=("Soil", "Grass", "Stone")):
    """Materials of these names, and their numbers by the middles of polygons."""
    for name in names:
        surface.data.materials.append(bpy.data.materials.get(name) or bpy.data.materials.new(name))
    for one in surface.data.polygons:
        one.material_index = index_of(one.center)
    return surface


def choose(obj, *names):
    bpy.context.view_layer.objects.active = obj
    for name in names:
        assert bpy.ops.dapple.add_material(material=name) == {"FINISHED"}
