# SPDX-License-Identifier: GPL-3.0-or-later
"""Nine tasks of an artist in a real window: clicks, seconds, and the time until points are there.

benchmarks/addon/tasks.sh runs this inside Blender on a virtual display. The pointer finds each
button by itself; the way there counts for nothing, nor does naming an object (choosing it in a
field), which scripts do here. A picture shows the end of each task. More clicks than a task's goal
are an error.
"""

import importlib
import json
import os
import sys
import time
from collections.abc import Callable, Generator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy

ROOT = Path(__file__).resolve().parents[2]
OUT = Path(os.environ["DAPPLE_SHOTS"])
for folder in (ROOT, ROOT / "tests" / "blender"):
    sys.path.insert(0, str(folder))
addon_host = importlib.import_module("addon_host")
scenes = importlib.import_module("scenes")
events = importlib.import_module("story")
hand_of = importlib.import_module("hand")

TICK = 0.02
Story = Generator[Any, None, Any]


@dataclass
class Measured:
    """What a task took."""

    name: str
    goal: int
    clicks: int
    seconds: float  # of clicking and waiting, without looking for buttons
    latency: float  # seconds from the last click until the points are there
    modifier: int | None  # clicks with Blender's modifier Scatter on Surface; None: it cannot
    nodes: int | None  # clicks with Blender's node Distribute Points on Faces


measured: list[Measured] = []


def story() -> Story:
    head()
    chosen = [one for one in TASKS if one[0].startswith(tuple(ONLY.split(",")))]
    for name, goal, task, *own in chosen:
        bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
        yield  # now there are windows again
        yield
        try:
            yield from timed(name, goal, task, *(None if one is None else len(one) for one in own))
        except (LookupError, TimeoutError):
            yield from hand_of.shot(OUT / f"failed-{slug_of(name)}.png")
            raise
    over = [f"{one.name}: {one.clicks}" for one in measured if one.clicks > one.goal]
    assert not over, f"more clicks than the goal: {over}"


def timed(name: str, goal: int, task: Callable[..., Story], *own: int | None) -> Story:
    hand = hand_of.Hand()
    prepared = task(hand)
    yield from prepared_until(prepared)
    hand.clicks, hand.searched, begin = 0, 0.0, time.monotonic()
    yield from prepared
    clicked = time.monotonic()
    seconds = clicked - begin - hand.searched
    yield from hand_of.waited(settled)
    latency = time.monotonic() - clicked
    measured.append(Measured(name, goal, hand.clicks, seconds, latency, *own))
    report(measured[-1])
    yield from hand_of.shot(OUT / f"task-{slug_of(name)}.png")


def slug_of(name: str) -> str:
    return name.split(":")[0].replace(" ", "-").lower()


READY: Any = object()  # a task yields this once its scene is there


def prepared_until(task: Story) -> Story:
    for step in task:
        if step is READY:
            return
        yield


def add(hand: Any) -> Story:
    body = scenes.tail(levels=1, render_levels=2)
    yield from shown(body)
    yield READY
    yield from hand.press_button("dapple.add_scatter(")
    yield from hand_of.waited(lambda: bool(scatters()))


def paint(hand: Any) -> Story:
    yield from on_ground()
    yield READY
    yield from hand.press_button("dapple.paint_density(")
    yield from hand_of.waited(lambda: bpy.context.mode == "PAINT_WEIGHT")
    yield from stroke(hand)
    yield from hand.press_button("dapple.finish_painting(")


def classes(hand: Any) -> Story:
    obj = yield from on_ground()
    things = [thing(name) for name in ("Tree", "Bush")]
    yield READY
    for k, one in enumerate(things):
        yield from hand.press_button("dapple.edit_object_types(action='ADD')")
        yield from hand_of.waited(lambda k=k: len(obj.dapple.object_types) > k)
        obj.dapple.object_types[k].instance = one
    yield from hand.slide("object_types[1].fit_to_spacing")
    yield from hand.press_button("dapple.object_type_index")
    yield from hand_of.waited(lambda: obj.dapple.object_type_index == 0)
    yield from hand.slide("object_types[0].fit_to_spacing")


def distance(hand: Any) -> Story:
    obj = yield from on_ground()
    bpy.ops.curve.primitive_bezier_curve_add()
    curve = bpy.context.object
    yield from shown(obj)
    yield READY
    yield from hand.open_panel("density.use_distance", below="dapple.seed")
    yield from hand.press_button("density.use_distance")
    yield from hand_of.waited(lambda: obj.dapple.density.use_distance)
    obj.dapple.density.distance_object = curve


def bake(hand: Any) -> Story:
    body = scenes.tail(frames=24)
    yield from shown(body)
    with over_view():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=400)
    yield from hand_of.waited(lambda: bool(scatters()) and settled())
    yield READY
    yield from hand.press_button("dapple.bake(")
    yield from hand_of.waited(lambda: scatters()[0].dapple.baked_keys > 0)
    region = hand_of.viewport()
    yield from hand.press("SPACE", region.x + 300, region.y + 300)
    yield from hand_of.waited(lambda: bpy.context.scene.frame_current > 12)
    with over_view():
        bpy.ops.screen.animation_cancel(restore_frame=False)


