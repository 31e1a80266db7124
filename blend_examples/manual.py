# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the pictures of docs/manual and of the panel in a real window.

`blend_examples/window.sh manual` runs this inside Blender on a virtual display.
"""

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector
from PIL import Image, ImageChops

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
window = importlib.import_module("blend_examples.window")
scenery = importlib.import_module("blend_examples.manual_scene")
hand = importlib.import_module("hand")

QUALITY = 84  # of a picture, 1 to 100
GAP = 12
TABS = 26  # width of the sidebar's tabs
BORDER = 6  # of an area
PAPER = (255, 255, 255)
Story = Iterator[None]
Place = tuple[float, float, float]
Box = tuple[int, int, int, int]  # left, top, right, bottom on the screen


def story() -> Story:
    """Each chapter goes on where the one before has ended."""
    ground, things = scenery.meadow(), scenery.things()
    prepare()
    bpy.context.view_layer.objects.active = ground
    yield from window.until_shown()
    yield from first_minutes(things)
    yield from painting(ground)
    yield from object_types(things)
    yield from spraying()
    yield from characters()


def first_minutes(things: dict[str, bpy.types.Object]) -> Story:
    window.only(())
    yield from scene_shot("start")
    with window.window():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=400)
    yield from until_told()
    yield from scene_shot("added")
    settings = bpy.context.object.dapple
    settings.auto_update_mode = "ON"
    settings.instance, settings.random_scale_down = things["Pine"], 0.5
    window.only(("instances",))
    yield from window.until_shown()
    yield from scene_shot("instances")
    window.only(("amount",))
    settings.count, settings.scale = 900, 0.8
    yield from until_told()
    yield from panel_shot("amount")


def painting(ground: bpy.types.Object) -> Story:
    window.only(("density",))
    yield from until_told()
    yield from panel_shot("density")
    bpy.ops.dapple.paint_density()
    yield from window.until_shown()
    x, y, _ = scenery.places(ground).T
    way = np.abs(x - 1.4 * np.sin(0.8 * y))
    stroke(ground, np.clip((way - 0.4) / 0.7, 0.0, 1.0))
    yield from until_told()
    yield from scene_shot("painting")
    bpy.ops.dapple.finish_painting()
    yield from until_told()
    bpy.ops.dapple.show_density()
    yield from until_told()
    yield from scene_shot("show_density")
    bpy.ops.dapple.show_density()


def stroke(ground: bpy.types.Object, weights: np.ndarray) -> None:
    """Weights as brushes would leave them: not every Blender comes with brushes."""
    group = ground.vertex_groups.active
    for vertex, weight in enumerate(weights.tolist()):
        group.add([vertex], weight, "REPLACE")
    ground.data.update()


def object_types(things: dict[str, bpy.types.Object]) -> Story:
    settings = bpy.context.object.dapple
    window.only(("instances",))
    for name, share, radius, scale in (
        ("Rock", 1.0, 0.26, 0.26),
        ("Pine", 4.0, 0.16, 1.0),
        ("Flower", 20.0, 0.0, 0.45),
    ):
        bpy.ops.dapple.edit_object_types(action="ADD")
        kind = settings.object_types[-1]
        kind.name, kind.weight, kind.radius, kind.scale = name, share, radius, scale
        kind.instance, kind.random_scale_down = things[name], 0.3
    window.optimize()
    yield from until_told()
    settings.object_type_index = 0
    yield from until_told()
    yield from scene_shot("object_types")
    yield from panel_shot("panel-1")


def spraying() -> Story:
    """Flowers between the trees; the picture is taken in the middle of a stroke."""
    bpy.context.object.dapple.object_type_index = 2
    with window.window():
        bpy.ops.wm.tool_set_by_id(name="dapple.spray")
    tool = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
    brush = tool.operator_properties("dapple.spray_points")
    brush.radius, brush.spacing = 4.0, 0.35
    window.only(("placement",))
    yield from until_told()
    area = window.view()[0]
    way = [(area.x + 300 + 12 * k, area.y + 330 + 3 * k) for k in range(12)]
    yield from hand.Hand().drag(way, before_release=lambda: scene_shot("spray"))
    yield from until_told()
    with window.window():
        bpy.ops.wm.tool_set_by_id(name="builtin.select_box")


def characters() -> Story:
    body, stud = scenery.creature()
    prepare()
    bpy.context.view_layer.objects.active = body
    look(6.2, (0.6, 0.5, 0.1), (0.40, -0.75, 0.45))
    window.only(("animation",))
    with window.window():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=600)
    yield from until_told()
    settings = bpy.context.object.dapple
    settings.instance, settings.scale = stud, 0.46 * settings.report.spacing
    with window.window():
        bpy.ops.dapple.bake("INVOKE_DEFAULT")
    yield from until_told()
    bpy.context.scene.frame_set(7)
    yield from until_told()
    yield from scene_shot("character")
    yield from panel_shot("animation")
    yield from out_of_date(settings)
    yield from figures()


def out_of_date(settings: bpy.types.AnyType) -> Story:
    window.only(())
    settings.stickiness = 2.0
    yield from until_told()
    yield from panel_shot("out_of_date")
    settings.stickiness = 0.0
    yield from until_told()


def figures() -> Story:
    """The other panels, beside those that have been taken already."""
    window.only(("advanced",))
    yield from until_told()
    yield from panel_shot("panel-3")
    names = ("panel-1", "animation", "panel-3")
    parts = [Image.open(window.OUT / f"{name}.webp").convert("RGB") for name in names]
    size = (sum(part.width + GAP for part in parts) - GAP, max(part.height for part in parts))
    sheet, left = Image.new("RGB", size, PAPER), 0
    for part in parts:
        sheet.paste(part, (left, 0))
        left += part.width + GAP
    sheet.quantize(256, kmeans=2, dither=Image.Dither.NONE).save(window.OUT / "panels.png")
    for name in (names[0], names[2]):
        (window.OUT / f"{name}.webp").unlink()


def prepare() -> None:
    """A view in the colors of the materials."""
    window.prepare()
    area, _ = window.view()
    at = {"x": area.x + 200, "y": area.y + 40}  # where the pointer calls no tooltip
    window.the_window().event_simulate("MOUSEMOVE", "NOTHING", **at)
    space = window.view()[0].spaces.active
    space.shading.color_type, space.shading.show_cavity = "MATERIAL", True
    space.overlay.show_outline_selected = space.overlay.show_cursor = False
    space.overlay.show_object_origins = False
    look(9.0, (0.6, 0.8, -0.1))


def look(distance: float, target: Place, toward: Place = (0.55, -0.60, 0.50)) -> None:
    """From a side at a place, which is off the middle: the sidebar hides a part of the view."""
    view = window.view()[0].spaces.active.region_3d
    view.view_distance, view.view_location = distance, target
    view.view_rotation = Vector(toward).to_track_quat("Z", "Y")


def until_told() -> Story:
    """Until nothing is under way and the panel knows whether the result fits."""
    fresh = window.addon_host.part("blender.freshness.findings")
    yield from window.until_idle()
    scatter = bpy.data.objects.get(bpy.context.scene.dapple_painted) or bpy.context.object
    for _ in range(300):
        if fresh.findings(scatter, bpy.context) is not None:
            break
        yield
    yield from window.until_shown()


def region(kind: str) -> bpy.types.Region:
    return next(one for one in window.view()[0].regions if one.type == kind)


def scene_shot(name: str) -> Story:
    """The view with the sidebar."""
    yield from window.until_shown(3)
    area = window.view()[0]
    save(screen(box_of(area)), name)
    yield


def panel_shot(name: str) -> Story:
    """The panel alone, over nothing: what is below its end is cut off."""
    space = window.view()[0].spaces.active
    shown, far = space.overlay.show_overlays, space.region_3d.view_distance
    space.overlay.show_overlays, space.region_3d.view_distance = False, 1e6
    yield from window.until_shown(4)
    left, top, right, bottom = box_of(region("UI"))
    picture = screen((left, top, right - TABS, bottom))
    save(without_rest(picture), name)
    space.overlay.show_overlays, space.region_3d.view_distance = shown, far
    yield


def without_rest(picture: Image.Image) -> Image.Image:
    """Without the rows at the end that show one color."""
    last = picture.height - BORDER
    plain = Image.new("RGB", picture.size, picture.getpixel((picture.width // 2, last - 1)))
    other = ImageChops.difference(picture, plain).convert("L").point(lambda v: 255 * (v > 6))
    _, _, _, bottom = other.crop((0, 0, picture.width, last)).getbbox() or (0, 0, 0, last)
    return picture.crop((0, 0, picture.width, min(bottom + GAP, last)))


def box_of(part: bpy.types.Area | bpy.types.Region) -> Box:
    top = window.the_window().height - part.y - part.height
    return part.x, top, part.x + part.width, top + part.height


def screen(box: Box) -> Image.Image:
    picture = window.OUT / "screen.png"
    subprocess.run(["import", "-window", "root", str(picture)], check=True)
    with Image.open(picture) as whole:
        part = whole.convert("RGB").crop(box)
    picture.unlink()
    return part


def save(picture: Image.Image, name: str) -> None:
    picture.save(window.OUT / f"{name}.webp", quality=QUALITY, method=6)


if __name__ == "__main__":
    window.told.begin(story, window.TICK)
