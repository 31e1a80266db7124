# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: what it writes, what it says, and what it refuses."""

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from dataclasses import replace
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused, run
from dapple3d.cli import commands, points, work
from dapple3d.cli.app import main
from dapple3d.cli.options import library_defaults

COMMANDS = [
    "analyze",
    "classes",
    "lines",
    "mosaic",
    "relax",
    "remesh",
    "resample",
    "sample",
    "stipple",
    "track",
]


FORMATS = [".ply", ".csv", ".npz", ".obj", ".off"]


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "dapple3d", *map(str, arguments)]


def test_starts_as_a_module():
    found = subprocess.run(command("--help"), capture_output=True, text=True, check=False)
    assert found.returncode == 0
    assert all(name in found.stdout for name in COMMANDS)
    assert found.stderr == ""


def test_starts_as_a_script():
    if Path(dapple.__file__).parents[1].resolve() != Path(sysconfig.get_path("purelib")).resolve():
        pytest.skip("this dapple3d is not installed beside the Python that runs")
    script = Path(sysconfig.get_path("scripts")) / "dapple"
    found = subprocess.run([script, "--version"], capture_output=True, text=True, check=False)
    assert found.stdout == f"dapple, version {dapple.__version__}\n"


def test_the_package_does_not_need_click():
    code = "import dapple3d, sys; sys.exit('click' in sys.modules)"
    found = subprocess.run(
        [sys.executable, "-c", code],
        check=False,
        preexec_fn=hear_ctrl_c if os.name == "posix" else None,
    )
    assert found.returncode == 0


