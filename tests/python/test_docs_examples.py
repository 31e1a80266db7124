# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example of the documentation is run: by the tests here, or by those that are named here."""

import csv
import doctest
import importlib
import math
import pkgutil
import re
import shlex
import sys
from pathlib import Path
from unittest.mock import MagicMock, patch

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import run
from dapple3d import instances, tables
from dapple3d.extras._spaces import rotation_matrices

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PYTHON = [name for name in re.findall(r"^\w+$", (DOCS / "site/python/index.md").read_text(), re.M)]
BLOCK = re.compile(r"^```(?P<language>[^\n]*)\n(?P<code>.*?)^```", re.DOTALL | re.MULTILINE)
# The number of examples in each language, and the function that runs them.
RUN = {
    "README.md": {"sh": (1, "tests/run.sh runs the same set-up"), "python": (1, "test_module.py")},
    "CONTRIBUTING.md": {
        "": (1, "a list of folders"),
        "sh": (1, "tests/run.sh runs the same set-up"),
    },
    "native/python/README.md": {
        "sh": (1, "test_distribution.py installs what is built"),
        "python": (1, "test_module.py"),
    },
    "docs/add-on.md": {"python": (3, "tests/blender/test_docs.py")},
    "docs/command-line.md": {"console": (3, "here")},
    "docs/export.md": {
        "sh": (1, "here"),
        "python": (2, "tests/blender/test_docs.py, and here without Unreal"),
        "html": (1, "by hand, with Three.js 168 in Chromium"),
        "csharp": (1, "here its places and turns, without Unity"),
    },
    "docs/development/options.md": {"cpp": (1, "a part of a header")},
    "docs/cpp.md": {
        "sh": (1, "tests/consumer"),
        "cmake": (2, "tests/consumer"),
        "cpp": (1, "tests/consumer, test_module.py"),
    },
    "docs/farm.md": {
        "sh": (3, "tests/blender/command/test_command.py, test_farm.py"),
        "json": (1, "tests/blender/command/test_command.py"),
    },
    "docs/large.md": {"python": (2, "here")},
    "docs/lines.md": {"sh": (1, "here"), "python": (2, "here")},
    "docs/symmetry.md": {"sh": (1, "here"), "python": (1, "here")},
    "docs/masks.md": {"sh": (2, "here"), "python": (1, "here")},
    "docs/remeshing.md": {"sh": (3, "here"), "python": (6, "here")},
    "docs/releasing.md": {"sh": (2, "test_release.py compares them with the workflow")},
    "docs/peers.md": {"sh": (1, "test_peers.py")},
    "docs/stippling.md": {"sh": (1, "here"), "python": (1, "here")},
    "docs/site/index.md": {"console": (1, "here")},
    **{f"docs/site/python/{name}.md": {"python": (1, "here")} for name in ["index", *PYTHON]},
}


def blocks(page: str) -> list[tuple[str, str]]:
    """Languages and code of the examples of a page; directives of Sphinx are none."""
    found = BLOCK.findall((ROOT / page).read_text())
    return [(language, text) for language, text in found if not language.startswith("{")]


def code(page: str, language: str) -> str:
    """All examples of a page in one language."""
    return "\n".join(text for found, text in blocks(page) if found == language)


def code_blocks(page: str) -> list[str]:
    """The examples of a page in Python."""
    return [text for found, text in blocks(page) if found == "python"]


def test_every_example_is_run_by_a_test():
    pages = [*ROOT.glob("*.md"), *DOCS.rglob("*.md"), ROOT / "native/python/README.md"]
    pages += (ROOT / "blend_examples").glob("*.md")
    found = {}
    for page in pages:
        name = str(page.relative_to(ROOT))
        languages = [language for language, _ in blocks(name)]
        if languages:
            found[name] = {language: languages.count(language) for language in languages}
    told = {
        page: {language: count for language, (count, _) in by.items()} for page, by in RUN.items()
    }
    assert found == told


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", PYTHON)
def test_python_pages_run(here, name):
    """Each goes on from the example of the first page."""
    namespace = {}
    for page in ("index", name):
        exec(code(f"docs/site/python/{page}.md", "python"), namespace)


