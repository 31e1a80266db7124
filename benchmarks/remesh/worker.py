# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes by one package in a process of its own: worker.py NAME IN.npz OUT.npz."""

import math
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

Made = tuple[Any, Any]  # vertices, faces


def dapple(vertices: Any, faces: Any, count: int, **options: Any) -> Made:
    import dapple3d

    made = dapple3d.remesh(dapple3d.Surface(vertices, faces), count, **options)
    return made.vertices, made.faces


def pyacvd(vertices: Any, faces: Any, count: int) -> Made:
    """Its clusters are of vertices, so a mesh of few gets about ten for each cluster first."""
    import pyacvd as module  # type: ignore[import-not-found, unused-ignore]
    import pyvista  # type: ignore[import-not-found, unused-ignore]

    clusters = module.Clustering(pyvista.PolyData.from_regular_faces(vertices, faces))
    rounds = max(0, round(math.log(10 * count / len(vertices)) / math.log(4)))
    if rounds:
        clusters.subdivide(rounds)
    clusters.cluster(count)
    made = clusters.create_mesh()
    return made.points, made.faces.reshape(-1, 4)[:, 1:]


def edge_of(vertices: Any, faces: Any, count: int) -> float:
    """Length of the edges of a mesh of so many vertices in hexagons."""
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(across, axis=1).sum()
    return math.sqrt(2 * area / (math.sqrt(3) * count))


def pymeshlab(vertices: Any, faces: Any, count: int) -> Made:
    import pymeshlab as module  # type: ignore[import-not-found, unused-ignore]

    edge = edge_of(vertices, faces, count)
    meshes = module.MeshSet()
    meshes.add_mesh(module.Mesh(vertices, faces))
    meshes.meshing_isotropic_explicit_remeshing(
        iterations=10, targetlen=module.PureValue(edge), featuredeg=30
    )
    made = meshes.current_mesh()
    return made.vertex_matrix(), made.face_matrix()


def geogram(vertices: Any, faces: Any, count: int) -> Made:
    import dapple3d

    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder, "in.obj"), Path(folder, "out.obj")
        dapple3d.write_mesh(before, vertices, faces)
        command = ["vorpalite", "profile=scan", f"pts={count}", str(before), str(after)]
        subprocess.run(command, check=True, capture_output=True)
        made = dapple3d.read_mesh(after)
        return made.vertices, made.faces


def cgal(vertices: Any, faces: Any, count: int) -> Made:
    """Through files, whose time counts."""
    import dapple3d

    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder, "in.off"), Path(folder, "out.off")
        dapple3d.write_mesh(before, vertices, faces)
        command = [
            "dapple_isotropic",
            str(before),
            str(after),
            str(edge_of(vertices, faces, count)),
        ]
        subprocess.run(command, check=True, capture_output=True)
        made = dapple3d.read_mesh(after)
        return made.vertices, made.faces


def in_blender(vertices: Any, faces: Any, remesh: Callable[[Any], None]) -> Made:
    """Its quads are divided as it draws them."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    remesh(body)
    mesh = body.data
    mesh.calc_loop_triangles()
    places = np.empty(3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", places)
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return places.reshape(-1, 3), corners.reshape(-1, 3)


def blender_voxels(vertices: Any, faces: Any, count: int) -> Made:
    """A square of the grid for each vertex."""
    import bpy

    def remesh(body: Any) -> None:
        edge = edge_of(vertices, faces, count)
        body.data.remesh_voxel_size = edge * math.sqrt(math.sqrt(3) / 2)
        bpy.ops.object.voxel_remesh()

    return in_blender(vertices, faces, remesh)


def blender_quadriflow(vertices: Any, faces: Any, count: int) -> Made:
    import bpy

    def remesh(body: Any) -> None:
        bpy.ops.object.quadriflow_remesh(
            target_faces=count, use_preserve_sharp=True, use_preserve_boundary=True
        )

    return in_blender(vertices, faces, remesh)


CONTENDERS: dict[str, Callable[[Any, Any, int], Made]] = {
    "dapple": dapple,
    "dapple, no creases": partial(dapple, feature_angle=180),
    "dapple, adaptive": partial(dapple, adaptive=True),
    "geogram": geogram,
    "pyacvd": pyacvd,
    "pymeshlab": pymeshlab,
    "cgal": cgal,
    "blender, voxels": blender_voxels,
    "blender, quadriflow": blender_quadriflow,
}
PROGRAMS = {"geogram": "vorpalite", "cgal": "dapple_isotropic"}
OF_PEERS = {"pyacvd", "pymeshlab"}  # they run by the peers' Python


def may_run(name: str) -> bool:
    """Whether a contender's program is there; packages are tried."""
    program = PROGRAMS.get(name)
    return program is None or shutil.which(program) is not None


def main() -> None:
    name, given, out = sys.argv[1:]
    with np.load(given) as mesh:
        vertices, faces, count = mesh["vertices"], mesh["faces"], int(mesh["count"])
    begun = time.perf_counter()
    found = CONTENDERS[name](vertices, faces, count)
    seconds = time.perf_counter() - begun
    np.savez(out, vertices=found[0], faces=found[1], seconds=seconds)


if __name__ == "__main__":
    main()
