# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered frames side by side in one picture, each with its frame number."""

from __future__ import annotations

import math
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

GAP = 6
INK = (38, 34, 30)
PAPER = (250, 246, 240)


def contact_sheet(pictures: dict[int, Path], caption: str, out: Path, columns: int = 2) -> None:
    """Joins the pictures (frame number: file, all of one size) row by row over a caption."""
    images = {frame: Image.open(path).convert("RGB") for frame, path in pictures.items()}
    width, height = next(iter(images.values())).size
    rows = math.ceil(len(images) / columns)
    label = ImageFont.load_default(size=height // 18)
    strip = 2 * GAP + height // 12
    size = (columns * (width + GAP) + GAP, rows * (height + GAP) + GAP + strip)
    sheet = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(sheet)
    for index, (frame, image) in enumerate(images.items()):
        x = GAP + (index % columns) * (width + GAP)
        y = GAP + (index // columns) * (height + GAP)
        sheet.paste(image, (x, y))
        draw.text((x + 3 * GAP, y + 2 * GAP), f"frame {frame}", fill=INK, font=label)
    middle = (size[0] // 2, size[1] - strip // 2 - GAP // 2)
    draw.text(middle, caption, fill=INK, font=label, anchor="mm")
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, optimize=True)
