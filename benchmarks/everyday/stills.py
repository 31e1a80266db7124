# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs on things that stand still."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from benchmarks.everyday import scenes
from benchmarks.everyday.judged import Found, Job, measured, overlap, points, surface_now

COUNT = 1_500


def optimized(obj: Any) -> float:
    """Seconds that Optimize takes, the least of three: others may be at work here."""
    scenes.active(obj)
    taken = []
    for _ in range(3):
        begin = time.perf_counter()
        bpy.ops.dapple.optimize()
        taken.append(time.perf_counter() - begin)
    return min(taken)


def plain(make: Callable[[], Any], *, even: bool = True) -> Callable[[], Found]:
    def run() -> Found:
        surface = make()
        obj = scenes.scatter(surface, COUNT)
        seconds, density = optimized(obj), obj.dapple.density
        outside = density.openness if density.use_outside else None
        found = measured(surface_now(surface), points(obj)[0], even=even, outside=outside)
        return replace(found, seconds=seconds)

    return run


def solid_grid() -> Any:
    obj = scenes.grid(120)
    obj.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.06
    return obj


def solid_monkey() -> Any:
    obj = scenes.monkey()
    obj.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05
    return obj


def dense_grid() -> Any:
    return scenes.grid(120)


def pictured(repeats: float) -> Callable[[], Found]:
    def run() -> Found:
        surface = scenes.grid(60)
        uv = surface.data.uv_layers.active.data
        flat = np.empty(2 * len(uv), dtype=np.float32)
        uv.foreach_get("uv", flat)
        uv.foreach_set("uv", flat * repeats)
        obj = scenes.scatter(surface, COUNT)
        obj.dapple.density.image = picture()
        seconds = optimized(obj)
        return replace(measured(surface_now(surface), points(obj)[0], even=False), seconds=seconds)

    return run