def reuse(hand: Any) -> Story:
    """Dragged from the Asset Browser, in which one file is the library, onto a sphere."""
    yield from on_ground()
    yield from hand_of.asset_library()
    bpy.ops.mesh.primitive_uv_sphere_add(radius=2.0)
    yield from shown(bpy.context.object)
    yield READY
    begin = time.monotonic()
    browser = yield from hand_of.asset_browser()
    hand.searched += time.monotonic() - begin  # a script did it, and waited for long
    hand.clicks += 2  # the menu of editors, and in it the Asset Browser
    yield from hand.drag_asset(browser)


def character(hand: Any) -> Story:
    """A knight of nine meshes that reach into each other, all of them selected."""
    parts = knight()
    yield from shown(parts[0])
    for part in parts:
        part.select_set(True)
    with over_view():
        bpy.ops.view3d.view_selected()
    yield READY
    yield from hand.press_button("dapple.add_scatter(")
    yield from hand_of.waited(lambda: bool(scatters()))
    settings = scatters()[0].dapple
    assert len(settings.surface.dapple.joined.entries) == len(parts)
    assert settings.density.use_outside


def rivets(hand: Any) -> Story:
    """Along the edges of a tank."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=1.0, depth=2.0)
    yield from shown(bpy.context.object)
    yield READY
    yield from hand.press_button("dapple.add_scatter(")
    yield from hand_of.waited(lambda: bool(scatters()) and settled())
    x, y = yield from hand.found("dapple.scatter_on")
    yield from hand.click(x, y)
    yield from hand.press("E", x, y)  # the letter of Edges, underlined in the menu
    yield from hand_of.waited(lambda: scatters()[0].dapple.scatter_on == "EDGES")


def spray(hand: Any) -> Story:
    """A stroke over a path, which is bare."""
    obj = yield from on_ground()
    ground = obj.dapple.surface
    path = ground.vertex_groups.new(name="Path")
    path.add([one.index for one in ground.data.vertices if abs(one.co.y) < 0.6], 1.0, "REPLACE")
    obj.dapple.density.blocked_areas = "Path"
    yield from hand_of.waited(settled)
    before = len(obj.data.vertices)
    yield READY
    tools = hand_of.Hand(hand_of.toolbar)
    yield from tools.press_button("dapple.spray")
    hand.clicks, hand.searched = hand.clicks + tools.clicks, hand.searched + tools.searched
    region = hand_of.viewport()
    middle = region.x + 0.4 * region.width, region.y + 0.5 * region.height
    yield from hand.drag([(middle[0] - 150 + 12 * k, middle[1]) for k in range(26)])
    yield from hand_of.waited(lambda: len(scatters()[0].data.vertices) > before)


def knight() -> list[bpy.types.Object]:
    """Balls, cylinders and boxes, of which each reaches into the next."""
    made = []

    def part(add: Any, place: tuple[float, ...], scale: tuple[float, ...], **options: Any) -> None:
        add(location=place, scale=scale, **options)
        made.append(bpy.context.object)

    mesh = bpy.ops.mesh
    ball = {"segments": 32, "ring_count": 16}
    part(mesh.primitive_uv_sphere_add, (0, 0, 1.6), (0.55, 0.4, 0.75), **ball)
    part(mesh.primitive_uv_sphere_add, (0, 0, 2.5), (0.4, 0.4, 0.45), **ball)
    part(mesh.primitive_cone_add, (0, 0, 3.0), (0.35, 0.35, 0.4), vertices=24)
    for side in (-1, 1):
        part(mesh.primitive_cylinder_add, (side * 0.7, 0, 1.7), (0.16, 0.16, 0.6), vertices=20)
        part(mesh.primitive_cylinder_add, (side * 0.25, 0, 0.6), (0.2, 0.2, 0.6), vertices=20)
    part(mesh.primitive_cube_add, (-0.75, -0.25, 1.3), (0.3, 0.06, 0.4))
    part(mesh.primitive_cube_add, (0, 0, 1.0), (0.5, 0.35, 0.12))
    return made


ONLY = os.environ.get("DAPPLE_TASKS", "")  # beginnings of names, by commas

# What has to be clicked for the same with Blender's own, by its manual; objects and attributes are
# named for nothing there too. None: it cannot do it.
_TO_MODIFIERS = ["Modifiers tab", "Add Modifier"]
_POISSON = ["Distribution Method", "Poisson Disk"]
_NEW_TREE = [*_TO_MODIFIERS, "Geometry Nodes", "New", "Geometry Nodes workspace"]
_NODE = ["Add menu", "the node"]  # then it is dropped, on a link where it has a place there
_WEIGHTS = ["Data tab", "Add Vertex Group", "mode menu", "Weight Paint", "stroke"]
_BACK = ["mode menu", "Object Mode"]
_ADD = (
    [*_TO_MODIFIERS, "Scatter on Surface", *_POISSON],
    [
        *_NEW_TREE,
        *(*_NODE, "drop Distribute Points on Faces", *_POISSON),
        *(*_NODE, "drop Instance on Points", "drag the object in", "link it"),
        *(*_NODE, "drop Join Geometry", "link the surface"),
    ],
)
_PAINT = (
    [*_WEIGHTS, "Modifiers tab", "attribute toggle of the mask", *_BACK],
    [*_WEIGHTS, "link Density to an input", "attribute toggle of the input", *_BACK],
)
_DISTANCE = (
    None,
    [
        "Geometry Nodes workspace",
        "drag the curve in",
        *(*_NODE, "drop Curve to Mesh", "link it"),
        *(*_NODE, "drop Geometry Proximity", "link it"),
        *(*_NODE, "drop Map Range", "link it", "link Density Factor"),
    ],
)
_CHARACTER = (
    [*_ADD[0], "Object menu", "Link/Transfer Data", "Copy Modifiers"],
    [*_ADD[1], "drag the collection in", "link it", *_NODE, "drop Realize Instances"],
)
_RIVETS = (
    None,
    [
        *_NEW_TREE,
        *(*_NODE, "drop Edge Angle", *_NODE, "drop Compare", "link it"),
        *(*_NODE, "drop Mesh to Curve", "link the selection"),
        *(*_NODE, "drop Resample Curve", "mode", "Length"),
        *(*_NODE, "drop Instance on Points", "drag the object in", "link it"),
        *(*_NODE, "drop Join Geometry", "link the surface"),
    ],
)
_NEITHER = (None, None)
TASKS = (  # name, goal of clicks, what is done, and the same with Blender's own
    ("Add: over a character with Subdivision", 4, add, *_ADD),
    ("Paint: where there are more", 3, paint, *_PAINT),
    ("Classes: two object types that fit", 6, classes, *_NEITHER),
    ("Mask: by the distance to a curve", 4, distance, *_DISTANCE),
    ("Bake: and play, each instance in its place", 3, bake, *_NEITHER),
    ("Reuse: of an asset on another surface", 3, reuse, *_NEITHER),
    ("Character: over all of its parts", 3, character, *_CHARACTER),
    ("Rivets: along edges", 4, rivets, *_RIVETS),
    ("Spray: points onto a bare path", 3, spray, *_NEITHER),
)


def on_ground() -> Story:
    """A scatter on a plane, active, with its result."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=4)
    ground = bpy.context.object
    ground.name = "Ground"
    yield from shown(ground)
    with over_view():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=400)
    yield from hand_of.waited(lambda: bool(scatters()) and settled())
    return scatters()[0]


