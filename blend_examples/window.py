# SPDX-License-Identifier: GPL-3.0-or-later
"""Drives the add-on in a real window and takes screenshots of the panel in each state.

blend_examples/window.sh runs this inside Blender on a virtual display. Each step of `story` yields
until Blender has drawn; pictures are taken by ImageMagick's `import`, since Blender's own
screenshots of such a display are black.
"""

import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

ROOT = Path(__file__).resolve().parents[1]
OUT = Path(os.environ["DAPPLE_SHOTS"])
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "tests" / "blender"))
addon_host = importlib.import_module("addon_host")
told = importlib.import_module("story")

TICK = 0.2
Story = Iterator[None]


def story() -> Story:
    """What an artist does from the first scatter to a bake."""
    ground = scene()
    prepare()
    only(())
    yield from until_shown()
    yield from shot("1-start")
    bpy.context.view_layer.objects.active = ground
    with window():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=600)
    yield from until_idle()
    obj = bpy.context.object
    yield from shot("2-added")
    yield from in_density(obj)
    yield from in_classes(obj)
    yield from in_motion(obj)


def in_density(obj: bpy.types.Object) -> Story:
    only(("density",))
    density = obj.dapple.density
    density.use_height, density.height_min, density.height_max = True, 0.02, 2.0
    density.height_falloff = 0.3
    bpy.ops.dapple.show_density()
    yield from until_shown()
    yield from shot("3-density")
    bpy.ops.dapple.show_density()
    optimize()
    yield from until_idle()
    only(("advanced",))
    yield from until_shown()
    yield from shot("4-optimized")
    yield from details()


def details() -> Story:
    """The popover opens under the pointer."""
    the_window().event_simulate("MOUSEMOVE", "NOTHING", x=560, y=560)
    yield
    with window():
        bpy.ops.wm.call_panel("INVOKE_DEFAULT", name="DAPPLE_PT_details", keep_open=True)
    yield from shot("5-details")
    told.press_escape()
    yield from until_shown()


def in_classes(obj: bpy.types.Object) -> Story:
    only(("instances",))
    for name, share, radius, scale in (("Bush", 1.0, 0.13, 1.0), ("Grass", 8.0, 0.03, 0.6)):
        bpy.ops.dapple.edit_object_types(action="ADD")
        kind = obj.dapple.object_types[-1]
        kind.name, kind.weight, kind.radius, kind.scale = name, share, radius, scale
        kind.instance = bpy.data.objects[name]
    optimize()
    yield from until_idle()
    yield from shot("6-classes")


def in_motion(obj: bpy.types.Object) -> Story:
    only(("animation",))
    obj.dapple.count = 40_000
    obj.dapple.tolerance = 1e-7
    optimize()
    for _ in range(4):
        yield
    yield from shot("7-optimizing")
    press_escape()
    yield from until_idle()
    yield from shot("8-canceled")
    obj.dapple.count, obj.dapple.tolerance = 600, 5e-5
    with window():
        bpy.ops.dapple.bake("INVOKE_DEFAULT")
    yield from until_idle()
    yield from shot("9-baked")
    bpy.context.scene.frame_set(12)
    obj.dapple.stickiness = 2.0
    yield from until_shown()
    yield from shot("10-stale")


def scene() -> bpy.types.Object:
    """Hills that breathe, with two object types."""
    bpy.context.scene.frame_end = 12
    thing("Bush", bpy.ops.mesh.primitive_ico_sphere_add, 0.13, (0.20, 0.42, 0.16, 1))
    thing("Grass", bpy.ops.mesh.primitive_cone_add, 0.05, (0.62, 0.72, 0.25, 1))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=4)
    ground = bpy.context.object
    ground.name, ground.color = "Hills", (0.35, 0.30, 0.24, 1)
    texture = bpy.data.textures.new("Hills", "CLOUDS")
    texture.noise_scale = 1.3
    displace = ground.modifiers.new("Hills", "DISPLACE")
    displace.texture = texture
    for frame, strength in ((1, 1.0), (12, 1.6)):
        displace.strength = strength
        displace.keyframe_insert("strength", frame=frame)
    bpy.context.scene.frame_set(1)
    return ground


