# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes the parts of a rigged character and plays its actions: a Markdown table.

Run through benchmarks/rigs/run.sh, which sets everything up first. Each mesh below the armature is
remeshed to about half and to twice its triangles. Judged is how far the new surface gets from the
old one over the actions, and the old one from it, in percent of the character's height; and on what
share of the new surface the texture has another color.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import numpy as np

import addon
from benchmarks.compare.tables import say, table
from benchmarks.rigs.character import (
    Far,
    Part,
    all_actions,
    grouped,
    imported,
    played,
    remeshed,
    show,
    world_mesh,
)
from benchmarks.rigs.picture import draw
from benchmarks.rigs.texture import other_colors

HEAD = (
    *("part", "triangles", "weights", "lines lost", "seconds"),
    *("new from old, %", "old from new, %", "at", "other color, %"),
)
DATA = Path(os.environ.get("DAPPLE_DATA") or Path.cwd().parent / "shared/data")


def main() -> None:
    given = arguments()
    addon.register()
    rig, objects = imported(given.file)
    show(rig, given.action[0])
    height = float(np.ptp(np.concatenate([world_mesh(one)[0] for one in objects])[:, 2]))
    parts = []
    for share in given.share:
        for obj in objects:
            say(f"{obj.name}, {share:g}")
            parts.append(remeshed(obj, share, given.max_distance * height))
    actions = all_actions() if given.all else given.action
    far = played(rig, parts, actions, given.frames)
    print(table(HEAD, [row(part, found, height) for part, found in zip(parts, far, strict=True)]))
    for share in given.share:
        worst = max(far[k].most for k, part in enumerate(parts) if part.share == share)
        print(f"\n{share:g} of the triangles: at most {100 * worst / height:.2f} % of the height")
    if given.pictures:
        for action in given.action:
            show(rig, action)
            draw(given.pictures / f"{given.file.stem}-{action}.png", objects, parts)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/rigs/run.sh", description=__doc__)
    parser.add_argument("--file", type=Path, default=DATA / "assets/Knight.glb")
    parser.add_argument("--action", nargs="+", default=["Running_A"])
    parser.add_argument("--all", action="store_true", help="all actions of the file are played")
    parser.add_argument("--frames", type=int, default=24, help="of each action, at most")
    parser.add_argument("--share", type=float, nargs="+", default=[0.5, 2.0], help="of triangles")
    parser.add_argument(
        "--max-distance", type=float, default=0.01, help="in parts of the height; 0 sets no limit"
    )
    parser.add_argument("--pictures", type=Path, help="folder for a picture of each --action")
    return parser.parse_args()


def row(part: Part, far: Far, height: float) -> list[str]:
    return [
        *(part.old.name, f"{len(world_mesh(part.old)[1]):,} -> {len(world_mesh(part.new)[1]):,}"),
        *(f"{grouped(part.old):.0%} -> {grouped(part.new):.0%}", str(part.lost)),
        *(f"{part.seconds:.1f}", f"{100 * far.there / height:.2f}"),
        *(f"{100 * far.back / height:.2f}", far.where, f"{100 * other_colors(part):.1f}"),
    ]


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
