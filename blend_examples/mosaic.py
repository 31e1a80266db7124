# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles over a box with rounded edges, colored one by one: a picture and a .blend.

Chen et al. 2012, Fig. 16a. Run through `blend_examples/run.sh mosaic`, which sets everything up.
"""

from __future__ import annotations

import bpy
import dapple3d as dapple
import numpy as np

from blend_examples.scene import begin, build_studio, finish, options, run, surface_of
from blend_examples.studio import BODY, color_by_chance, material

SIZE = (1.5, 1.1, 1.3)  # of the box
ROUNDING = 0.16
# Colors of the tiles, and the share up to which each is used.
HUES = [
    (0.25, (0.80, 0.24, 0.07)),
    (0.50, (0.93, 0.62, 0.20)),
    (0.75, (0.86, 0.80, 0.66)),
    (1.00, (0.07, 0.34, 0.40)),
]


def build_box() -> bpy.types.Object:
    """A box with rounded edges, standing on z = 0."""
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, SIZE[2] / 2))
    box = bpy.context.object
    box.name, box.scale = "Box", SIZE
    bpy.ops.object.transform_apply(location=True, rotation=False, scale=True)
    rounding = box.modifiers.new("Rounding", "BEVEL")
    rounding.width, rounding.segments = ROUNDING, 8
    bpy.ops.object.modifier_apply(modifier=rounding.name)
    box.data.materials.append(material("Mortar", BODY, 0.9))
    return box


def build_tiles(mosaic: dapple.Mosaic) -> bpy.types.Object:
    """One object with beveled walls; its faces have the attributes cell and dapple_object_type."""
    mesh = bpy.data.meshes.new("Tiles")
    corners = np.split(mosaic.corners, mosaic.starts[1:-1])
    mesh.from_pydata(mosaic.vertices, [], [row.tolist() for row in corners])
    for name, values in (("cell", mosaic.sites), ("dapple_object_type", mosaic.classes)):
        mesh.attributes.new(name, "INT", "FACE").data.foreach_set("value", values)
    mesh.materials.append(color_by_chance("Glaze", "cell", "GEOMETRY", HUES, roughness=0.25))
    tiles = bpy.data.objects.new("Tiles", mesh)
    bpy.context.scene.collection.objects.link(tiles)
    edges = tiles.modifiers.new("Worn edges", "BEVEL")
    edges.width, edges.segments, edges.limit_method = 0.006, 3, "ANGLE"
    edges.angle_limit = 1.0
    edges.use_clamp_overlap = True
    return tiles


def main() -> None:
    given = options(__doc__, 420, "tiles").parse_args()
    begin()
    surface = surface_of(build_box().data)
    samples = dapple.sample(surface, given.count, seed=given.seed)
    spacing = samples.report.spacing
    mosaic = dapple.mosaic(surface, samples, grout=0.09 * spacing, thickness=0.14 * spacing)
    build_tiles(mosaic)
    build_studio(given.width, 3 * given.width // 4, (3.3, -4.4, 3.0), (0.0, 0.0, 0.6), 78)
    kept = 100 * mosaic.areas.sum() / mosaic.cell_areas.sum()
    finish(
        "mosaic", given, f"{given.count} tiles of {len(mosaic)} polygons, {kept:.0f} % of the box"
    )


if __name__ == "__main__":
    run(main)
