# SPDX-License-Identifier: GPL-3.0-or-later
"""benchmarks/peers: other packages that are missing, crash or hang are lines, not failures."""

import json
import sys
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

from benchmarks.peers import __main__ as command
from benchmarks.peers.contenders import CONTENDERS, Contender, Task, fitted
from benchmarks.peers.meshes import MADE_UP
from benchmarks.peers.processes import RefusedError, ask, one_line, worker

IN_TIME = 60.0  # most seconds


def process(code: str) -> list[str]:
    return [sys.executable, "-c", code]


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("import no_such_peer", "No module named 'no_such_peer'"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashed: SIGSEGV"),
        ("import os; os.abort()", "crashed: SIGABRT"),
        ("raise ValueError('not\\nmanifold | open')", "manifold / open"),
        ("import sys; sys.exit(3)", "exit status 3"),
        ("pass", "ended without a result"),
    ],
)
def test_a_process_that_gives_nothing_gives_a_line(code, reason):
    with pytest.raises(RefusedError) as error:
        ask(process(code), IN_TIME)
    assert reason in str(error.value)
    assert "\n" not in str(error.value)


def test_a_program_that_is_not_there_gives_a_line(tmp_path):
    with pytest.raises(RefusedError, match="No such file"):
        ask([str(tmp_path / "python")], IN_TIME)


def test_a_process_that_hangs_is_ended():
    with pytest.raises(RefusedError, match=r"ended after 0\.5 s, the limit"):
        ask(process("import time; time.sleep(600)"), 0.5)


def test_a_result_counts_although_the_process_crashes_or_hangs_at_its_end():
    writes = "import numpy, sys; numpy.savez(sys.argv[1], version='1')"
    crash, hang = "import os; os.abort()", "import time; time.sleep(600)"
    assert ask(process(f"{writes}; {crash}"), IN_TIME)["version"] == "1"
    assert ask(process(f"{writes}; {hang}"), 5.0)["version"] == "1"


def test_reasons_are_short():
    assert len(one_line("very long " * 100)) <= 120


@pytest.mark.parametrize("name", list(MADE_UP))
def test_made_up_meshes_are_closed(name):
    vertices, faces = MADE_UP[name]()
    surface = dapple.Surface(vertices, faces)
    assert surface.topology.closed
    assert surface.topology.components == 1
    assert Task(vertices, faces, 100).area == pytest.approx(surface.area)
    assert Task(vertices, faces, 100).spacing == pytest.approx(surface.spacing(100))


def test_a_radius_is_found_that_leaves_the_wanted_number():
    assert 0.5 / fitted(lambda radius: int(0.5 / radius**2), 0.3, 1000) ** 2 == pytest.approx(
        1000, rel=0.01
    )


def test_judges_points_off_the_surface_where_they_belong():
    surface = dapple.Surface(*MADE_UP["box"]())
    samples = dapple.sample(surface, 300)
    found = command.judge(surface, samples.positions + np.array([0, 0, 1e-4]))
    assert found["got"] == 300
    assert found["off_surface"] == pytest.approx(1e-4 / surface.spacing(300), rel=0.01)
    assert found["capacity_variation"] == pytest.approx(
        samples.report.capacity_variation, abs=0.002
    )


def run(monkeypatch, out: Path, *arguments: str) -> dict:
    monkeypatch.setattr(sys, "argv", ["run.sh", "--out", str(out), "--runs", "1", *arguments])
    command.main()
    return json.loads((out / "peers.json").read_text())


def test_a_run_with_a_peer_that_crashes_and_one_that_is_missing(monkeypatch, tmp_path, capsys):
    def commands(name: str, python: str) -> list[str]:
        crash = "import os, sys; len(sys.argv) > 2 and os.abort(); "
        writes = "import numpy; numpy.savez(sys.argv[1], version='7')"
        fakes = {"crashes": process(crash + writes), "missing": process("import no_such_peer")}
        return fakes.get(name) or worker(name, python)

    monkeypatch.setattr(command, "worker", commands)
    for name in ("crashes", "missing"):
        monkeypatch.setitem(CONTENDERS, name, Contender(name, name, "", lambda *_: None))
    only = ("--only", "dapple", "crashes", "missing")
    found = run(monkeypatch, tmp_path, "--meshes", "box", "--counts", "200", "300", *only)
    assert "no_such_peer" in found["missing"]["missing"]
    assert found["versions"] == {"dapple": dapple.__version__, "crashes": "7"}
    ours, crashed, *_ = found["records"]
    assert [one["reason"] for one in found["records"][1::2]] == ["crashed: SIGABRT"] * 2
    assert crashed["contender"] == "crashes"
    assert ours["runs"][0]["got"] == 200
    assert ours["runs"][0]["capacity_variation"] < 0.05
    text = (tmp_path / "peers.md").read_text()
    assert capsys.readouterr().out == text
    assert text.count("no_such_peer") == 1
    assert text.count("crashed: SIGABRT") == 2
    assert len({line.count("|") for line in text.splitlines() if "| box" in line}) == 1


def test_points_that_cannot_be_judged_give_a_line():
    surface = dapple.Surface(*MADE_UP["box"]())
    made = {"points": np.full((3, 3), np.nan), "ends": np.array([3]), "seconds": [1], "cpu": [1]}
    with pytest.raises(RefusedError, match="cannot be judged"):
        command.judged(surface, made)
