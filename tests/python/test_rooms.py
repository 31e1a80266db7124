# SPDX-License-Identifier: GPL-3.0-or-later
"""The check of the rooms of native/src names the lines that break their order."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import rooms

LIST = """
| room | what it holds | public headers |
|---|---|---|
| `low/` | first | `ground` |
| `high/` | second | `roof` |
"""


@pytest.fixture
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two rooms with a public header and its source each."""
    monkeypatch.setattr(rooms, "ROOT", tmp_path)
    (tmp_path / rooms.PAGE).parent.mkdir(parents=True)
    (tmp_path / rooms.PAGE).write_text(LIST)
    for room, stem, lines in (
        ("low", "ground", ""),
        ("high", "roof", "#include <dapple/ground.hpp>\n"),
    ):
        (tmp_path / "native/src" / room).mkdir(parents=True)
        (tmp_path / "native/include/dapple").mkdir(parents=True, exist_ok=True)
        (tmp_path / f"native/include/dapple/{stem}.hpp").write_text(lines)
        (tmp_path / f"native/src/{room}/{stem}.cpp").write_text(f"#include <dapple/{stem}.hpp>\n")
    return tmp_path


def test_an_ordered_house_passes(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert rooms.main() == 0
    assert capsys.readouterr().out == ""


def test_names_the_line_that_includes_a_later_room(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (house / "native/src/high/beam.hpp").write_text("")
    (house / "native/src/low/ground.cpp").write_text(
        '#include <vector>\n#include "high/beam.hpp"\n'
    )
    assert rooms.main() == 1
    assert "native/src/low/ground.cpp:2: low/ includes beam of high/" in capsys.readouterr().out


def test_names_the_lines_of_a_circle(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "native/src/high/beam.hpp").write_text('#include "high/rafter.hpp"\n')
    (house / "native/src/high/rafter.hpp").write_text("")
    (house / "native/src/high/rafter.cpp").write_text(
        '#include "high/rafter.hpp"\n#include "high/beam.hpp"\n'
    )
    assert rooms.main() == 1
    out = capsys.readouterr().out
    assert "native/src/high/rafter.cpp:2: rafter includes beam" in out
    assert "native/src/high/beam.hpp:1: beam includes rafter" in out


def test_a_part_may_take_the_options_of_its_verb(house: Path) -> None:
    (house / "native/src/high/beam.hpp").write_text("#include <dapple/roof.hpp>\n")
    (house / "native/src/high/roof.cpp").write_text(
        '#include <dapple/roof.hpp>\n#include "high/beam.hpp"\n'
    )
    assert rooms.main() == 0


def test_names_a_circle_of_public_headers(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "native/include/dapple/ground.hpp").write_text("#include <dapple/roof.hpp>\n")
    assert rooms.main() == 1
    assert "ground includes roof" in capsys.readouterr().out


def test_names_a_header_that_no_room_lists(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "native/include/dapple/attic.hpp").write_text("")
    assert rooms.main() == 1
    assert "native/include/dapple/attic.hpp: no room" in capsys.readouterr().out
