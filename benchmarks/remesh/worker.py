# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes by one package in a process of its own: worker.py NAME IN.npz OUT.npz."""

import math
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Made = tuple[Any, Any]  # vertices, faces


def dapple(vertices: Any, faces: Any, count: int) -> Made:
    import dapple3d

    made = dapple3d.remesh(dapple3d.Surface(vertices, faces), count)
    return made.vertices, made.faces


def dapple_smooth(vertices: Any, faces: Any, count: int) -> Made:
    import dapple3d

    made = dapple3d.remesh(dapple3d.Surface(vertices, faces), count, feature_angle=180)
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


def pymeshlab(vertices: Any, faces: Any, count: int) -> Made:
    import pymeshlab as module  # type: ignore[import-not-found, unused-ignore]

    corners = vertices[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    ).sum()
    edge = math.sqrt(area / (math.sqrt(3) * count))
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


CONTENDERS: dict[str, Callable[[Any, Any, int], Made]] = {
    "dapple": dapple,
    "dapple, no creases": dapple_smooth,
    "geogram": geogram,
    "pyacvd": pyacvd,
    "pymeshlab": pymeshlab,
}
OF_PEERS = {"pyacvd", "pymeshlab"}  # they run by the peers' Python


def may_run(name: str) -> bool:
    """Whether a contender's program is there; packages are tried."""
    return name != "geogram" or shutil.which("vorpalite") is not None


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
