# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple stipple: what it writes, what it says, and what it refuses."""

import json

import dapple3d as dapple
import numpy as np
import pytest
from click.testing import CliRunner, Result
from dapple3d import stippling
from dapple3d.cli.app import main
from PIL import Image


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, ["stipple", *map(str, arguments)])


def refused(*arguments: object) -> str:
    found = run(*arguments)
    assert found.exit_code == 1, found.output
    assert found.stdout == ""
    assert found.stderr.count("\n") == 1
    return found.stderr


@pytest.fixture
def picture(tmp_path):
    """Gray, darker to the right."""
    path = tmp_path / "ramp.png"
    Image.fromarray(np.tile(np.linspace(255, 0, 40).astype(np.uint8), (30, 1))).save(path)
    return path


@pytest.mark.parametrize("suffix", stippling.SUFFIXES)
def test_writes_what_the_library_does(tmp_path, picture, suffix):
    out = tmp_path / f"dots{suffix}"
    found = run(picture, out, "-n", 200, "--seed", 3, "--scale", 2)
    assert found.exit_code == 0, found.output
    assert f"{out}: 200 dots of radius" in found.stdout
    dots = dapple.stipple(stippling.read_picture(picture), 200, seed=3)
    assert out.read_bytes() == stippling.encode(dots, suffix, scale=2)


def test_reports_inks(tmp_path):
    path, out = tmp_path / "color.png", tmp_path / "dots.svg"
    image = np.zeros((20, 30, 3), np.uint8)
    image[:, :15] = (255, 0, 0)
    Image.fromarray(image).save(path)
    found = run(path, out, "-n", 100, "--json", "-", "--radius", 0.5, "--tolerance", 1e-3)
    assert found.exit_code == 0, found.output
    told = json.loads(found.stdout)
    assert told["inks"] == {name: 50 * (name in ("red", "black")) for name in stippling.INKS}
    assert told["radius"] == told["settings"]["radius"] == 0.5
    assert told["settings"]["tolerance"] == 1e-3
    assert told["input"] == {"picture": str(path), "width": 30, "height": 20}
    assert told["report"]["count"] == 100


def test_refuses_what_it_cannot_do(tmp_path, picture):
    out = tmp_path / "dots.svg"
    assert "must end in .png, .svg, .pdf" in refused(picture, tmp_path / "dots.gif", "-n", 5)
    assert "is read as an input" in refused(picture, picture, "-n", 5)
    white = tmp_path / "white.png"
    Image.fromarray(np.full((4, 4), 255, np.uint8)).save(white)
    assert "white.png: the picture is white everywhere" in refused(white, out, "-n", 5)
    broken = tmp_path / "broken.png"
    broken.write_text("no picture")
    assert "broken.png" in refused(broken, out, "-n", 5)
    assert run(picture, out, "-n", 0).exit_code == 2
    assert not out.exists()
