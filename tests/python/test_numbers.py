# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of numpy are numbers, for every parameter of every public function."""

import ast
import shutil
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from dapple3d import instances, stippling, tables, texturing
from dapple3d.extras import gltf, godot, usd
from dapple3d.extras.distributed import HeightField, sample_tiles, track_shot

FEW = {"max_evaluations": 2, "threads": 1}
COLORED = np.array(list(stippling.COLORS.values()), np.uint8).repeat(8, axis=0).reshape(7, 8, 3)
Call = Callable[..., Any]


@cache
def ground() -> dapple.Surface:
    return dapple.Surface(*shapes.torus(24, 12))


@cache
def points() -> dapple.Samples:
    return dapple.sample(ground(), 20, **FEW)


def picture() -> np.ndarray:
    return np.linspace(0.0, 1.0, 64).reshape(8, 8)


def uv() -> np.ndarray:
    return np.tile([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], (len(ground().faces), 1, 1))


def square() -> dapple.Surface:
    return dapple.Surface([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])


def resumed(settled):
    tracker = dapple.Tracker(ground(), points(), **FEW)
    tracker.resume(ground().vertices, points(), settled=settled)
    return tracker.advance(ground().vertices)


def resumed_on(**given):
    tracker = dapple.Tracker(ground(), points(), **FEW)
    tracker.resume_on(ground(), ground().vertices, points(), points(), **given)
    return tracker.advance(1.01 * ground().vertices)


def windowed(done, **given):
    tracker = dapple.WindowTracker(ground(), points(), **FEW | given)
    return tracker.advance([ground().vertices] * 2, done)


def tracked(kind, **given):
    return kind(ground(), points(), **given).advance(1.01 * ground().vertices)


def part_of(start, end):
    whole = dapple.Context()
    whole.part(start, end).advance(1.0)
    return whole.progress


def advanced(progress):
    context = dapple.Context()
    context.advance(progress)
    return context.progress


def baked(rows, columns, **given):
    decal = texturing.Decal(np.ones((2, 2, 4)), 0.2)
    return texturing.bake(ground(), uv(), points(), [decal], rows, columns, **given)


def dots(**given):
    return stippling.Dots(
        np.array([[2.0, 2.0], [5.0, 3.0]]),
        np.zeros(2, np.int32),
        **{"radius": 1.0, "inks": ("black",), "size": (8, 8), "report": points().report} | given,
    )


def written(module, suffix, folder, **given):
    path = folder / f"points{suffix}"
    frames = instances.of_samples(points())
    module.write(path, [frames] if module is tables else frames, **given)
    return path.read_bytes()


def tiles(folder, **given):
    field = HeightField(np.outer(np.sin(np.arange(20)), np.ones(20)))
    return list(sample_tiles(field, folder / "tiles", **given).tiles())


def shot(folder, **given):
    vertices, faces = shapes.torus(24, 12)
    np.savez(folder / "shot.npz", vertices=np.array([vertices, 1.01 * vertices]), faces=faces)
    return list(track_shot(folder / "shot.npz", **given).values())[:-1]


