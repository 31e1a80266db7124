# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done in Blender for a long time: edits that scatters follow, and playback."""

import random
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import addon_host
import bpy
import edits
import following
import scenes
import test_rounds

FILE = 10  # edits of one file, whose shape wanders
LOOP = 24  # frames of the body that is played
POINTS = 5_000


def _enable() -> None:
    addon_host.add_repository(Path(tempfile.mkdtemp(dir=bpy.app.tempdir)) / "repository")
    addon_host.enable()


def _new_file() -> None:
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)


def rounds(seconds: float) -> Iterator[None]:
    """Random edits with Auto Update on, and what follows them; a file in each step."""
    _enable()
    end, number = time.monotonic() + seconds, 0
    with following.driven() as live:
        while time.monotonic() < end:
            _new_file()
            edits.prepared()
            live.settle()
            _edited(live, random.Random(number % 8))
            number += 1
            yield


def _edited(live: following.Driver, chance: random.Random) -> None:
    for number in range(FILE):
        edit = chance.choice(edits.EDITS)
        edit(chance)
        bpy.ops.ed.undo_push(message=f"{number} {edit.__name__}")
        if chance.random() < 0.3:
            edits.undo(chance)
        live.settle()
    test_rounds.check(live)


def frames(count: int) -> Iterator[None]:
    """A baked scatter played again and again; a loop in each step."""
    _enable()
    _new_file()
    obj = scenes.scattered(scenes.tail(levels=2, frames=LOOP), count=POINTS)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for number in range(count):
        bpy.context.scene.frame_set(1 + number % LOOP)
        assert len(scenes.positions(obj)) == POINTS
        if number % LOOP == LOOP - 1:
            yield