def test_says_when_click_is_missing():
    code = (
        "import importlib.util as util, runpy; found = util.find_spec\n"
        "util.find_spec = lambda name, *rest: None if name == 'click' else found(name, *rest)\n"
        "runpy.run_module('dapple3d', run_name='__main__')"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.returncode == 1
    assert found.stderr == (
        "Error: the command line needs click, which is missing: pip install click\n"
    )


def hear_ctrl_c():
    """In a new process: one that a shell has begun in the background ignores it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.mark.parametrize("imported", ["numpy", "click"])
@pytest.mark.parametrize("start", ["module", "script"])
def test_ctrl_c_while_modules_are_imported_prints_no_traceback(tmp_path, imported, start):
    package = tmp_path / "first" / imported
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("import os, signal; os.kill(os.getpid(), signal.SIGINT)")
    script = tmp_path / "dapple"
    script.write_text("from dapple3d.__main__ import start\nstart()\n")
    program = ["-m", "dapple3d"] if start == "module" else [script]
    found = subprocess.run(
        [sys.executable, *program, "--help"],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(package.parent)},
        preexec_fn=hear_ctrl_c if os.name == "posix" else None,
    )
    assert (found.returncode, found.stdout) == (130, "")
    assert found.stderr == "Cancelled: nothing was written.\n"


def test_a_program_that_imports_the_package_keeps_its_ctrl_c(tmp_path):
    code = (
        "import signal, dapple3d, dapple3d.cli.app\n"
        "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("name", COMMANDS)
def test_helps_with_an_example_and_the_librarys_defaults(name):
    text = " ".join(done(name, "--help").stdout.split())
    assert f"Examples: dapple {name} " in text


@pytest.mark.parametrize(
    ("name", "verb", "missing"),
    [
        ("analyze", "analyze", set()),
        ("classes", "sample_classes", set()),
        ("relax", "relax", set()),
        ("resample", "resample", set()),
        ("sample", "sample", set()),
        ("track", "Tracker", {"union_weight"}),
    ],
)
def test_help_shows_the_librarys_defaults(name, verb, missing):
    subcommand = main.get_command(main.make_context("dapple", [name]), name)
    shown = {option.name: option.help for option in subcommand.params if hasattr(option, "help")}
    defaults = library_defaults(verb)
    assert set(defaults) - set(shown) == missing
    for argument in set(defaults) - missing - {"two_stages", "free_counts"}:
        assert shown[argument].endswith(f"[default: {defaults[argument]}]")


def test_reads_defaults_from_the_library():
    found = library_defaults("sample")
    assert found["start"] == "poisson"
    assert found["capacity_weight"] == 30.0
    assert found["seed"] == 0
    assert "context" not in found


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_format_keeps_every_digit(tmp_path, suffix, samples):
    path = tmp_path / f"points{suffix}"
    random = np.random.default_rng(0)
    columns = {"orientations": 4, "scales": 3, "velocities": 3}
    more = {name: random.normal(size=(len(samples), n)) for name, n in columns.items()}
    stored = replace(points.points_of(samples), prototypes=samples.classes + 1, **more)
    points.write_points(path, stored)
    found = points.read_points(path).arrays()
    lost = {
        ".obj": {"ids", "classes", "faces", "barycentric", "prototypes", *columns},
        ".csv": {"faces", "barycentric"},
        ".npz": set(),
    }
    lost |= {".ply": lost[".csv"], ".off": lost[".obj"]}
    assert set(found) == set(points.NAMES) - lost[suffix]
    for name, array in found.items():
        assert array.dtype == stored.arrays()[name].dtype
        assert array.tobytes() == stored.arrays()[name].tobytes(), name
    assert os.listdir(tmp_path) == [path.name]


@pytest.mark.parametrize("suffix", FORMATS)
def test_same_seed_same_bytes(tmp_path, torus, suffix):
    def bytes_of(name: str, *options: object) -> bytes:
        out = tmp_path / (name + suffix)
        done("sample", torus, out, "-n", 100, *options)
        return out.read_bytes()

    first = bytes_of("a", "--seed", 3, "--threads", 1)
    assert bytes_of("b", "--seed", 3, "--threads", 2) == first
    assert bytes_of("c", "--seed", 4) != first


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".npz"])
def test_reads_meshes(tmp_path, suffix):
    vertices, faces = shapes.grid(8)
    path = tmp_path / f"grid{suffix}"
    if suffix == ".npz":
        np.savez(path, vertices=vertices, faces=faces)
    else:
        dapple.write_mesh(path, vertices, faces)
    out = tmp_path / "points.npz"
    done("sample", path, out, "-n", 50)
    expected = dapple.sample(dapple.Surface(vertices, faces), 50)
    np.testing.assert_array_equal(np.load(out)["positions"], expected.positions)


def test_passes_options_on(tmp_path, torus, surface):
    out = tmp_path / "points.npz"
    chosen = {"seed": 5, "capacity_weight": 50.0, "repulsion_weight": 0.5, "tolerance": 1e-4}
    chosen |= {"max_evaluations": 20, "method": "line_search", "start": "random"}
    chosen |= {"cells": "euclidean", "threads": 1}
    flags = [word for k, v in chosen.items() for word in (f"--{k.replace('_', '-')}", v)]
    found = done("sample", torus, out, "-n", 100, *flags, "--json", "-")
    expected = dapple.sample(surface, 100, **chosen)
    np.testing.assert_array_equal(np.load(out)["positions"], expected.positions)
    settings = json.loads(found.stdout)["settings"]
    assert settings == {"count": 100, "preset": "default", **chosen}


def test_the_paper_is_a_preset(tmp_path, torus, surface):
    out = tmp_path / "points.npz"
    done("sample", torus, out, "-n", 60, "--preset", "paper", "--tolerance", 1e-3)
    expected = dapple.sample(surface, 60, **dapple.PAPER | {"tolerance": 1e-3})
    np.testing.assert_array_equal(np.load(out)["positions"], expected.positions)


@pytest.mark.parametrize(
    ("name", "place"), [("smooth", "vertices"), ("half", "faces"), ("jumps", "corners")]
)
def test_takes_densities_by_name_and_from_files(tmp_path, archive, name, place):
    arrays = np.load(archive)
    np.save(tmp_path / "density.npy", arrays[name])
    by_name, from_file = tmp_path / "name.npz", tmp_path / "file.npz"
    report = done("sample", archive, by_name, "-n", 80, "--density", name, "--json", "-")
    done("sample", archive, from_file, "-n", 80, "--density", tmp_path / "density.npy")
    domain = dapple.Surface(arrays["vertices"], arrays["faces"], arrays[name], density_at=place)
    expected = dapple.sample(domain, 80).positions
    np.testing.assert_array_equal(np.load(by_name)["positions"], expected)
    np.testing.assert_array_equal(np.load(from_file)["positions"], expected)
    assert json.loads(report.stdout)["input"]["density_at"] == place


def test_takes_a_property_of_a_ply_as_density(tmp_path):
    """The corners of a square, all density at x = 0."""
    path, out = tmp_path / "square.ply", tmp_path / "points.npz"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
        "property double z\nproperty float fur\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 1\n1 0 0 0\n1 1 0 0\n0 1 0 1\n3 0 1 2\n3 0 2 3\n"
    )
    done("sample", path, out, "-n", 90, "--density", "fur")
    square = dapple.Surface(*dapple.read_mesh(path), [1, 0, 0, 1])
    np.testing.assert_array_equal(np.load(out)["positions"], dapple.sample(square, 90).positions)
    assert "it has x, y, z, fur" in refused("sample", path, out, "-n", 9, "--density", "hair")


def test_takes_the_density_of_an_npz(tmp_path, archive):
    arrays = dict(np.load(archive))
    own = tmp_path / "own.npz"
    np.savez(own, vertices=arrays["vertices"], faces=arrays["faces"], density=arrays["half"])
    done("sample", own, tmp_path / "own_points.npz", "-n", 50)
    done("sample", archive, tmp_path / "named.npz", "-n", 50, "--density", "half")
    assert (tmp_path / "own_points.npz").read_bytes() == (tmp_path / "named.npz").read_bytes()


def test_reports_as_json(tmp_path, torus):
    out, report = tmp_path / "points.ply", tmp_path / "report.json"
    said = done("sample", torus, out, "-n", 100, "--json", report)
    assert said.stdout.startswith(f"{out}: 100 points, alpha min 0.")
    found = json.loads(report.read_text())
    assert found["command"] == "sample"
    assert found["version"] == dapple.__version__
    assert found["input"]["mesh"] == str(torus)
    assert found["input"]["faces"] == 1600
    assert found["settings"]["seed"] == 0
    assert set(found["report"]) == set(
        dapple.sample(dapple.Plane(1, 1).surface, 2).report.to_dict()
    )
    assert found["report"]["count"] == 100
    quiet = done("sample", torus, out, "-n", 100, "--json", report, "--quiet")
    assert quiet.output == ""


def test_classes(tmp_path, archive):
    out = tmp_path / "points.csv"
    arrays = np.load(archive)
    surface = dapple.Surface(arrays["vertices"], arrays["faces"])
    wanted = ["--class", 80, "--class", "30:radius=0.05", "--class", "20:radius=0.01,density=half"]
    found = done("classes", archive, out, *wanted, "--json", tmp_path / "report.json")
    half = dapple.SampleClass(20, radius=0.01, density=arrays["half"], density_at="faces")
    expected = dapple.sample_classes(surface, [80, dapple.SampleClass(30, radius=0.05), half])
    stored = points.read_points(out)
    assert stored.positions.tobytes() == expected.positions.tobytes()
    assert stored.classes.tolist() == [0] * 80 + [1] * 30 + [2] * 20
    report = json.loads((tmp_path / "report.json").read_text())
    assert [entry["count"] for entry in report["report"]["classes"]] == [80, 30, 20]
    assert report["settings"]["classes"][1] == {"count": 30, "radius": 0.05, "density": None}
    assert report["settings"]["repulsion_weight"] == 5.0
    assert "class 2: 20 points" in found.stdout


@pytest.mark.parametrize("form", ["ascii", "binary_big_endian"])
def test_reads_ply_of_others(tmp_path, form):
    path = tmp_path / "points.ply"
    header = (
        f"ply\nformat {form} 1.0\ncomment by others\nelement camera 1\nproperty short view\n"
        "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.array([(0.5, 1, -2, 255), (3, 4, 5, 0)], ">f4,>f4,>f4,u1")
    body = b"7\n0.5 1 -2 255\n3 4 5 0\n2 0 1\n"
    if form != "ascii":
        body = np.array(7, ">i2").tobytes() + rows.tobytes() + b"\x02" + bytes(8)
    path.write_bytes(header.encode() + body)
    found = points.read_points(path)
    np.testing.assert_array_equal(found.positions, [[0.5, 1, -2], [3, 4, 5]])
    assert found.normals is None


def test_keeps_what_was_there_when_it_fails(tmp_path, torus, monkeypatch):
    out = tmp_path / "points.ply"
    out.write_text("precious")

    def torn(file, columns):
        file.write(b"half")
        raise OSError(28, "No space left on device", str(out))

    monkeypatch.setattr(points.ply, "write", torn)
    assert refused("sample", torus, out, "-n", 10) == f"Error: {out}: No space left on device\n"
    assert out.read_text() == "precious"
    assert sorted(os.listdir(tmp_path)) == ["points.ply", "torus.ply"]


def test_a_file_makes_a_command(tmp_path, monkeypatch):
    (tmp_path / "greet.py").write_text(
        "import click\n@click.command('greet')\ndef command():\n    click.echo('hello')\n"
    )
    monkeypatch.setattr(commands, "__path__", [*commands.__path__, str(tmp_path)])
    assert done("greet").stdout == "hello\n"
    assert re.search(r"^  greet", done("--help").stdout, re.MULTILINE)


def test_ctrl_c_ends_the_work_before_the_command(monkeypatch):
    ended = []

    def interrupted(futures, timeout):
        raise KeyboardInterrupt

    def endless(*, context: dapple.Context) -> None:
        while not context.cancelled:
            time.sleep(0.001)
        ended.append(context)

    monkeypatch.setattr(work, "wait", interrupted)
    with pytest.raises(KeyboardInterrupt), work.Work("waiting") as bar:
        bar.run(endless)
    assert len(ended) == 1


def terminal():
    """Both ends of a pseudo-terminal; the test is skipped where the system has none to give."""
    pty = pytest.importorskip("pty")
    try:
        return pty.openpty()
    except OSError as error:
        pytest.skip(f"no pseudo-terminal, as where /dev/pts is not mounted: {error}")


def test_shows_progress_in_a_terminal_and_ends_by_ctrl_c(tmp_path, torus):
    """The first percents on stderr tell that the long work has begun; then Ctrl-C."""
    fcntl = pytest.importorskip("fcntl")
    out = tmp_path / "points.ply"
    ours, theirs = terminal()
    # A shell that started this process in the background may have made it ignore the signal.
    process = subprocess.Popen(
        command("sample", torus, out, "-n", 5000, "--tolerance", 0, "--max-evaluations", 1000),
        stdout=subprocess.PIPE,
        stderr=theirs,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    os.close(theirs)
    shown = b""
    while not re.search(rb"sampling.* [1-9]\d*%", shown):
        shown += os.read(ours, 1000)
    process.send_signal(signal.SIGINT)
    stdout, _ = process.communicate(timeout=60)
    fcntl.fcntl(ours, fcntl.F_SETFL, os.O_NONBLOCK)
    shown += os.read(ours, 10_000)
    os.close(ours)
    assert process.returncode == 130, shown
    assert b"Cancelled: nothing was written." in shown
    assert b"Traceback" not in shown
    assert stdout == b""
    assert os.listdir(tmp_path) == [torus.name]


def test_shows_no_progress_elsewhere(tmp_path, torus):
    assert done("sample", torus, tmp_path / "points.ply", "-n", 50).stderr == ""


def test_a_spacing_is_a_number_of_points(tmp_path, torus, surface):
    by_spacing, by_count = tmp_path / "spacing.csv", tmp_path / "count.csv"
    spacing = surface.spacing(150)
    found = done("sample", torus, by_spacing, "--spacing", spacing, "--json", tmp_path / "told")
    assert "spacing.csv: 150 points" in found.stdout
    told = json.loads((tmp_path / "told").read_text())["settings"]
    assert (told["count"], told["spacing"]) == (150, spacing)
    done("sample", torus, by_count, "-n", 150)
    assert by_spacing.read_bytes() == by_count.read_bytes()


def test_a_spacing_is_that_where_the_density_is_largest(tmp_path, archive, surface):
    spacing = surface.spacing(400)
    halves = dict(np.load(archive))["half"]
    share = surface.with_density(halves, density_at="faces").capacity / surface.area
    found = done(
        "sample", archive, tmp_path / "points.csv", "--spacing", spacing, "--density", "half"
    )
    assert f"points.csv: {round(400 * share)} points" in found.stdout


def test_tiles_motions_and_classes_take_a_spacing_too(tmp_path, torus, surface):
    spacing = surface.spacing(60)
    by = ("--spacing", spacing)
    assert "60 tiles" in done("mosaic", torus, tmp_path / "t.ply", *by).stdout
    assert "60 points" in done("track", torus, torus, tmp_path / "m.npz", *by).stdout
    listed = ["--class", f"spacing={spacing}", "--class", "20", "--json", tmp_path / "told"]
    assert "80 points" in done("classes", torus, tmp_path / "c.ply", *listed).stdout
    told = json.loads((tmp_path / "told").read_text())["settings"]["classes"]
    assert [one["count"] for one in told] == [60, 20]
    assert [one.get("spacing") for one in told] == [spacing, None]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["sample", "-n", 5, "--spacing", 1], 2, "give either --count or --spacing"),
        (["sample", "--spacing", 0], 2, "0.0 is not in the range x>0"),
        (["sample", "--spacing", "nan"], 2, "nan is not a finite number"),
        (["sample", "--spacing", 1e-9], 1, "at most 100000000 are possible"),
        (["mosaic", "-n", 5, "--spacing", 1], 2, "give only one of --count, --spacing and"),
        (["mosaic", "--points", "{mesh}", "--spacing", 1], 2, "give only one of --count"),
        (["classes", "--class", "spacing=big"], 2, "'big' is not a valid number"),
    ],
)
def test_refuses_spacings(tmp_path, torus, arguments, code, message):
    verb, *rest = arguments
    filled = [str(torus) if one == "{mesh}" else one for one in rest]
    found = run(verb, torus, tmp_path / "out.ply", *filled)
    assert found.exit_code == code, found.output
    assert message in " ".join(found.stderr.split())
