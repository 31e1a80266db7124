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
import tempfile
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

ROOT = Path(__file__).resolve().parents[1]
OUT = Path(os.environ["DAPPLE_SHOTS"])
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "tests" / "blender"))
addon_host = importlib.import_module("addon_host")

TICK = 0.2
PANELS = ("density", "evenness", "instances", "tiles", "animation")
Story = Iterator[None]


def story() -> Story:
    """What an artist does from the first scatter to a bake."""
    ground = scene()
    yield from until_shown()
    yield from shot("1-start")
    bpy.context.view_layer.objects.active = ground
    with window():
        bpy.ops.dapple.add("INVOKE_DEFAULT", count=600)
    yield from until_idle()
    obj = bpy.context.object
    yield from shot("2-added")
    yield from in_density(obj)
    yield from in_classes(obj)
    yield from in_motion(obj)


def in_density(obj: bpy.types.Object) -> Story:
    only(("density",))
    density = obj.dapple.density
    density.use_height, density.height_from, density.height_to = True, 0.02, 2.0
    density.height_fade = 0.3
    bpy.ops.dapple.show_density()
    yield from until_shown()
    yield from shot("3-density")
    bpy.ops.dapple.show_density()
    optimise()
    yield from until_idle()
    only(("evenness",))
    yield from until_shown()
    yield from shot("4-optimised")


def in_classes(obj: bpy.types.Object) -> Story:
    only(("instances",))
    for name, share, radius, scale in (("Bush", 1.0, 0.16, 1.0), ("Grass", 8.0, 0.05, 0.6)):
        bpy.ops.dapple.edit_classes(action="ADD")
        kind = obj.dapple.classes[-1]
        kind.name, kind.share, kind.radius, kind.scale = name, share, radius, scale
        kind.instance = bpy.data.objects[name]
    optimise()
    yield from until_idle()
    yield from shot("5-classes")


def in_motion(obj: bpy.types.Object) -> Story:
    only(("animation",))
    obj.dapple.count = 40_000
    obj.dapple.tolerance = 1e-7
    optimise()
    for _ in range(4):
        yield
    yield from shot("6-optimising")
    escape()
    yield from until_idle()
    yield from shot("7-cancelled")
    obj.dapple.count, obj.dapple.tolerance = 600, 5e-5
    with window():
        bpy.ops.dapple.bake("INVOKE_DEFAULT")
    yield from until_idle()
    yield from shot("8-baked")
    bpy.context.scene.frame_set(12)
    obj.dapple.stickiness = 2.0
    yield from until_shown()
    yield from shot("9-stale")


def scene() -> bpy.types.Object:
    """Hills that breathe, with two kinds of things to place."""
    bpy.context.scene.frame_end = 12
    thing("Bush", bpy.ops.mesh.primitive_ico_sphere_add, 0.13, (0.20, 0.42, 0.16, 1))
    thing("Grass", bpy.ops.mesh.primitive_cone_add, 0.05, (0.62, 0.72, 0.25, 1))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=4)
    ground = bpy.context.object
    ground.name, ground.color = "Hills", (0.35, 0.30, 0.24, 1)
    texture = bpy.data.textures.new("Hills", "CLOUDS")
    texture.noise_scale = 1.1
    displace = ground.modifiers.new("Hills", "DISPLACE")
    displace.texture = texture
    for frame, strength in ((1, 1.0), (12, 1.6)):
        displace.strength = strength
        displace.keyframe_insert("strength", frame=frame)
    bpy.context.scene.frame_set(1)
    return ground


def thing(name: str, add: Any, radius: float, colour: tuple[float, ...]) -> None:
    options = {"radius1": radius, "depth": 4 * radius} if name == "Grass" else {"radius": radius}
    add(**options)
    obj = bpy.context.object
    obj.name, obj.color = name, colour
    obj.location = (0, 0, -50)


def optimise() -> None:
    with window():
        bpy.ops.dapple.optimise("INVOKE_DEFAULT")


def escape() -> None:
    for value in ("PRESS", "RELEASE"):
        the_window().event_simulate("ESC", value, x=100, y=100)


def the_window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def view() -> tuple[bpy.types.Area, bpy.types.Region]:
    area = next(one for one in the_window().screen.areas if one.type == "VIEW_3D")
    return area, next(one for one in area.regions if one.type == "WINDOW")


def window() -> Any:
    area, region = view()
    return bpy.context.temp_override(window=the_window(), area=area, region=region)


def only(names: tuple[str, ...]) -> None:
    """Open these of the sub-panels; the next drawing shows them so."""
    ui = addon_host.part("blender.ui")
    for name in PANELS:
        panel = getattr(ui, f"DAPPLE_PT_{name}")
        bpy.utils.unregister_class(panel)
        options = set(getattr(panel, "bl_options", ())) - {"DEFAULT_CLOSED"}
        panel.bl_options = options if name in names else options | {"DEFAULT_CLOSED"}
        panel.bl_idname = f"DAPPLE_PT_{name}"
        bpy.utils.register_class(panel)


def prepare() -> None:
    """A large viewport with the sidebar open at the add-on's tab."""
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.show_developer_ui = False
    with window():
        bpy.ops.screen.screen_full_area(use_hide_panels=False)
    area, _ = view()
    space = area.spaces.active
    space.show_region_ui, space.overlay.show_relationship_lines = True, False
    space.shading.color_type = "OBJECT"
    space.region_3d.view_distance = 7.5


def until_shown(ticks: int = 4) -> Story:
    area, _ = view()
    for region in area.regions:
        if region.type == "UI" and region.active_panel_category != "Dapple":
            region.active_panel_category = "Dapple"
    for _ in range(ticks):
        for one in area.regions:
            one.tag_redraw()
        yield


def until_idle() -> Story:
    for _ in range(2000):
        yield
        if not the_window().modal_operators:
            break
    else:
        raise TimeoutError("an operator is still running")
    yield from until_shown()


def shot(name: str) -> Story:
    yield from until_shown(3)
    subprocess.run(["import", "-window", "root", str(OUT / f"{name}.png")], check=True)
    yield


def leave(status: int) -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def tell(told: Story) -> float:
    try:
        next(told)
    except StopIteration:
        addon_host.disable()
        leave(0)
    except BaseException:
        traceback.print_exc()
        leave(1)
    return TICK


def main() -> None:
    addon_host.add_repository(Path(tempfile.mkdtemp()))
    addon_host.enable()
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    told = story()
    bpy.app.timers.register(prepare, first_interval=1.0, persistent=True)
    bpy.app.timers.register(lambda: tell(told), first_interval=3.0, persistent=True)


main()