def test_the_page_on_remeshing_runs(here):
    vertices, faces = shapes.torus()
    dapple.write_mesh("part.stl", vertices, faces)
    np.savez("walk.npz", vertices=[vertices, 1.1 * vertices], faces=faces)
    splash = here / "splash"
    splash.mkdir()
    for k in (12, 13):
        dapple.write_mesh(splash / f"{k}.ply", *shapes.torus(2 * k, k))
    for command in filter(None, code("docs/remeshing.md", "sh").splitlines()):
        assert run(*shlex.split(command)[1:]).exit_code == 0
    assert len(list((here / "even").iterdir())) == 2
    first, near, adapted, second, third, fourth = code_blocks("docs/remeshing.md")
    namespace = {}
    exec(first, namespace)
    exec(near, namespace)
    assert namespace["mesh"].report.distance <= 0.01
    exec(adapted.replace("10_000", "300"), namespace)
    assert len(namespace["mesh"]) == 300
    namespace["old_heights"] = namespace["surface"].vertices[:, 2]
    exec(second, namespace)
    np.testing.assert_allclose(namespace["heights"], namespace["mesh"].vertices[:, 2], atol=1e-6)
    namespace["later_frames"] = [1.1 * namespace["surface"].vertices]
    exec(third, namespace)
    assert namespace["moved"].flipped == 0
    namespace["later_surfaces"] = [dapple.Surface(*shapes.torus(24, 12))]
    exec(fourth.replace("3000", "300"), namespace)
    assert namespace["frame"].born < 300


def test_the_page_on_symmetry_runs(here):
    vertices, faces = shapes.grid(6)
    vertices = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    dapple.write_mesh("body.obj", vertices, faces)
    dapple.write_mesh("skull.ply", vertices + np.array([12.5, 0, 0]), faces)
    for command in code("docs/symmetry.md", "sh").splitlines():
        assert run(*shlex.split(command)[1:]).exit_code == 0
    exec(code("docs/symmetry.md", "python"), {})


def test_the_page_on_lines_runs(here):
    dapple.write_mesh("part.stl", *shapes.grid(6))
    dapple.write_mesh("field.obj", *shapes.grid(6))
    commands = code("docs/lines.md", "sh").replace("2.5", "0.25")
    for command in commands.splitlines():
        assert run(*shlex.split(command)[1:]).exit_code == 0
    first, second = (text for name, text in blocks("docs/lines.md") if name == "python")
    namespace = {}
    exec(first, namespace)
    exec(second, namespace)
    moved, made = namespace["there"].positions, namespace["found"].samples.positions
    np.testing.assert_allclose(moved, 2.0 * made, atol=1e-12)


def test_the_page_on_large_surfaces_runs(here):
    """With fewer points than it shows."""
    pytest.importorskip("distributed")
    vertices, faces = shapes.torus()
    Path("shots").mkdir()
    np.savez("shots/walk.npz", vertices=[vertices, shapes.bent(vertices, 0.1)], faces=faces)
    text = code("docs/large.md", "python").replace("40_000", "8_000").replace("10_000", "2_000")
    namespace = {"__name__": "__main__"}
    exec(text, namespace)
    assert len(namespace["pines"]) == 8_000
    assert [file.name for file in namespace["files"]] == ["walk.npz"]


