# SPDX-License-Identifier: GPL-3.0-or-later
"""Fig. 16: tiles and decals on surfaces, by the scripts of blend_examples."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from PIL import Image

from benchmarks.paper.setting import PICTURE_ONLY, Plate, Row, Setting

ROOT = Path(__file__).parents[2]
LIMIT = 900  # seconds: Blender can hang at exit


def figure_16(setting: Setting) -> Plate:
    """A mosaic on a box, and two kinds of decals on a vase, rendered by Blender."""
    tiles = _rendered("mosaic", setting.size(420, 60), setting)
    decals = _rendered("decals", setting.size(150, 30), setting)
    _above_each_other([setting.out / f"{name}.png" for name in ("mosaic", "decals")], setting)
    remark = "Our own bodies, counts and colors: the paper's text gives none."
    rows = [
        Row("(a) tiles, polygons, % of the box left by the grout", *_cells(tiles), remark),
        Row("(b) decals of two classes, worst overlap of their discs", *_cells(decals), remark),
    ]
    return Plate(16, "Objects placed on surfaces", setting.picture(16), rows)


def _cells(figures: str) -> tuple[str, str, str]:
    return PICTURE_ONLY, "not run: only the points would differ", figures


def _rendered(scene: str, count: int, setting: Setting) -> str:
    """The figures that the scene's script tells, one after another."""
    command = [sys.executable, "-m", f"blend_examples.{scene}", "--count", str(count)]
    width = setting.size(720, 160)
    done = subprocess.run(
        [*command, "--width", str(width), "--out", str(setting.out.resolve())],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=True,
    )
    said = done.stdout.strip().splitlines()[-1].partition(": ")[2]
    return ", ".join(re.findall(r"[\d.,]*\d", said))


def _above_each_other(pictures: list[Path], setting: Setting) -> None:
    images = [Image.open(path).convert("RGB") for path in pictures]
    sheet = Image.new("RGB", (images[0].width, sum(image.height for image in images)))
    top = 0
    for image in images:
        sheet.paste(image, (0, top))
        top += image.height
    sheet.save(setting.picture(16))
