# SPDX-License-Identifier: GPL-3.0-or-later
"""A moving picture: studs on an animated newt by Blender's own Poisson disks and by Dapple.

Run through `blend_examples/run.sh side_by_side`, which sets everything up. Both sides show the
same animation, the same stud and, on the first frame, the same number of them. A stud is colored
by its id, so one that is replaced changes its color or its place.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from addon.nodes.builder import Builder, new_group
from addon.nodes.inputs import set_input
from blend_examples import creature, studio
from blend_examples.scene import options, run

Ids = NDArray[np.int32]
FPS = 24
LENS = 62
INK, PAPER, GAP = (38, 34, 30), (250, 246, 240), 6
TIPS: list[tuple[float, studio.Color]] = [
    (0.30, (0.16, 0.62, 0.52)),
    (0.55, (0.95, 0.80, 0.25)),
    (0.78, (0.90, 0.90, 0.86)),
    (1.00, (1.00, 0.22, 0.06)),
]


@dataclass
class Side:
    """One half of the picture."""

    caption: str
    scatter: bpy.types.Object
    ids: list[Ids]  # by frame

    def figures(self) -> str:
        """How many studs there are, and how many of them the next frame does not have."""
        counts = [len(ids) for ids in self.ids]
        kept = np.mean([len(np.intersect1d(a, b)) / len(a) for a, b in pairwise(self.ids)])
        studs = f"{min(counts)} to {max(counts)} studs"
        if min(counts) == max(counts):
            studs = f"always {counts[0]} studs"
        return f"{studs}, {100 * (1 - kept):.0f} % replaced per frame"


def distributed(
    surface: bpy.types.Object, stud: bpy.types.Object, scale: float
) -> bpy.types.Object:
    """Studs on Blender's Poisson disks, evaluated in each frame."""
    numbers = [(name, "NodeSocketFloat") for name in ("Distance", "Density")]
    tree = new_group("Poisson Disk", numbers, [("Geometry", "NodeSocketGeometry")])
    b = Builder(tree)
    body, thing = (
        b.node("GeometryNodeObjectInfo", one, transform_space="RELATIVE").outputs["Geometry"]
        for one in (surface, stud)
    )
    points = b.node("GeometryNodeDistributePointsOnFaces", distribute_method="POISSON")
    wanted = {"Mesh": body, "Distance Min": b.input("Distance"), "Density Max": b.input("Density")}
    for name, value in wanted.items():
        b.tree.links.new(value, points.inputs[name])
    turned = points.outputs["Rotation"]
    feeds = (points.outputs["Points"], True, thing, False, 0, turned, (scale,) * 3)
    b.output("Geometry", b.out("GeometryNodeInstanceOnPoints", *feeds))
    made = bpy.data.objects.new("Poisson Disk", bpy.data.meshes.new("Poisson Disk"))
    bpy.context.scene.collection.objects.link(made)
    made.modifiers.new("Poisson Disk", "NODES").node_group = tree
    return made


def set_distance(scatter: bpy.types.Object, count: int, spacing: float) -> None:
    """The distance that leaves about as many studs in this frame, out of four times as many."""
    modifier = scatter.modifiers[0]
    set_input(modifier, "Density", 4.0 / (math.sqrt(3.0) / 2.0 * spacing**2))
    low, high = 0.5 * spacing, spacing
    for _ in range(12):
        distance = 0.5 * (low + high)
        set_input(modifier, "Distance", distance)
        scatter.update_tag()
        if len(shown_ids(scatter)) > count:
            low = distance
        else:
            high = distance


def shown_ids(scatter: bpy.types.Object) -> Ids:
    """Who is there in this frame."""
    evaluated = scatter.evaluated_get(bpy.context.evaluated_depsgraph_get())
    geometry = evaluated.evaluated_geometry()  # kept, for the instances are a part of it
    instances = geometry.instances_pointcloud()
    ids = np.empty(len(instances.points), np.int32)
    instances.attributes["id"].data.foreach_get("value", ids)
    return ids


def sides(given: argparse.Namespace) -> list[Side]:
    """Both scatters on the animated newt, with all that is to be shown of them."""
    frames = range(1, given.frames + 2)  # the last frame is the first one again
    body, _ = creature.build_scene(frames, given.width)
    stud = studio.build_stud(TIPS)
    own = creature.scatter_studs(body, stud, given.count, given.seed)
    spacing = own.dapple.report.spacing
    other = distributed(body, stud, creature.STUD_SIZE * spacing)
    set_distance(other, given.count, spacing)
    creature.select(own)
    own.dapple.smoothing = "LOOP"
    bpy.ops.dapple.bake()
    made = [Side("Blender: Poisson Disk", other, []), Side("Dapple", own, [])]
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        for side in made:
            side.ids.append(shown_ids(side.scatter))
    return made


def render(made: list[Side], frame: int, folder: Path) -> list[Image.Image]:
    """The frame with each of the scatters."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    pictures = []
    for number, side in enumerate(made):
        for other in made:
            other.scatter.hide_render = other is not side
        scene.render.filepath = str(folder / f"{number}-{frame:04d}.png")
        with creature.quiet():
            bpy.ops.render.render(write_still=True)
        pictures.append(Image.open(scene.render.filepath).convert("RGB"))
    return pictures


def joined(made: list[Side], pictures: list[Image.Image]) -> Image.Image:
    """The pictures beside each other, each over its caption."""
    width, height = pictures[0].size
    strip = height // 5
    sheet = Image.new("RGB", (2 * width + GAP, height + strip), PAPER)
    draw = ImageDraw.Draw(sheet)
    for number, (side, picture) in enumerate(zip(made, pictures, strict=True)):
        left = number * (width + GAP)
        sheet.paste(picture, (left, 0))
        for text, size, row in ((side.caption, 0.42, 0.3), (side.figures(), 0.3, 0.73)):
            font = ImageFont.load_default(size=int(size * strip))
            place = (left + width // 2, height + int(row * strip))
            draw.text(place, text, fill=INK, font=font, anchor="mm")
    return sheet


def make(given: argparse.Namespace) -> None:
    made = sides(given)
    for side in made:
        creature.say(f"   {side.caption}: {side.figures()}")
    set_render(given.width)
    folder, out = given.out / "side_by_side", given.out / "side_by_side.webp"
    folder.mkdir(parents=True, exist_ok=True)
    with creature.frames_shown(given.frames):
        frames = range(1, given.frames + 1)[: given.only]
        pictures = [joined(made, render(made, frame, folder)) for frame in frames]
    if given.back:
        pictures += pictures[-2:0:-1]
    pictures[0].save(
        out,
        save_all=True,
        append_images=pictures[1:],
        duration=1000 // FPS,
        loop=0,
        quality=given.quality,
        method=6,
    )
    creature.say(f"== {out}: {out.stat().st_size / 1e6:.2f} MB")


def set_render(width: int) -> None:
    """A frame that is filled by the newt."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, 7 * width // 10
    scene.camera.data.lens = LENS


def main() -> None:
    parser = options(__doc__, 700, "studs")
    parser.set_defaults(width=410)
    parser.add_argument("--frames", type=int, default=48, help="frames of the loop")
    parser.add_argument("--only", type=int, help="render the first frames only")
    parser.add_argument("--back", action="store_true", help="play them backward then")
    parser.add_argument("--quality", type=int, default=85, help="of the pictures, 1 to 100")
    given = parser.parse_args()
    make(given)


if __name__ == "__main__":
    run(main)