@pytest.fixture
def files(here):
    """What the commands read: a mesh, a motion, a mesh that is wrong, a picture."""
    vertices, faces = shapes.torus()
    dapple.write_mesh("bunny.ply", vertices, faces)
    dapple.write_mesh("part.stl", *shapes.grid(6))
    frames = np.array([shapes.bent(vertices, time) for time in np.linspace(0, 1, 10)])
    np.savez("walk.npz", vertices=frames, faces=faces)
    np.save("hills.npy", np.sin(np.indices((100, 100)) / 9.0).sum(axis=0))
    np.savez("waves.npz", vertices=vertices, faces=faces)
    wrong = vertices.copy()
    wrong[17, 0] = np.nan
    np.savez("scan.npz", vertices=wrong, faces=faces)
    pictures = pytest.importorskip("PIL.Image")
    gray = (255 * np.hypot(*(np.indices((96, 96)) / 140)))[:, :, None].repeat(3, 2)
    pictures.fromarray(gray.astype(np.uint8)).save("portrait.png")
    return here


def form(text: str) -> list[str]:
    """Lines without their numbers and the spaces around them."""
    return [
        re.sub(r"[-\d.,e]*\d[-\d.e]*", "#", " ".join(line.split())) for line in text.splitlines()
    ]


def commands(text: str) -> list[tuple[str, str]]:
    """Each command of a console with what it prints."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    return [(part.partition("\n")[0], part.partition("\n")[2].strip()) for part in parts]


def test_commands_print_what_the_pages_show(files):
    shown = commands(
        code("docs/site/index.md", "console") + code("docs/command-line.md", "console")
    )
    for command, expected in shown:
        program, *arguments = shlex.split(command)
        found = run(*arguments)
        assert program == "dapple"
        assert form(found.output.strip()) == form(expected), command
        assert found.exit_code == int(expected.startswith("Error")), command


def test_the_export_page_runs(files):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    dapple.write_mesh("rock.ply", *shapes.torus())
    for out in ("fern.usda", "plants.csv", "plants.gltf"):
        assert run("sample", "bunny.ply", out, "-n", 50).exit_code == 0
    renamed = Path("plants.gltf").read_text().replace("points_0", "Fern")
    Path("plants.gltf").write_text(renamed)
    assert run("track", "walk.npz", "walk_points.npz", "-n", 50).exit_code == 0
    for command in code("docs/export.md", "sh").splitlines():
        assert run(*shlex.split(command)[1:]).exit_code == 0, command
    assert Path("frame_3.csv").is_file()


@pytest.fixture
def plants(here) -> instances.Instances:
    """Points with the table of them that game engines read."""
    random = np.random.default_rng(1)
    found = instances.Instances(
        random.normal(size=(20, 3)),
        instances.orientations(random.normal(size=(20, 3)), random.normal(size=(20, 3))),
        random.uniform(1, 2, (20, 3)),
        classes=np.arange(20) % 2,
    )
    tables.write("plants_table.csv", [found])
    return found


def check_mirrored(found: list, expected: instances.Instances, axes: np.ndarray) -> None:
    """Compare places and turns x, y, z, w in a space with other axes; a reflection."""
    assert np.linalg.det(axes) < 0
    places, turns = (np.array(values) for values in zip(*found, strict=True))
    np.testing.assert_allclose(places, expected.positions @ axes.T, atol=1e-9)
    unit = axes / np.abs(axes).max()
    turned = rotation_matrices(np.roll(turns, 1, axis=1))
    wanted = unit @ rotation_matrices(expected.orientations) @ unit.T
    np.testing.assert_allclose(turned, wanted, atol=1e-9)


def test_the_script_for_unreal_places_mirrored_instances(here, plants):
    unreal, placed = MagicMock(), []
    unreal.Vector = unreal.Quat = lambda *numbers: MagicMock(
        numbers=numbers, rotator=lambda: numbers
    )
    spawn = unreal.get_editor_subsystem().spawn_actor_from_object
    spawn.side_effect = lambda _mesh, place, turn: (
        placed.append((place.numbers, turn)) or MagicMock()
    )
    script = code_blocks("docs/export.md")[1].replace("C:/", "")
    with patch.dict(sys.modules, {"unreal": unreal}):
        exec(script, {})
    check_mirrored(placed, plants, 100.0 * np.diag([1, -1, 1]))


def test_the_script_for_unity_places_mirrored_instances(here, plants):
    """Its expressions are also those of Python."""
    text = code("docs/export.md", "csharp")
    numbers = [re.search(rf"= new {kind}(\(.*\));", text)[1] for kind in ("Vector3", "Quaternion")]
    with Path("plants_table.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    placed = [[eval(one, {"At": row.__getitem__}) for one in numbers] for row in rows]
    check_mirrored(placed, plants, np.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]]))


def test_the_masks_page_runs(here):
    """With fewer points than it shows."""
    vertices, faces = shapes.grid(20)
    hills = vertices * 20.0 + np.array([0.0, 0.0, 4.0]) * np.sin(5.0 * vertices[:, :1])
    dapple.write_mesh("hills.ply", hills, faces)
    dapple.write_mesh("road.ply", hills[:42], faces[:10] % 42)
    ring, corners = shapes.torus()
    both = np.vstack([ring, ring + np.array([0.5, 0.1, 0.2])])
    dapple.write_mesh("knight.ply", both, np.vstack([corners, corners + len(ring)]))
    dapple.write_mesh("floor.ply", 8.0 * vertices, faces)
    for command in filter(None, code("docs/masks.md", "sh").splitlines()):
        fewer = command.replace("5000", "300").replace("1500", "300").replace("0.2 ", "1.5 ")
        arguments = shlex.split(fewer)[1:]
        assert run(*arguments).exit_code == 0, command
    namespace = {}
    exec(code("docs/masks.md", "python").replace("2000", "300"), namespace)
    assert len(namespace["samples"]) == 300
    assert Path("trees.csv").is_file()


def test_the_stippling_page_runs(files):
    """With fewer dots than it shows."""
    (command,) = code("docs/stippling.md", "sh").splitlines()
    assert run(*shlex.split(command.replace("10000", "300"))[1:]).exit_code == 0
    assert Path("portrait.svg").is_file()
    namespace = {}
    exec(code("docs/stippling.md", "python").replace("10_000", "300"), namespace)
    assert any(Path().glob("*.svg"))
    assert len(namespace["dots"]) == 300


def docstrings() -> list[doctest.DocTest]:
    """The examples in the docstrings of the package."""
    found = []
    for module in pkgutil.walk_packages(dapple.__path__, "dapple3d."):
        if re.search(r"\.(cli|distributed|__main__)\b", module.name):  # docs/large.md is run above
            continue
        try:
            loaded = importlib.import_module(module.name)
        except ImportError:  # an extra whose library is not installed
            continue
        found += doctest.DocTestFinder(exclude_empty=True).find(loaded, module.name)
    found += doctest.DocTestFinder(exclude_empty=True).find(dapple, "dapple3d")
    return [test for test in found if test.examples]


def test_the_examples_in_docstrings_run(files):
    """With fewer points than they show. What they print is not compared: it is arrays."""
    from dapple3d import density

    mesh = shapes.torus()
    surface = dapple.Surface(*mesh)
    names = {"vertices": mesh[0], "faces": mesh[1], "dapple": dapple, "density": density}
    names |= {"math": math, "np": np, "surface": surface, **vars(density)}
    names |= {"picture": np.ones((4, 4, 4)), "uv": np.random.rand(len(mesh[1]), 3, 2)}
    names |= {"samples": dapple.sample(surface, 50), "points": np.random.rand(60, 2)}
    names |= {"next_vertices": mesh[0] * [1.0, 1.0, 1.1]}
    names |= {"next_surface": dapple.Surface(*shapes.torus(36, 18))}
    tests = docstrings()
    assert {"dapple3d", "dapple3d.plot", "dapple3d.density"} <= {test.name for test in tests}
    for test in tests:
        namespace = dict(vars(importlib.import_module(test.globs["__name__"]))) | names
        for example in test.examples:
            source = example.source.replace("10_000", "300").replace("1024", "32")
            exec(compile(source, test.name, "exec"), namespace)