# For each function, its numbers that are not options.
WITH_OPTIONS: dict[str, tuple[Call, dict[str, Any]]] = {
    "Tracker": (lambda **given: tracked(dapple.Tracker, **given), {"classes": [20]}),
    "Population": (lambda **given: tracked(dapple.Population, **given), {"classes": [20]}),
    "WindowTracker": (lambda **given: windowed(1, **given), {"classes": [20]}),
    "track_window": (
        lambda **given: dapple.track_window(ground(), points(), [ground().vertices] * 2, **given),
        {"classes": [20]},
    ),
    "sample": (lambda **given: dapple.sample(ground(), **given), {"count": 9}),
    "resample": (lambda **given: dapple.resample(ground(), points(), **given), {"count": 9}),
    "relax": (lambda **given: dapple.relax(ground(), points(), [1], **given), {"classes": [21]}),
    "evaluate_energy": (
        lambda **given: dapple.evaluate_energy(
            ground(), points().positions, points().faces, **given
        ),
        {},
    ),
    "remesh": (lambda **given: dapple.remesh(ground(), **given), {"count": 9}),
    "remesh_next": (
        lambda **given: (
            dapple.remesh_next(ground(), dapple.remesh(ground(), 9), ground(), **given).mesh
        ),
        {"capacity": 0.5},
    ),
    "sample_symmetric": (
        lambda **given: dapple.sample_symmetric(ground(), **{"max_mirror_error": 1.0, **given}),
        {"count": 9},
    ),
    "sample_lines": (lambda **given: dapple.sample_lines(ground(), **given), {"count": 9}),
    "mosaic": (lambda **given: dapple.mosaic(ground(), points(), **given), {"merge": True}),
    "analyze": (lambda **given: dapple.analyze(ground(), points(), **given), {}),
    "refine_image": (
        lambda **given: dapple.refine_image(square(), uv()[:2], picture(), **given),
        {"max_faces": 1000},
    ),
    "sample, in a plane": (lambda **given: dapple.sample(dapple.Torus(), **given), {"count": 9}),
    "evaluate_energy, in a plane": (
        lambda **given: dapple.evaluate_energy(dapple.Torus(), [[0.1, 0.2], [0.5, 0.7]], **given),
        {},
    ),
    "sample_classes": (
        lambda **given: dapple.sample_classes(ground(), **given),
        {"classes": [5, 4]},
    ),
    "sample_classes, in a plane": (
        lambda **given: dapple.sample_classes(dapple.Torus(), **given),
        {"classes": [5, 4]},
    ),
    "stipple_inks": (
        lambda **given: dapple.stipple_inks(picture()[None], **given),
        {"count": 9, "counts": [9]},
    ),
}
OTHERS: dict[str, tuple[Call, dict[str, Any]]] = {
    "curvature_density": (
        lambda **given: dapple.curvature_density(ground(), **given),
        {"exponent": 0.5, "floor": 0.25, "percentile": 90.0, "smoothing": 1},
    ),
    "curvedness": (lambda **given: dapple.curvedness(ground(), **given), {"smoothing": 1}),
    "refine_obstacles": (
        lambda radii, **given: dapple.refine_obstacles(square(), [[0.5, 0.5, 0.0]], radii, **given),
        {"radii": 0.25, "edge": 0.5, "max_faces": 1000},
    ),
    "reached_by_solids": (
        lambda **given: dapple.reached_by_solids(
            ground().vertices, ground().faces, square().vertices, [4], **given
        ),
        {"margin": 0.5},
    ),
    "touching_solids": (
        lambda **given: dapple.touching_solids(ground().vertices[:8], [4, 4], **given),
        {"margin": 0.5},
    ),
    "refine_outside": (
        lambda **given: dapple.refine_outside(square(), **given),
        {"edge": 0.5, "openness": 0.25, "max_faces": 1000},
    ),
    "refine_edges": (
        lambda **given: dapple.refine_edges(square(), **given),
        {"longest": 0.5, "max_faces": 1000},
    ),
    "surface_spectrum": (
        lambda **given: dapple.surface_spectrum(ground(), points(), **given),
        {"radius": 4.0, "bins": 16, "threads": 1},
    ),
    "spectrum": (
        lambda **given: dapple.spectrum([[0.1, 0.2], [0.5, 0.7]], **given),
        {"half_width": 8, "threads": 1},
    ),
    "Context.part": (part_of, {"start": 0.25, "end": 0.75}),
    "Context.advance": (advanced, {"progress": 0.5}),
    "Surface": (
        lambda **given: dapple.Surface(*shapes.torus(24, 12), **given),
        {"weld": 0.5, "sharp_angle": 32.0, "merge_doubled": True},
    ),
    "Surface.spacing": (lambda count: ground().spacing(count), {"count": 9}),
    "Surface.count": (lambda spacing: ground().count(spacing), {"spacing": 0.25}),
    "SampleClass": (
        lambda **given: dapple.sample_classes(ground(), [dapple.SampleClass(**given)], **FEW),
        {"count": 9, "radius": 0.25},
    ),
    "FlatDomain.spacing": (lambda count: dapple.Torus().spacing(count), {"count": 9}),
    "Plane": (
        lambda **given: dapple.sample(dapple.Plane(**given), 9, **FEW),
        {"width": 2.0, "height": 1.0},
    ),
    "relax": (
        lambda count: dapple.relax(ground(), points(), [1], count=count, **FEW),
        {"count": 21},
    ),
    "Tracker.resume": (resumed, {"settled": True}),
    "Tracker.resume_on": (resumed_on, {"classes": [20], "anywhere": True}),
    "WindowTracker.advance": (windowed, {"done": 1}),
    "texels": (
        lambda **given: dapple.texels(ground(), uv(), **given),
        {"rows": 8, "columns": 8, "margin": 1},
    ),
    "track_pieces": (
        lambda **given: list(
            dapple.track_pieces(ground(), points(), [ground().vertices] * 3, **FEW | given)
        ),
        {"piece": 2, "overlap": 1},
    ),
    "instances.with_velocities": (
        lambda fps: instances.with_velocities([instances.of_samples(points())] * 2, fps),
        {"fps": 24},
    ),
    "texturing.turns": (lambda seed: texturing.turns([1, 2], seed), {"seed": 3}),
    "texturing.Decal": (
        lambda radius: float(texturing.Decal(np.ones((2, 2, 4)), radius).radius),
        {"radius": 0.5},
    ),
    "texturing.bake": (
        baked,
        {
            **{"rows": 4, "columns": 4, "oversampling": 2, "margin": 1},
            "background": [0.0, 0.25, 1.0, 1.0],
        },
    ),
    "stippling.stipple": (
        lambda **given: stippling.stipple(COLORED, **given, **FEW),
        {"count": 9, "counts": [1, 1, 1, 1, 1, 1, 3]},
    ),
    "stippling.draw": (lambda scale: stippling.draw(dots(), scale), {"scale": 2.0}),
    "stippling.to_png": (lambda scale: stippling.to_png(dots(), scale), {"scale": 2.0}),
    "stippling.encode": (lambda scale: stippling.encode(dots(), ".png", scale=scale), {"scale": 2}),
    "stippling.Dots": (lambda **given: stippling.to_pdf(dots(**given)), {"radius": 0.5}),
    "stippling.Dots.size": (
        lambda size: [
            make(dots(size=size)) for make in (stippling.to_svg, stippling.to_pdf, stippling.draw)
        ],
        {"size": (8, 200)},
    ),
    "gltf.write": (
        lambda folder, **given: written(gltf, ".glb", folder, **given),
        {"meters_per_unit": 0.5},
    ),
    "godot.write": (
        lambda folder, **given: written(godot, ".tscn", folder, **given),
        {"meters_per_unit": 0.5},
    ),
    "tables.write": (
        lambda folder, **given: written(tables, ".csv", folder, **given),
        {"times": [5]},
    ),
    "usd.write": (
        lambda folder, **given: written(usd, ".usda", folder, **given),
        {"fps": 24, "meters_per_unit": 0.5, "times": [5]},
    ),
    "sample_tiles": (
        lambda folder, **given: tiles(folder, **given),
        {"count": 9, "tile": 2048, "seed": 3, "threads": 1, "tolerance": 0.25, "progress": False},
    ),
    "HeightField": (
        lambda step, origin: [
            HeightField(picture(), step, origin).describe(),
            HeightField(picture(), step, origin).read((0, 9), (0, 9)).vertices,
        ],
        {"step": (1, 2), "origin": (0.5, 3.0)},
    ),
    "track_shot": (
        lambda folder, **given: shot(folder, **given),
        {"count": 9, "seed": 3, "threads": 1},
    ),
}