def thing(name: str, add: Any, radius: float, color: tuple[float, ...]) -> None:
    options = {"radius1": radius, "depth": 4 * radius} if name == "Grass" else {"radius": radius}
    add(**options)
    obj = bpy.context.object
    obj.name, obj.color = name, color
    obj.location = (0, 0, -50)


def optimize() -> None:
    with window():
        bpy.ops.dapple.optimize("INVOKE_DEFAULT")


def press_escape() -> None:
    """In the 3D View, where it cancels what is solved in the background."""
    area, _ = view()
    place = {"x": area.x + 300, "y": area.y + 200}
    the_window().event_simulate("MOUSEMOVE", "NOTHING", **place)
    for value in ("PRESS", "RELEASE"):
        the_window().event_simulate("ESC", value, **place)


def the_window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def view() -> tuple[bpy.types.Area, bpy.types.Region]:
    area = next(one for one in the_window().screen.areas if one.type == "VIEW_3D")
    return area, next(one for one in area.regions if one.type == "WINDOW")


def window() -> Any:
    area, region = view()
    return bpy.context.temp_override(window=the_window(), area=area, region=region)


def only(names: tuple[str, ...]) -> None:
    """Open these of the sub-panels: Blender has no other way than to register them anew."""
    panels = addon_host.part("blender.main_panel").SUB_PANELS
    for panel in [one for one in panels if getattr(one, "bl_parent_id", "")]:
        name = panel.__name__.removeprefix("DAPPLE_PT_")
        bpy.utils.unregister_class(panel)
        panel.bl_options = set() if name in names else {"DEFAULT_CLOSED"}
        # The old one remembers its state.
        panel.bl_idname = f"DAPPLE_PT_{name}_{'_'.join(names) or 'closed'}"
        bpy.utils.register_class(panel)


def prepare() -> None:
    """A viewport with the sidebar open, near to the hills."""
    area, _ = view()
    space = area.spaces.active
    space.show_region_ui, space.overlay.show_relationship_lines = True, False
    space.shading.color_type = "OBJECT"
    space.region_3d.view_distance = 6.0


def until_shown(ticks: int = 4) -> Story:
    """Until the sidebar shows the add-on's tab, which it can only once it has been drawn."""
    for tick in range(50):
        area, _ = view()
        area.tag_redraw()
        yield
        if tick >= ticks and show_tab(area):
            return
    raise TimeoutError("the sidebar has no tab of the add-on")


def show_tab(area: bpy.types.Area) -> bool:
    sidebar = next(one for one in area.regions if one.type == "UI")
    try:
        shown = sidebar.active_panel_category == "Dapple"
        sidebar.active_panel_category = "Dapple"
    except (AttributeError, TypeError):  # not drawn yet
        return False
    return shown


def until_idle() -> Story:
    live = addon_host.part("blender.solve.auto_update")
    for _ in range(2000):
        yield
        if not (works() or live.is_active()):
            break
    else:
        raise TimeoutError("an operator is still running")
    yield from until_shown()


def works() -> bool:
    """Whether long work goes on."""
    return addon_host.part("blender.base.operator_jobs").current() is not None


def shot(name: str) -> Story:
    """The viewport, and the status bar while it says how far something is."""
    yield from until_shown(3)
    area, height = view()[0], the_window().height
    bottom = 0 if works() else area.y
    top = height - area.y - area.height
    crop = f"{area.width}x{height - top - bottom}+{area.x}+{top}"
    picture = str(OUT / f"{name}.png")
    subprocess.run(["import", "-window", "root", "-crop", crop, "+repage", picture], check=True)
    yield


if __name__ == "__main__":
    told.begin(story, TICK)
