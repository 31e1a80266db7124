# SPDX-License-Identifier: GPL-3.0-or-later
"""An option stands once, beside the C++ struct: all else is made of its line in the table."""

from __future__ import annotations

import dataclasses
import importlib
import json
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import click
import dapple3d as dapple
import pytest
from dapple3d.cli import options as flags
from shapes import grid

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import option_headers
import option_tables

HEADER = "native/include/dapple/optimizer.hpp"
PRINTER = "tests/python/print_options.cpp"
MEMBER = """  /// Share of a step that is held back.
  double damping = 0.25;  // basic, 0..1, spacings
"""
VERBS = dapple._native._verbs
TABLES = option_tables.tables()


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory, root: Path) -> Path:
    """A copy of what the tables are made in and written to, with one option more."""
    copy = tmp_path_factory.mktemp("scratch")
    for folder in ("native/include", "native/python"):
        shutil.copytree(root / folder, copy / folder)
    for file in (option_tables.PAGE, PRINTER):
        (copy / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / file, copy / file)
    header = copy / HEADER
    text = header.read_text()
    text = re.sub(r"(struct OptimizerOptions \{\n)", rf"\1{MEMBER}", text, count=1)
    header.write_text(text)
    for path, content in option_headers.written(copy).items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    return copy


