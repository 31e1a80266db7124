# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's figures made again: pictures and a table without an empty cell."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import shapes
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[2]))

from benchmarks.paper import __main__ as command
from benchmarks.paper import report, study
from benchmarks.paper.plane import EXACT_SHARES, shares
from benchmarks.paper.scene import Frame, Scene, view
from benchmarks.paper.setting import WAYS, Plate, Row, row
from benchmarks.paper.study import Curve

RED = np.array([[1.0, 0.0, 0.0]])


@pytest.fixture(scope="module")
def out(tmp_path_factory) -> Path:
    """A quick run of two figures, in a folder without meshes."""
    folder = tmp_path_factory.mktemp("report")
    options = [str(folder), "--quick", "--only", "3", "13", "--out", str(folder / "out")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["paper", *options, "--page", str(folder / "page.md")])
        command.main()
    return folder / "out"


def test_every_cell_is_filled(out):
    rows = json.loads((out / "report.json").read_text())["rows"]
    assert {one["figure"] for one in rows} == {3, 13}
    names = {"figure", "picture", "quantity", "paper", "preset", "default", "remark"}
    for one in rows:
        assert set(one) == names
        assert all(str(value).strip() for value in one.values())


def test_the_page_has_every_row_and_no_picture(out):
    page = (out.parent / "page.md").read_text()
    rows = json.loads((out / "report.json").read_text())["rows"]
    lines = [line for line in page.splitlines() if line.startswith("| ")]
    assert len(lines) == len(rows) + 2
    assert all(line.count(" | ") == 5 for line in lines)
    assert "![" not in page
    assert "--quick" in page


def test_pictures_are_drawn(out):
    for number in (3, 13):
        pixels = np.asarray(Image.open(out / f"figure-{number:02d}.png").convert("L"))
        assert min(pixels.shape) > 300
        assert 0.02 < np.mean(pixels < 200) < 0.9
        assert "![" in (out / "report.md").read_text()


def test_both_ways_follow_the_ramp(out):
    rows = json.loads((out / "report.json").read_text())["rows"]
    both = [one for one in rows if one["quantity"].startswith("CapCVT")]
    assert len(both) == 1
    for way in ("preset", "default"):
        found = np.array([float(word) for word in both[0][way].split()])
        np.testing.assert_allclose(found, EXACT_SHARES, rtol=0, atol=2.0)


def test_shares_are_counted_from_left_to_right():
    x = np.array([0.1, 0.3, 0.3, 0.9, 1.0])
    np.testing.assert_allclose(shares(np.column_stack([x, x])), [20, 40, 0, 40])


def curve(alpha: float) -> Curve:
    return Curve("", {30.0: [alpha, alpha]}, {}, 0.0)


@pytest.mark.parametrize(
    ("alphas", "said"),
    [
        ((0.60, 0.74, 0.79), "only at 1e-7"),
        ((0.60, 0.76, 0.79), "only at 1e-6"),
        ((0.60, 0.61, 0.62), "not reached at any"),
        ((0.76, 0.80, 0.82), "at the paper's own tolerance"),
    ],
)
def test_says_where_the_papers_alpha_is_reached(alphas, said):
    verdict = study.verdict(30.0, [curve(alpha) for alpha in alphas])
    assert said in verdict
    assert ("We disagree" in verdict) == (alphas[0] < 0.745)


def test_says_when_alpha_rises_against_the_paper():
    def said(alpha: float, default: float) -> str:
        curves = [Curve("", {0.0: [0.8], 1.0: [one]}, {}, 0.0) for one in (alpha, 0, 0, default)]
        return study.trend(1.0, 0.0, curves)

    assert "We disagree" in said(0.85, 0.8)
    assert "the repulsion" in said(0.75, 0.78)
    assert "stops earlier" in said(0.75, 0.7)


def test_a_row_has_a_value_for_each_way():
    assert row("q", "p", ["1", "2"], "why") == Row("q", "p", "1", "2", "why")
    assert len(WAYS) == 2
    with pytest.raises(ValueError, match="unpack"):
        row("q", "p", ["1"], "why")


def test_a_folder_that_is_not_there_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["paper", str(tmp_path / "gone")])
    with pytest.raises(SystemExit):
        command.main()
    assert "gone is no folder" in capsys.readouterr().err


def test_pictures_stand_below_the_table(tmp_path):
    plate = Plate(4, "title", tmp_path / "figure-04.png", [Row("q", "p", "1", "2", "why")])
    page = report.markdown([plate], "command")
    assert "not made in this run: 1, 3, 5, 6" in page
    assert "| 4 | q | p | 1 | 2 | why |" in page
    assert page.index("| 4 | q") < page.index("![title](figure-04.png)")


def reddish(picture: np.ndarray) -> float:
    """The share of pixels that are red."""
    return float(np.mean(picture[..., 0].astype(int) - picture[..., 1] > 80))


def test_dots_behind_the_body_are_hidden():
    vertices, faces = shapes.torus()
    scene = Scene(vertices, faces, view("z", 0, 0), width=120)  # from -y, the outer rim in front
    far = np.array([[0.0, 9.0, 0.0]])  # the nearest point for every other position of the surface
    front, back = np.array([[0.0, -1.4, 0.0]]), np.array([[0.0, 1.4, 0.0]])
    assert reddish(scene.dots(front, RED, 0.3)) > 0.01
    assert reddish(scene.dots(back, RED, 0.3)) == 0.0
    assert reddish(scene.dots(far, RED, 0.3)) == 0.0


def test_dots_are_as_large_as_they_are_to_be():
    vertices, faces = shapes.grid()
    scene = Scene(vertices, faces, view("y", 0, 0), Frame(np.zeros(2), np.ones(2)), width=200)
    share = reddish(scene.dots(np.array([[0.5, 0.5, 0.0]]), RED, 0.25))
    assert share == pytest.approx(np.pi * 0.25**2, rel=0.03)
    assert reddish(scene.dots(np.array([[0.5, 0.5, 0.0]]), RED, np.array([0.1]))) < 0.04


def test_cells_are_outlined():
    vertices, faces = shapes.grid()
    scene = Scene(vertices, faces, view("y", 0, 0), Frame(np.zeros(2), np.ones(2)), width=100)
    picture = scene.cells(np.array([[0.25, 0.5, 0.0], [0.75, 0.5, 0.0]])).astype(int).sum(axis=2)
    dark = np.flatnonzero((picture < 450).mean(axis=0) > 0.9)
    assert 48 <= dark.min() <= dark.max() <= 51