def options_of(verb: str) -> dict[str, Any]:
    """The defaults, but for those that would take long."""
    return {option.name: option.default for option in dapple.option_table(verb.split(",")[0])
            if option.type != "str"}  # fmt: skip


def all_cases() -> Iterator[tuple[str, Call, dict[str, Any], str]]:
    for name, (call, others) in WITH_OPTIONS.items():
        numbers = options_of(name)
        numbers |= {key: value for key, value in FEW.items() if key in numbers}
        for parameter in [*others, *numbers]:
            yield name, call, others | numbers, parameter
    for name, (call, numbers) in OTHERS.items():
        for parameter in numbers:
            yield name, call, numbers, parameter


CASES = {f"{name}-{parameter}": (call, numbers, parameter)
         for name, call, numbers, parameter in all_cases()}  # fmt: skip


def kinds_of(value: Any) -> list[Callable[[Any], Any]]:
    """Types of numpy that hold a number exactly."""
    if isinstance(value, list | tuple):
        return [np.asarray, *({kind for one in value for kind in kinds_of(one)})]
    if isinstance(value, bool):
        return [np.bool_]
    if isinstance(value, int):
        return [np.int64, np.int32, np.uint64, *([np.uint8] if 0 <= value < 256 else [])]
    return [np.float64, *([np.float32] if np.float32(value) == value else [])]