@pytest.fixture(scope="module")
def tables(scratch: Path) -> option_tables.Tables:
    """The tables of the copy, read by a program of its headers alone."""
    compiler = shutil.which("c++")
    if compiler is None:
        pytest.skip("there is no compiler c++")
    program = scratch / "print_options"
    folders = [scratch / "native/include", scratch / "native/python", eigen()]
    includes = [f"-I{folder}" for folder in folders]
    command = [compiler, "-std=c++20", *includes, str(scratch / PRINTER), "-o", str(program)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    return {
        verb: [SimpleNamespace(**one) for one in rows] for verb, rows in json.loads(printed).items()
    }


def eigen() -> Path:
    """Where Eigen's headers are; the test is skipped where that is not known."""
    for folder in (Path("/usr/include/eigen3"), Path("/usr/local/include/eigen3")):
        if folder.is_dir():
            return folder
    pytest.skip("Eigen's headers are not found")


@pytest.mark.parametrize("verb", ["sample", "sample_classes", "Tracker", "stipple_inks"])
def test_a_new_option_is_in_every_verb(tables, verb):
    (found,) = [option for option in tables[verb] if option.name == "damping"]
    assert (found.type, found.default, found.min, found.max) == ("float", 0.25, 0.0, 1.0)
    assert (found.range, found.unit, found.level) == ("0..1", "spacings", "basic")


def test_a_new_option_is_written_by_hand_in_one_header(scratch, root, tables):
    """Beside the source that uses it and, for the add-on, the German text of its tooltip."""
    generated = option_tables.written(scratch, tables)
    changed = {str(path.relative_to(scratch)) for path in option_tables.stale(generated)}
    assert changed == {option_tables.STUBS, option_tables.PAGE}
    stubs = generated[scratch / option_tables.STUBS]
    takers = [verb for verb, rows in tables.items() if any(o.name == "damping" for o in rows)]
    assert stubs.count(" damping: float = 0.25,\n") == len(takers) + 2 == 14, "two have overloads"
    assert "| `damping` | `0.25` | 0..1 | spacings |" in generated[scratch / option_tables.PAGE]
    for name in (option_headers.HEADER, option_headers.SOURCE):
        ours, theirs = (scratch / name).read_text(), (root / name).read_text()
        assert (ours != theirs) == (name == option_headers.HEADER)


def test_a_new_option_is_a_flag(tables):
    (option,) = [option for option in tables["sample"] if option.name == "damping"]
    command = flags.library_option(option)(click.command(lambda damping: None))
    (flag,) = command.params
    assert flag.opts == ["--damping"]
    assert (flag.type.min, flag.type.max) == (0.0, 1.0)
    assert flag.help == "Share of a step that is held back. In spacings.  [default: 0.25]"


@pytest.fixture
def core(tables, root, monkeypatch):
    """Modules of the add-on's core, as they are where the package has the option more."""
    monkeypatch.setattr(dapple, "option_table", tables.__getitem__)
    yield from fresh_core(root, monkeypatch)


@pytest.fixture
def core_alone(root, monkeypatch):
    """The same where there is no package."""
    monkeypatch.setitem(sys.modules, "dapple3d", None)
    yield from fresh_core(root, monkeypatch)


def fresh_core(root, monkeypatch):
    """A function that imports a module of the add-on's core, as if it had not been."""
    monkeypatch.syspath_prepend(root)
    before = {name: module for name, module in sys.modules.items() if belongs_to_addon(name)}
    for name in before:
        del sys.modules[name]
    yield lambda name: importlib.import_module(f"addon.core.{name}")
    for name in filter(belongs_to_addon, list(sys.modules)):
        del sys.modules[name]
    sys.modules.update(before)


def belongs_to_addon(name):
    return name.split(".")[0] == "addon"


def test_a_new_option_is_a_setting_of_the_add_on(core):
    (setting,) = [one for one in core("settings.tables").GROUPS[""] if one.name == "damping"]
    assert (setting.kind.name, setting.default) == ("NUMBER", 0.25)
    assert (setting.low, setting.high) == (0.0, 1.0)
    assert setting.label == "Damping"
    assert setting.tooltip == "Share of a step that is held back. In spacings"
    assert setting in core("settings.solver_options").EVENNESS, "a row of the panel"
    assert "damping" in core("settings.presets").NAMES[""]
    assert core("settings.solver_options").quality_settings("REGULAR")["damping"] == 0.25


def test_a_new_option_of_the_add_on_reaches_the_solver_and_the_check(core):
    stale, settings = core("solve.stale"), core("settings.values").Settings()
    changed = dataclasses.replace(settings, damping=0.5)
    assert changed.sample_options()["damping"] == changed.tracker_options()["damping"] == 0.5
    assert stale.changed_settings(stale.settings_text(settings), changed) == ["damping"]
    older = json.loads(stale.settings_text(settings))
    del older["damping"]
    assert stale.changed_settings(json.dumps(older), settings) == [], "solved without it"
    assert stale.changed_settings(json.dumps(older), changed) == ["damping"]


def test_a_new_option_touches_no_page_of_the_add_on(core, root):
    assert any(one.name == "damping" for one in core("settings.solver_options").SAMPLE)
    script = runpy.run_path(str(root / "scripts/setting_tables.py"))
    page = script["PAGE"].read_text()
    assert script["written"](page) == page


def test_the_add_on_has_no_options_without_the_package(core_alone):
    assert (
        core_alone("settings.solver_options").SAMPLE
        == core_alone("settings.solver_options").MOTION
        == ()
    )
    settings = core_alone("settings.values").Settings()
    assert (settings.count, settings.sample_options()) == (1000, {})
    assert "seed" not in core_alone("settings.presets").NAMES[""]


def test_a_motion_keeps_its_own_limit_of_evaluations(core):
    options = core("settings.values").Settings().tracker_options()
    assert {"stickiness", "tolerance"} <= options.keys()
    assert not {"seed", "max_evaluations"} & options.keys()


def test_settings_of_the_add_on_are_reported_as_they_are(root):
    """scripts/setting_tables.py --write mends it."""
    command = [sys.executable, str(root / "scripts/setting_tables.py")]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.parametrize("name", ["repulsion_weight", "max_evaluations"])
def test_the_add_on_gives_words_to_an_option_in_one_place(root, name):
    """Beside that, presets of quality set some, and the panel looks at the limit."""
    sources = (root / "addon").rglob("*.py")
    naming = {path.name for path in sources if re.search(rf"\b{name}\b", path.read_text())}
    assert naming - {"results_panel.py"} == {"solver_options.py"}


@pytest.mark.parametrize("name", ["repulsion_weight", "pattern_strength", "longest_motion"])
def test_bindings_and_command_line_do_not_name_options(root, name):
    package = root / "native/python"
    sources = [*package.glob("*.?pp"), *package.glob("dapple3d/cli/**/*.py")]
    assert len(sources) > 25
    assert not [str(path) for path in sources if re.search(rf"\b{name}\b", path.read_text())]


def test_what_is_written_is_as_the_tables_say(root):
    """scripts/option_tables.py --write mends it."""
    assert not option_tables.stale(option_tables.written(root, TABLES))


def test_the_tables_in_the_headers_are_as_the_structs_say(root):
    """scripts/option_headers.py --write mends it."""
    assert not option_headers.stale(option_headers.written(root))


@pytest.mark.parametrize(
    ("member", "message"),
    [
        ("  double damping = 0.25;  // basic, >= 0\n", "OptimizerOptions::damping has no sentence"),
        ("  /// Share.\n  double damping = 0.25;  // basic, low\n", "damping: 'low' is no range"),
    ],
)
def test_names_a_member_whose_comment_is_wrong(tmp_path, root, member, message):
    shutil.copytree(root / "native/include", tmp_path / "native/include")
    header = tmp_path / HEADER
    header.write_text(
        header.read_text().replace(
            "struct OptimizerOptions {\n", "struct OptimizerOptions {\n" + member
        )
    )
    with pytest.raises(ValueError, match=message):
        option_headers.written(tmp_path)


def test_a_default_of_another_number_is_found(root):
    stubs = root / option_tables.STUBS
    wrong = stubs.read_text().replace("tolerance: float = 5e-05", "tolerance: float = 1.0", 1)
    assert wrong != stubs.read_text()
    assert option_tables.with_options(wrong, TABLES) == stubs.read_text()


@pytest.mark.parametrize("verb", VERBS)
def test_every_option_is_reported(verb):
    for option in TABLES[verb]:
        assert re.fullmatch(r"[A-Z].*\w[).]*\.", option.documentation), option.name
        assert option.level in ("basic", "expert")
        assert option.choices or option.type != "str"
    names = [option.name for option in TABLES[verb]]
    assert len(names) == len(set(names))


def test_refuses_a_verb_without_a_table():
    with pytest.raises(ValueError, match="verb is 'projekt'"):
        dapple.option_table("projekt")


# Arguments by name

SURFACE = dapple.Surface(*grid(1))
CALLS = {
    "sample": lambda **k: dapple.sample(SURFACE, 2, **k),
    "relax": lambda **k: dapple.relax(SURFACE, two(), [0], **k),
    "resample": lambda **k: dapple.resample(SURFACE, two(), 2, **k),
    "sample_classes": lambda **k: dapple.sample_classes(SURFACE, [2], **k),
    "evaluate_energy": lambda **k: dapple.evaluate_energy(
        SURFACE, two().positions, two().faces, **k
    ),
    "analyze": lambda **k: dapple.analyze(SURFACE, two(), **k),
    "Tracker": lambda **k: dapple.Tracker(SURFACE, two(), **k),
    "Population": lambda **k: dapple.Population(SURFACE, two(), **k),
    "track_window": lambda **k: dapple.track_window(SURFACE, two(), [SURFACE.vertices], **k),
    "WindowTracker": lambda **k: dapple.WindowTracker(SURFACE, two(), **k),
    "stipple_inks": lambda **k: dapple.stipple_inks([[[1.0, 1.0]]], 2, **k),
    "mosaic": lambda **k: dapple.mosaic(SURFACE, two(), **k),
    "remesh": lambda **k: dapple.remesh(SURFACE, 4, **k),
    "remesh_next": lambda **k: dapple.remesh_next(
        SURFACE, dapple.remesh(SURFACE, 4), SURFACE, 0.25, **k
    ),
    "sample_symmetric": lambda **k: dapple.sample_symmetric(
        SURFACE, 4, **{"point": SURFACE.vertices.mean(axis=0), **k}
    ),
    "sample_lines": lambda **k: dapple.sample_lines(SURFACE, 4, **k),
    "refine_image": lambda **k: dapple.refine_image(SURFACE, [[[0, 0]] * 3] * 2, [[1.0]], **k),
}
NUMBERS = [(verb, o) for verb in VERBS for o in TABLES[verb] if o.type in ("int", "float")]
NAMES = [f"{verb}-{option.name}" for verb, option in NUMBERS]


def two() -> dapple.Samples:
    return dapple.Samples(SURFACE, [0, 1], [[1 / 3] * 3] * 2)


@pytest.mark.parametrize("verb", VERBS)
def test_names_an_argument_that_is_not_known(verb):
    message = re.escape(f"{verb}() got an unexpected keyword argument 'speed'")
    with pytest.raises(TypeError, match=message):
        CALLS[verb](speed=1)


@pytest.mark.parametrize("verb", VERBS)
def test_takes_its_defaults(verb):
    CALLS[verb](**{option.name: option.default for option in TABLES[verb]})


@pytest.mark.parametrize(("verb", "option"), NUMBERS, ids=NAMES)
def test_names_an_option_out_of_range(verb, option):
    too_large = [] if option.max is None else [option.max + 1]
    for bad in [option.min - 1, *too_large, 10**400]:
        with pytest.raises(ValueError, match=rf"^{option.name} is "):
            CALLS[verb](**{option.name: bad})


@pytest.mark.parametrize(("verb", "option"), NUMBERS, ids=NAMES)
@pytest.mark.parametrize("bad", ["much", None, [1]])
def test_names_an_option_that_is_no_number(verb, option, bad):
    with pytest.raises(TypeError, match=rf"^{option.name} is .*: a (whole )?number is needed"):
        CALLS[verb](**{option.name: bad})


def test_names_what_is_no_choice_and_no_flag():
    with pytest.raises(ValueError, match="start is 'sobol': it must be 'poisson' or 'random'"):
        dapple.sample(SURFACE, 2, start="sobol")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="method is 3: text is needed"):
        dapple.sample(SURFACE, 2, method=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="two_stages is 'no': True or False is needed"):
        dapple.sample_classes(SURFACE, [2], two_stages="no")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"context is 3: a Context or None is needed"):
        dapple.sample(SURFACE, 2, context=3)  # type: ignore[arg-type]