def picture(size: int = 512) -> Any:
    image = bpy.data.images.new("Noise", size, size)
    coarse = 0.2 + 0.8 * np.random.default_rng(0).random((size // 16, size // 16))
    gray = np.kron(coarse, np.ones((16, 16)))
    rgba = np.stack([gray, gray, gray, np.ones_like(gray)], axis=-1)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.update()
    return image


def mixed(*kinds: tuple[int, float], count: int = 1_600) -> Callable[[], Found]:
    def run() -> Found:
        surface = scenes.grid(60, size=20.0)
        obj = scenes.scatter(surface, count)
        scenes.add_types(obj, *kinds)
        seconds = optimized(obj)
        places, names = points(obj)
        share = overlap(places, scenes.radii_of(obj, names))
        reported = obj.dapple.report.worst_overlap
        is_right = abs(max(share, 0.0) - reported) < 1e-3
        wrong = "" if is_right else f"overlap {share:.3f} reported as {reported:.3f}"
        return Found(seconds=seconds, overlap=share, wrong=wrong)

    return run


def masked(change: Callable[[Any, Any], Callable[[Any], Any]]) -> Callable[[], Found]:
    """\\param change sets up the mask and returns which points are where they must not be."""

    def run() -> Found:
        surface = scenes.grid(60)
        obj = scenes.scatter(surface, COUNT)
        forbidden = change(obj, surface)
        seconds = optimized(obj)
        places = points(obj)[0]
        found = measured(surface_now(surface), places, even=False)
        wrong = "" if len(places) == COUNT else f"{len(places)} points"
        inside = int(np.count_nonzero(forbidden(places)))
        return replace(found, seconds=seconds, inside=inside, wrong=wrong)

    return run


def off_cube(obj: Any, _surface: Any) -> Callable[[Any], Any]:
    obj.dapple.density.avoid_collection = scenes.collection_of(scenes.cube(0.8, (0.3, 0.2, 0.0)))
    obj.dapple.density.avoid_margin = 0.0
    return lambda places: (np.abs(places[:, :2] - (0.3, 0.2)) < 0.4 - 1e-4).all(axis=1)


def along_path(obj: Any, _surface: Any) -> Callable[[Any], Any]:
    bpy.ops.curve.primitive_bezier_curve_add()
    path = bpy.context.object
    curve = path.data
    for point, x in zip(curve.splines[0].bezier_points, (-0.8, 0.8), strict=True):
        point.co, point.handle_left_type, point.handle_right_type = (x, 0, 0), "VECTOR", "VECTOR"
    density = obj.dapple.density
    density.use_distance, density.distance_object = True, path
    density.distance_max, density.distance_falloff = 0.2, 0.0
    return lambda places: np.abs(places[:, 1]) > 0.2 + 0.05


def near_border(obj: Any, _surface: Any) -> Callable[[Any], Any]:
    density = obj.dapple.density
    density.use_border, density.border_max, density.border_falloff = True, 0.3, 0.0
    return lambda places: np.abs(places[:, :2]).max(axis=1) < 0.7 - 0.05


def in_view(obj: Any, _surface: Any) -> Callable[[Any], Any]:
    bpy.ops.object.camera_add(location=(0.0, 0.0, 1.5))
    camera = bpy.context.object
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.0
    bpy.context.scene.camera = camera
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = 512
    obj.dapple.density.use_camera_view, obj.dapple.density.camera_margin = True, 0.0
    return lambda places: np.abs(places[:, :2]).max(axis=1) > 0.5 + 0.02


def one_material(obj: Any, surface: Any) -> Callable[[Any], Any]:
    for name in ("Moss", "Stone"):
        surface.data.materials.append(bpy.data.materials.new(name))
    for polygon in surface.data.polygons:
        polygon.material_index = int(polygon.center.x > 0.0)
    scenes.active(obj)
    bpy.ops.dapple.add_material(material="Moss")
    obj.dapple.density.use_material = True
    return lambda places: places[:, 0] > 1e-4


def per_area() -> Found:
    surface = scenes.grid(60)
    surface.scale = (2.0, -1.0, 1.0)
    bpy.context.view_layer.update()
    obj = scenes.scatter(surface, 10)
    obj.dapple.amount, obj.dapple.points_per_area = "PER_AREA", 100.0
    seconds = optimized(obj)
    places = points(obj)[0]
    wrong = "" if len(places) == 800 else f"{len(places)} points on an area of 8"
    return replace(measured(surface_now(surface), places), seconds=seconds, wrong=wrong)


def locked() -> Found:
    surface = scenes.grid(60)
    obj = scenes.scatter(surface, 500)
    optimized(obj)
    before = points(obj)[0]
    for vertex in obj.data.vertices:
        vertex.select = vertex.index < 50
    scenes.active(obj)
    bpy.ops.dapple.lock_points()
    obj.dapple.count = 700
    seconds = optimized(obj)
    after = points(obj)[0]
    stay = sum(np.linalg.norm(after - place, axis=1).min() < 1e-6 for place in before[:50])
    wrong = "" if stay == 50 else f"{50 - stay} locked points moved"
    return replace(measured(surface_now(surface), after), seconds=seconds, wrong=wrong)


def reopened() -> Found:
    obj = scenes.scatter(scenes.grid(60), 500)
    optimized(obj)
    name, before = obj.name, points(obj)[0]
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "file.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
    after = points(bpy.data.objects[name])[0]
    return Found(wrong="" if np.array_equal(before, after) else "other points after opening")


def exported(suffix: str) -> Callable[[], Found]:
    def run() -> Found:
        obj = scenes.scatter(scenes.grid(60), 500)
        optimized(obj)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"points{suffix}"
            bpy.ops.dapple.export_points(filepath=str(path))
            rows = _rows(path)
        return Found(wrong="" if rows == 500 else f"{rows} rows")

    return run


def _rows(path: Path) -> int:
    if path.suffix == ".npz":
        with np.load(path) as found:
            return len(found["positions"])
    return len(path.read_text().splitlines()) - 1


def preset() -> Found:
    obj = scenes.scatter(scenes.grid(60), 500)
    scenes.add_types(obj, (50, 0.05), (0, 0.0))
    bpy.ops.dapple.save_preset(name="everyday")
    other = scenes.scatter(scenes.grid(20), 100)
    bpy.ops.dapple.load_preset(name="everyday")
    kinds = [(kind.count, round(kind.radius, 3)) for kind in other.dapple.object_types]
    bpy.ops.dapple.remove_preset(name="everyday")
    return Found(wrong="" if kinds[:1] == [(50, 0.05)] and len(kinds) == 2 else f"types {kinds}")


def copied() -> Found:
    one, two = scenes.cube(1.0, (0, 0, 0)), scenes.cube(1.0, (2, 0, 0))
    scenes.active(one)
    two.select_set(True)
    bpy.ops.dapple.add_scatter(count=200)
    obj = bpy.context.object
    for each in (one, two, obj):
        each.select_set(True)
    bpy.ops.object.duplicate()
    bpy.ops.transform.translate(value=(0.0, 5.0, 0.0))
    bpy.context.view_layer.update()
    copy = next(each for each in bpy.context.selected_objects if each.dapple.surface)
    apart = points(copy)[0].mean(axis=0) - points(obj)[0].mean(axis=0)
    return Found(wrong="" if np.allclose(apart, (0, 5, 0), atol=0.05) else f"apart by {apart}")


def by_script() -> Found:
    first = scenes.scatter(scenes.grid(20), 100)
    scenes.active(first)
    bpy.ops.dapple.remove_scatter()
    scenes.scatter(scenes.grid(20), 100)
    bpy.ops.dapple.bake()
    return Found()


STILLS = (
    Job("a grid", plain(scenes.grid)),
    Job("a fine grid", plain(dense_grid)),
    Job("Suzanne", plain(scenes.monkey), alpha=0.4, variation=0.03),
    Job("a grid with Solidify", plain(solid_grid), "a fine grid", 4.0, alpha=0.4),
    Job("Suzanne with Solidify", plain(solid_monkey), "Suzanne", 4.0, alpha=0.0, variation=0.05),
    Job("an image", pictured(1.0), "a grid", 3.0),
    Job("an image that repeats 6 times", pictured(6.0), "a grid", 3.0),
    Job("an image that repeats 20 times", pictured(20.0), "a grid", 3.0),
    Job("rocks in grass", mixed((100, 0.4), (0, 0.0)), overlap=1e-3),
    Job("three types with radii", mixed((40, 0.6), (300, 0.2), (0, 0.05)), overlap=1e-3),
    Job("off an object", masked(off_cube)),
    Job("along a path", masked(along_path)),
    Job("near the border", masked(near_border)),
    Job("in the camera's view", masked(in_view)),
    Job("on one material", masked(one_material)),
    Job("by area on a mirrored object", per_area),
    Job("around locked points", locked, variation=0.1, alpha=0.4),
    Job("a file that is opened again", reopened),
    Job("export as CSV", exported(".csv")),
    Job("export as npz", exported(".npz")),
    Job("a preset with object types", preset),
    Job("a copied character", copied),
    Job("remove, add and bake by a script", by_script),
)
