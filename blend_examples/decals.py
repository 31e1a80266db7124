# SPDX-License-Identifier: GPL-3.0-or-later
"""Daisies and leaves over a vase, two classes: left baked into its texture, right as instances.

Chen et al. 2012, Fig. 16b. Run through `blend_examples/run.sh decals`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy
import dapple3d as dapple
import numpy as np
from dapple3d import texturing
from mathutils import Matrix
from numpy.typing import NDArray

from blend_examples.scene import begin, build_studio, finish, options, run, surface_of
from blend_examples.studio import material

PROFILE = [(0.30, 0.0), (0.46, 0.10), (0.62, 0.38), (0.66, 0.62), (0.52, 0.92), (0.32, 1.12)]
PROFILE += [(0.27, 1.24), (0.36, 1.40)]  # radius and height of the vase, from its foot up
SIDES, STEPS = 72, 7  # around, and between two points of the profile
GLAZE = (0.10, 0.27, 0.38)  # as in pictures; materials take it linear
GAMMA = 2.2
Image = NDArray[np.float64]


def petals(size: int) -> tuple[Image, Image]:
    """Distance from the middle and angle of each pixel of a square picture."""
    x, y = np.meshgrid(np.linspace(-1, 1, size), np.linspace(-1, 1, size))
    return np.hypot(x, y), np.arctan2(y, x)


def daisy(size: int = 256) -> Image:
    """Nine white petals around a yellow middle."""
    radius, angle = petals(size)
    edge = 0.62 + 0.36 * np.abs(np.cos(4.5 * angle))
    shade = np.clip(0.75 + 0.3 * radius, 0, 1)[..., None]
    picture = np.concatenate([shade * (0.96, 0.95, 0.90), (radius <= edge)[..., None]], axis=2)
    picture[radius < 0.3] = (0.95, 0.63, 0.08, 1)
    return picture


def leaf(size: int = 256) -> Image:
    """A pointed leaf along x with a light vein."""
    y, x = np.meshgrid(np.linspace(-1, 1, size), np.linspace(-1, 1, size), indexing="ij")
    width = 0.42 * (1 - x * x) * (1 - 0.25 * x)
    picture = np.zeros((size, size, 4))
    picture[np.abs(y) <= width] = (0.16, 0.46, 0.18, 1)
    picture[(np.abs(y) <= 0.03) & (np.abs(x) < 0.9)] = (0.55, 0.76, 0.38, 1)
    return picture


def profile() -> NDArray[np.float64]:
    """A smooth curve through PROFILE: (n, 2), radius and height."""
    points = np.array([PROFILE[0], *PROFILE, PROFILE[-1]])
    t = np.linspace(0, 1, STEPS, endpoint=False)[:, None]
    rows = []
    for a, b, c, d in zip(points, points[1:], points[2:], points[3:], strict=False):
        rows.append(
            0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2)
            + 0.5 * (3 * b - a - 3 * c + d) * t**3
        )
    return np.vstack([*rows, points[-1:]])


def build_vase(name: str, x: float) -> bpy.types.Object:
    """A turned body with one chart of texture coordinates: u around, v along the profile."""
    curve = profile()
    turns = 2 * math.pi * np.arange(SIDES) / SIDES
    rings = [
        np.column_stack([r * np.cos(turns), r * np.sin(turns), 0 * turns + z]) for r, z in curve
    ]
    index = np.arange(len(curve) * SIDES).reshape(len(curve), SIDES)
    low, high = index[:-1], index[1:]
    quads = np.stack([low, np.roll(low, -1, 1), np.roll(high, -1, 1), high], axis=2)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.vstack(rings), [], quads.reshape(-1, 4).tolist())
    mesh.shade_smooth()
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    u = np.arange(SIDES + 1) / SIDES
    v = length / length[-1]
    row, side = (k.ravel() for k in np.indices(quads.shape[:2]))
    corners = [(u[side], v[row]), (u[side + 1], v[row])]
    corners += [(u[side + 1], v[row + 1]), (u[side], v[row + 1])]
    chart = np.stack([np.column_stack(corner) for corner in corners], axis=1)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", chart.ravel())
    vase = bpy.data.objects.new(name, mesh)
    vase.location.x = x
    bpy.context.scene.collection.objects.link(vase)
    return vase


def chart_of(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """Texture coordinates (m, 3, 2) of the corners of its loop triangles."""
    loops = np.empty(3 * len(mesh.loop_triangles), np.int32)
    chart = np.empty(2 * len(mesh.loops), np.float32)
    mesh.loop_triangles.foreach_get("loops", loops)
    mesh.uv_layers[0].data.foreach_get("uv", chart)
    return chart.reshape(-1, 2)[loops.reshape(-1, 3)]


def glaze() -> tuple[float, float, float]:
    red, green, blue = (channel**GAMMA for channel in GLAZE)
    return red, green, blue


def image_block(name: str, picture: Image) -> bpy.types.Image:
    rows, columns = picture.shape[:2]
    block = bpy.data.images.new(name, columns, rows, alpha=True)
    block.pixels.foreach_set(picture.astype(np.float32).ravel())
    block.pack()
    return block


def painted(name: str, picture: bpy.types.Image, see_through: bool) -> bpy.types.Material:
    made = material(name, glaze(), 0.3)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = picture
    shader = nodes["Principled BSDF"]
    links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    if see_through:
        links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    return made


def build_card(name: str, picture: Image, radius: float) -> bpy.types.Mesh:
    """A square of side 2 radius a little above z = 0."""
    mesh = bpy.data.meshes.new(name)
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    mesh.from_pydata([(radius * x, radius * y, 0.004) for x, y in corners], [], [(0, 1, 2, 3)])
    chart = mesh.uv_layers.new(name="UVMap")
    chart.data.foreach_set("uv", [(c + 1) / 2 for corner in corners for c in corner])
    mesh.materials.append(painted(name, image_block(name, picture), see_through=True))
    return mesh


def place_cards(
    vase: bpy.types.Object, samples: dapple.Samples, cards: list[bpy.types.Mesh]
) -> None:
    for k, frame in enumerate(texturing.frames(samples)):
        card = bpy.data.objects.new(f"Decal {samples.ids[k]}", cards[samples.classes[k]])
        place = Matrix.Translation(samples.positions[k].tolist())
        card.parent, card.matrix_local = vase, place @ Matrix(frame.tolist()).to_4x4()
        bpy.context.scene.collection.objects.link(card)


def main() -> None:
    parser = options(__doc__, 150, "daisies; half as many leaves")
    parser.add_argument("--texture", type=int, default=1280, help="width of the baked image")
    given = parser.parse_args()
    begin()
    left, right = build_vase("Baked", -0.72), build_vase("Instances", 0.72)
    surface, chart = surface_of(left.data), chart_of(left.data)
    radii = [0.46 * surface.spacing(given.count + given.count // 2) * k for k in (1.0, 0.9)]
    classes = [
        dapple.SampleClass(count, radius=radius)
        for count, radius in zip((given.count, given.count // 2), radii, strict=True)
    ]
    samples = dapple.sample_classes(surface, classes, seed=given.seed)
    decals = [texturing.Decal(*pair) for pair in zip((daisy(), leaf()), radii, strict=True)]
    picture = texturing.bake(
        *(surface, chart, samples, decals, given.texture // 2, given.texture),
        background=(*GLAZE, 1.0),
    )
    left.data.materials.append(painted("Baked", image_block("Baked", picture), see_through=False))
    right.data.materials.append(material("Glaze", glaze(), 0.3))
    cards = [
        build_card(name, np.asarray(decal.image, np.float64), decal.radius)
        for name, decal in zip(("Daisy", "Leaf"), decals, strict=True)
    ]
    place_cards(right, samples, cards)
    build_studio(given.width, given.width // 2, (0.0, -6.2, 2.6), (0.0, 0.0, 0.66), 72)
    overlap = samples.report.worst_overlap
    finish("decals", given, f"{len(samples)} decals, {overlap:.2f} worst overlap")


if __name__ == "__main__":
    run(main)
