# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to place points on a mesh: Dapple, and what others offer for it, called as they document.

Needs numpy alone; each contender's module is imported in the process that calls it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from benchmarks.tracking.implicit import Array, Faces
from benchmarks.tracking.scatter_node import ScatterNode

Draw = Callable[[int], Array]
"""Points (n, 3) by seed, from the arrays of the mesh on; where there is a seed."""

ROUNDS = 8  # of calls until a radius leaves about the wanted number
CLOSE = 0.01  # of that number


class Task(NamedTuple):
    """A mesh, and how many points it is to get."""

    vertices: Array
    faces: Faces
    wanted: int

    @property
    def area(self) -> float:
        a, b, c = np.moveaxis(self.vertices[self.faces], 1, 0)
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)

    @property
    def spacing(self) -> float:
        """The largest distance that so many points can keep: that of a hexagonal lattice."""
        return float((2 * self.area / (np.sqrt(3) * self.wanted)) ** 0.5)


@dataclass(frozen=True)
class Contender:
    """A module, the call as the page tells it, and what prepares it."""

    title: str
    module: str
    call: str
    prepare: Callable[[Any, Task], Draw]


def dapple(module: Any, task: Task) -> Draw:
    vertices, faces, count = task
    return lambda seed: np.asarray(
        module.sample(module.Surface(vertices, faces), count, seed=seed).positions
    )


def blender(bpy: Any, task: Task) -> Draw:
    node = ScatterNode(bpy, task.vertices, task.faces, task.area, task.wanted)
    return lambda seed: node.points(task.vertices, seed)


def point_cloud_utils_poisson(module: Any, task: Task) -> Draw:
    """By radius: for a requested count, it gives 1.4 times as many points."""
    vertices, faces, _ = task

    def points(radius: float, seed: int) -> Array:  # its seed 0 is the time
        where, weights = module.sample_mesh_poisson_disk(
            vertices, faces, -1, radius=radius, random_seed=seed + 1
        )
        return np.asarray(module.interpolate_barycentric_coords(faces, where, weights, vertices))

    radius = fitted(lambda one: len(points(one, 0)), 0.75 * task.spacing, task.wanted)
    return lambda seed: points(radius, seed)


def point_cloud_utils_lloyd(module: Any, task: Task) -> Draw:
    vertices, faces, count = task
    return lambda _: np.asarray(module.sample_mesh_lloyd(vertices, faces, count))


def libigl(module: Any, task: Task) -> Draw:
    vertices, faces = task.vertices, task.faces.astype(np.int64)

    def points(radius: float) -> Array:
        return np.asarray(module.blue_noise(vertices, faces, radius)[2])

    radius = fitted(lambda one: len(points(one)), 0.75 * task.spacing, task.wanted)
    return lambda _: points(radius)


def pymeshlab(module: Any, task: Task) -> Draw:
    def draw(_: int) -> Array:
        meshes = module.MeshSet()
        meshes.add_mesh(module.Mesh(task.vertices, task.faces))
        meshes.generate_sampling_poisson_disk(samplenum=task.wanted, exactnumflag=True)
        return np.asarray(meshes.current_mesh().vertex_matrix())

    return draw


def open3d(module: Any, task: Task) -> Draw:
    def draw(seed: int) -> Array:
        module.utility.random.seed(seed)
        mesh = module.geometry.TriangleMesh(
            module.utility.Vector3dVector(task.vertices), module.utility.Vector3iVector(task.faces)
        )
        return np.asarray(mesh.sample_points_poisson_disk(task.wanted).points)

    return draw


def pyacvd(module: Any, task: Task) -> Draw:
    """Its clusters are of vertices, so a mesh of few gets about ten for each cluster first."""
    import pyvista  # type: ignore[import-not-found, unused-ignore]

    lacking = 10 * task.wanted / len(task.vertices)
    rounds = max(0, round(np.log(lacking) / np.log(4)))  # each makes four faces of one

    def draw(_: int) -> Array:
        mesh = pyvista.PolyData.from_regular_faces(task.vertices, task.faces)
        clusters = module.Clustering(mesh)
        if rounds:
            clusters.subdivide(rounds)
        clusters.cluster(task.wanted)
        return np.asarray(clusters.create_mesh().points, dtype=np.float64)

    return draw


def trimesh_even(module: Any, task: Task) -> Draw:
    def draw(seed: int) -> Array:
        mesh = module.Trimesh(task.vertices, task.faces, process=False)
        return np.asarray(module.sample.sample_surface_even(mesh, task.wanted, seed=seed)[0])

    return draw


def trimesh_random(module: Any, task: Task) -> Draw:
    def draw(seed: int) -> Array:
        mesh = module.Trimesh(task.vertices, task.faces, process=False)
        return np.asarray(module.sample.sample_surface(mesh, task.wanted, seed=seed)[0])

    return draw


def fitted(count_at: Callable[[float], int], radius: float, count: int) -> float:
    """The radius, from a guess on, that leaves about `count` points."""
    tried: dict[float, int] = {}
    for _ in range(ROUNDS):
        tried[radius] = count_at(radius)
        if abs(tried[radius] - count) <= CLOSE * count:
            break
        radius *= (max(tried[radius], 1) / count) ** 0.5
    return min(tried, key=lambda one: abs(tried[one] - count))


CONTENDERS = {
    "dapple": Contender("Dapple", "dapple3d", "sample(Surface(v, f), n)", dapple),
    "blender": Contender(
        "Blender, Poisson",
        "bpy",
        "Distribute Points on Faces, Poisson Disk; the distance that leaves about n",
        blender,
    ),
    "libigl": Contender(
        "libigl, Poisson", "igl", "blue_noise(v, f, r); the radius that leaves about n", libigl
    ),
    "open3d": Contender("Open3D, Poisson", "open3d", "sample_points_poisson_disk(n)", open3d),
    "pcu": Contender(
        "point-cloud-utils, Poisson",
        "point_cloud_utils",
        "sample_mesh_poisson_disk(v, f, -1, radius=r); the radius that leaves about n",
        point_cloud_utils_poisson,
    ),
    "pcu-lloyd": Contender(
        "point-cloud-utils, Lloyd",
        "point_cloud_utils",
        "sample_mesh_lloyd(v, f, n)",
        point_cloud_utils_lloyd,
    ),
    "pyacvd": Contender(
        "pyacvd",
        "pyacvd",
        "cluster(n), the points of create_mesh(); subdivide() first to about 10 n vertices",
        pyacvd,
    ),
    "pymeshlab": Contender(
        "PyMeshLab, Poisson",
        "pymeshlab",
        "generate_sampling_poisson_disk(samplenum=n, exactnumflag=True)",
        pymeshlab,
    ),
    "trimesh": Contender("trimesh, even", "trimesh", "sample_surface_even(mesh, n)", trimesh_even),
    "random": Contender(
        "trimesh, random", "trimesh", "sample_surface(mesh, n): white noise", trimesh_random
    ),
}
