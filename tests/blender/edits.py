# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits of a scatter with Auto Update."""

import bpy
import scenes

NAME = "Sphere Scatter"
MORE_LOCKED = "are locked, the count is"


def scatter():
    return bpy.data.objects[NAME]


def prepared():
    surface = scenes.sphere()
    surface.vertex_groups.new(name="Grass").add(range(300), 1.0, "REPLACE")
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.2, 0.2, 0.2))
    stone.name = "Stone"
    stones.objects.link(stone)
    obj = scenes.scattered(surface, count=80)
    _small_renders()
    obj.dapple.auto_update_mode = "ON"
    obj.dapple.density.attribute, obj.dapple.density.avoid_collection = "Grass", stones


def _small_renders():
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.resolution_x = scene.render.resolution_y = 16


def stroke(chance):
    surface = scatter().dapple.surface
    first = chance.randrange(200)
    group = surface.vertex_groups["Grass"]
    group.add(range(first, first + 40), chance.choice([0.0, 0.3, 1.0]), "REPLACE")
    surface.data.update()


def setting(chance):
    settings = scatter().dapple
    name, value = chance.choice(
        [
            ("count", chance.randrange(40, 120)),
            ("points_per_area", chance.uniform(4.0, 10.0)),
            ("amount", chance.choice(["COUNT", "PER_AREA"])),
            ("seed", chance.randrange(3)),
            ("quality", chance.choice(["DRAFT", "NATURAL", "FINE"])),
            ("forward", chance.choice(["NONE", "X"])),
            ("keep_points", chance.random() < 0.8),
        ]
    )
    setattr(settings, name, value)


def density(chance):
    settings = scatter().dapple.density
    settings.use_height = chance.random() < 0.5
    settings.height_min = chance.uniform(-0.6, 0.0)
    settings.use_noise = chance.random() < 0.3
    settings.noise_strength = chance.uniform(0.2, 0.8)


def instances(chance):
    """Change settings that do not change the solution."""
    settings = scatter().dapple
    settings.fit_to_spacing, settings.scale = chance.choice([0.0, 1.0]), chance.uniform(0.5, 2.0)
    settings.display_as = chance.choice(["INSTANCES", "BOUNDS"])


def obstacle(chance):
    bpy.data.objects["Stone"].location.y = chance.uniform(-1.0, 1.0)


def shape(chance):
    surface = scatter().dapple.surface
    surface.data.vertices[chance.randrange(200)].co *= chance.uniform(0.9, 1.1)
    surface.data.update()


def scale(chance):
    scatter().dapple.surface.scale.x = chance.uniform(0.8, 1.5)


def undo(_chance):
    if bpy.ops.ed.undo.poll():
        bpy.ops.ed.undo()


def redo(_chance):
    if bpy.ops.ed.redo.poll():
        bpy.ops.ed.redo()


def done(operator):
    """Call an operator; whether it did not refuse because more points are locked than there can
    be, which is for the artist to settle.
    """
    scenes.activate(scatter())
    try:
        status = operator("EXEC_DEFAULT", True)
    except RuntimeError as error:
        if MORE_LOCKED not in str(error):
            raise
        return False
    assert status == {"FINISHED"}
    return True


def optimize(_chance):
    done(bpy.ops.dapple.optimize)


def render(_chance):
    """While an update may be under way."""
    assert bpy.ops.render.render() == {"FINISHED"}


def classes(chance):
    """Add and remove object types, of which at least one stays."""
    scenes.activate(scatter())
    action = chance.choice(["ADD", "REMOVE"])
    if action == "ADD" or len(scatter().dapple.object_types) > 1:
        assert bpy.ops.dapple.edit_object_types(action=action) == {"FINISHED"}


def lock(chance):
    scenes.activate(scatter())
    assert bpy.ops.dapple.lock_points(lock=chance.random() < 0.5, every=True) == {"FINISHED"}


def frame(chance):
    bpy.context.scene.frame_set(chance.randrange(1, 4))


def bake(chance):
    """Bake, then delete the keyframes, so that points follow changes again."""
    scenes.activate(scatter())
    bpy.context.scene.frame_end = 2
    if bpy.ops.dapple.bake.poll() and done(bpy.ops.dapple.bake):
        frame(chance)
        assert bpy.ops.dapple.clear_bake("EXEC_DEFAULT", True) == {"FINISHED"}


def paint(chance):
    """A stroke in the mode that artists paint in."""
    scenes.activate(scatter().dapple.surface)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    stroke(chance)
    bpy.ops.object.mode_set(mode="OBJECT")


def edit(chance):
    """The surface in Edit Mode, left with other vertices."""
    scenes.activate(scatter().dapple.surface)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.resize(value=(1.0, chance.uniform(0.9, 1.1), 1.0))
    bpy.ops.object.mode_set(mode="OBJECT")


def copy(chance):
    """A second scatter, which goes again."""
    before = set(bpy.data.objects.keys())
    assert bpy.ops.dapple.copy_scatter(name=NAME) == {"FINISHED"}
    added = set(bpy.data.objects.keys()) - before
    (name,) = [one for one in added if bpy.data.objects[one].dapple.surface]
    assert len(added) == 1 or scatter().dapple.baked_keys  # the second object holds the bake
    if chance.random() < 0.5:
        bpy.data.objects[name].dapple.seed = 7  # the object is renamed during the work
    assert bpy.ops.dapple.remove_scatter(name=name) == {"FINISHED"}
    assert set(bpy.data.objects.keys()) == before


EDITS = (
    *(stroke, stroke, setting, setting, density, obstacle, shape, scale),
    *(instances, optimize, render, classes, lock, frame, bake, paint, edit, copy),
)