def as_kind(kind: Callable[[Any], Any], value: Any) -> Any:
    if isinstance(value, list | tuple) and kind is not np.asarray:
        return type(value)(kind(one) for one in value)
    return kind(value)


def content(value: Any) -> Any:
    """What can be compared."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, list | tuple):
        return [content(one) for one in value]
    if isinstance(value, dict):
        return {key: content(one) for key, one in value.items()}
    if isinstance(value, bool | int | float | str | bytes | type(None)):
        return value
    if isinstance(value, dapple.Report):
        return None
    names = [name for name in dir(value) if not name.startswith("_") and name != "report"]
    found = {name: getattr(value, name) for name in names}
    return {name: content(one) for name, one in found.items() if not callable(one)
            and not isinstance(one, dapple.Surface)}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_number_of_numpy_is_a_number(tmp_path, name):
    call, numbers, parameter = CASES[name]

    def result(given: dict[str, Any]) -> Any:
        shutil.rmtree(tmp_path / "tiles", ignore_errors=True)
        folder = {"folder": tmp_path} if "folder" in call.__code__.co_varnames else {}
        return content(call(**folder, **given))

    expected = result(numbers)
    for kind in kinds_of(numbers[parameter]):
        given = numbers | {parameter: as_kind(kind, numbers[parameter])}
        assert result(given) == expected, kind


def numbers_of_stubs() -> Iterator[str]:
    """Functions and classes of the package, with each parameter that is a number."""
    folder = Path(dapple.__file__).parent
    extras = folder / "extras"
    files = [folder / "_native.pyi", *folder.glob("*.py"), *extras.glob("*.py")]
    for path in [*files, extras / "distributed/tiling.py"]:
        module = "" if path.stem in ("_native", "_pieces", "tiling") else f"{path.stem}."
        if path.stem.startswith("_") and module:
            continue
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                yield from _parameters(node, f"{module}{node.name}")
            if isinstance(node, ast.ClassDef):
                for inner in node.body:
                    if isinstance(inner, ast.FunctionDef):
                        own = "" if inner.name == "__init__" else f".{inner.name}"
                        yield from _parameters(inner, f"{module}{node.name}{own}")


def _parameters(node: ast.FunctionDef, name: str) -> Iterator[str]:
    hidden = node.name.startswith("_") and node.name != "__init__"
    if hidden or any(isinstance(one, ast.Name) for one in node.decorator_list):
        return
    for one in [*node.args.args, *node.args.kwonlyargs]:
        words = {word.id for word in ast.walk(one) if isinstance(word, ast.Name)}
        if words & {"int", "float", "bool"}:
            yield f"{name}-{one.arg}"


def test_every_number_of_the_package_is_tried():
    left_out = {
        # like their siblings
        *("gltf.write_scatters", "usd.write_scatters", "godot.write_scatters", "stippling.write"),
        # internal functions
        "instances.check_faces",
    }
    found = {one for one in numbers_of_stubs() if one.partition("-")[0] not in left_out}
    assert len(found) > 100
    assert found - {*CASES, "sample_tiles-workers"} == set()