def shown(obj: bpy.types.Object) -> Story:
    """Have it be active and in view, with the sidebar open."""
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    with over_view():
        bpy.ops.view3d.view_selected()
    yield from hand_of.waited(hand_of.tab_is_shown)
    for _ in range(20):
        yield


def thing(name: str) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cone_add(radius1=0.3, depth=1.0, location=(0, 0, -50))
    made = bpy.context.object
    made.name = name
    bpy.context.view_layer.objects.active = scatters()[0]
    return made


def stroke(hand: Any) -> Story:
    """One over the middle of the surface, by a script where this Blender comes without brushes."""
    region = hand_of.viewport()
    if bpy.context.tool_settings.weight_paint.brush is not None:
        middle = region.x + 0.4 * region.width, region.y + 0.5 * region.height
        yield from hand.drag([(middle[0] + 12 * k, middle[1] + 4 * k) for k in range(12)])
        return
    ground = bpy.context.object
    near = [vertex.index for vertex in ground.data.vertices if abs(vertex.co.x) < 0.5]
    ground.vertex_groups.active.add(near, 1.0, "REPLACE")
    ground.data.update()
    hand.clicks += 1
    yield


def scatters() -> list[bpy.types.Object]:
    return [obj for obj in bpy.data.objects if obj.dapple.surface is not None]


def settled() -> bool:
    """Whether the points are those of what is there now."""
    live = addon_host.part("blender.solve.auto_update")
    if live.is_active() or hand_of.window().modal_operators or not scatters():
        return False
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    return not any(stale(obj, bpy.context) or not obj.data.vertices for obj in scatters())


def over_view() -> Any:
    return bpy.context.temp_override(
        window=hand_of.window(), area=hand_of.view(), region=hand_of.viewport()
    )


def head() -> None:
    print("| task | clicks | goal | seconds | points follow in | Scatter on Surface | Nodes |")
    print("|---|---|---|---|---|---|---|", flush=True)


def report(one: Measured) -> None:
    """A row at once: what comes after it may end Blender."""
    (OUT / "tasks.json").write_text(json.dumps([asdict(one) for one in measured], indent=2))
    own = " | ".join("-" if k is None else str(k) for k in (one.modifier, one.nodes))
    row = f"{one.name} | {one.clicks} | {one.goal} | {one.seconds:.1f} | {one.latency:.2f} s"
    print(f"| {row} | {own} |", flush=True)


if __name__ == "__main__":
    events.begin(story, TICK)
