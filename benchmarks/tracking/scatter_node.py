# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Distribute Points on Faces (Poisson) on a mesh. Needs bpy and numpy alone.

The node has a smallest distance and no count: it throws very many points and drops those that are
nearer to another one. So the distance is the one that leaves about the wanted number.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from benchmarks.tracking.implicit import Array, Faces

HALVINGS = 12  # of the distance, until about the wanted number is left
THROWN = 30  # points for each wanted one


class ScatterNode:
    """A mesh with the node, set to leave about `count` points; a density thins them."""

    def __init__(
        self,
        bpy: Any,
        vertices: Array,
        faces: Faces,
        area: float,
        count: int,
        density: Array | None = None,
    ) -> None:
        self._bpy = bpy
        self._mesh = bpy.data.meshes.new("Body")
        self._mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        self._body = bpy.data.objects.new("Body", self._mesh)
        bpy.context.scene.collection.objects.link(self._body)
        self._node = _scatter(bpy, self._body)
        if density is not None:
            self._thin(density, at_faces=len(density) == len(faces))
        self._node.inputs["Density Max"].default_value = THROWN * count / area
        self._set_distance(count, (2 * area / (np.sqrt(3) * count)) ** 0.5)

    def points(self, vertices: Array, seed: int = 0) -> Array:
        """Points (n, 3) on the mesh with other vertices."""
        self._mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
        self._mesh.update()
        self._node.inputs["Seed"].default_value = seed
        return self._evaluated()

    def _thin(self, density: Array, *, at_faces: bool) -> None:
        """Have an attribute of the mesh be the Density Factor."""
        domain = "FACE" if at_faces else "POINT"
        made = self._mesh.attributes.new("factor", "FLOAT", domain)
        made.data.foreach_set("value", density.astype(np.float32))
        group = self._node.id_data
        named = group.nodes.new("GeometryNodeInputNamedAttribute")
        named.inputs["Name"].default_value = "factor"
        group.links.new(named.outputs[0], self._node.inputs["Density Factor"])

    def _set_distance(self, count: int, longest: float) -> None:
        """Halve the interval of the smallest distance until it leaves about `count` points."""
        short, long = 0.2 * longest, longest
        for _ in range(HALVINGS):
            self._node.inputs["Distance Min"].default_value = (short + long) / 2
            if len(self._evaluated()) > count:
                short = (short + long) / 2
            else:
                long = (short + long) / 2

    def _evaluated(self) -> Array:
        evaluated = self._body.evaluated_get(self._bpy.context.evaluated_depsgraph_get())
        points = evaluated.to_mesh()
        flat = np.empty(3 * len(points.vertices), dtype=np.float32)
        points.vertices.foreach_get("co", flat)
        evaluated.to_mesh_clear()
        return flat.reshape(-1, 3).astype(np.float64)


def _scatter(bpy: Any, body: Any) -> Any:
    """Gives the body the node and returns it."""
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    chain = [
        group.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "GeometryNodeDistributePointsOnFaces",
            "GeometryNodePointsToVertices",
            "NodeGroupOutput",
        )
    ]
    chain[1].distribute_method = "POISSON"
    for one, other in itertools.pairwise(chain):
        group.links.new(one.outputs[0], other.inputs[0])
    body.modifiers.new("Scatter", "NODES").node_group = group
    return chain[1]
