# SPDX-License-Identifier: GPL-3.0-or-later
"""What a density takes from beside its surface: an image, the camera, objects to avoid."""

from dataclasses import replace
from typing import Any

import bpy
import numpy as np

from ...core.density import names_of
from ...core.errors import ScatterError
from ...core.raw import laid_image
from ...core.records import check_columns
from ...core.settings import DensitySettings, Settings, materials_of
from ...core.surface import Floats, Ints, SurfaceArrays, Surroundings
from ..base.meshio import read_columns, read_points, to_world
from ..data.scatter import is_scatter
from .beside import check_targets, obstacles_of, targets_of
from .images import read_images
from .lines import read_lines
from .surface_mesh import evaluated_mesh, read_surface


def read_with(
    settings: Settings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None = None,
) -> SurfaceArrays:
    """The evaluated surface with all that these settings take from it and from beside it.

    own is the scatter that they are for: nothing that it makes or places is its obstacle.
    """
    arrays = read_surface(obj, depsgraph, names_of(settings), materials_of(settings.density))
    return replace(arrays, around=read_around(settings, obj, depsgraph, own))


def read_around(
    settings: Settings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None,
) -> Surroundings:
    """What these settings take from beside a surface, for this scatter."""
    density, points, radii, meshes = settings.density, np.empty((0, 3)), np.empty(0), []
    if density.obstacles:
        others = obstacles_of(density.obstacles, obj, own)
        points, radii = balls(others, density.obstacle_margin)
        meshes = [_mesh(other, depsgraph) for other in others if not is_scatter(other)]
    targets, lines = _targets(density, obj, depsgraph, own)
    return Surroundings(
        uv=_uv(obj, density.uv_map, depsgraph) if density.image else None,
        camera=read_camera(depsgraph) if density.use_camera else None,
        obstacles=tuple(mesh for mesh in meshes if len(mesh[1])),
        points=points,
        radii=radii,
        targets=targets,
        lines=lines,
        **_picture(density.image, density.image_channel),
    )


def _targets(
    density: DensitySettings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None,
) -> tuple[tuple[tuple[Floats, Ints], ...], Floats]:
    """Meshes and lines that a distance is measured to."""
    meshes, lines = [], [np.empty((0, 2, 3))]
    for other in targets_of(density, obj, own):
        found = read_lines(other, depsgraph)
        if found is None:
            meshes.append(_mesh(other, depsgraph))
        else:
            lines.append(found)
    check_targets(density, len(meshes) + sum(map(len, lines)))
    return tuple(meshes), np.concatenate(lines)


def _uv(obj: bpy.types.Object, name: str, depsgraph: bpy.types.Depsgraph) -> Floats:
    """Texture coordinates (m, 3, 2) of the triangles' corners."""
    with evaluated_mesh(obj, depsgraph) as mesh:
        layer = uv_layer(obj, mesh, name)
        places = np.empty(2 * len(mesh.loops), dtype=np.float32)
        layer.uv.foreach_get("vector", places)
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("loops", corners)
    matrix = np.array(obj.evaluated_get(depsgraph).matrix_world)
    found = places.reshape(-1, 2)[corners].reshape(-1, 3, 2).astype(np.float64)
    if np.linalg.det(matrix[:3, :3]) < 0.0:  # as read_surface turns the faces
        found = found[:, ::-1]
    return np.ascontiguousarray(found)


def uv_layer(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer:
    """The UV map of that name of an object's evaluated mesh; none: the one that renders use."""
    layers = mesh.uv_layers
    layer = layers.get(name) if name else next((one for one in layers if one.active_render), None)
    if layer is None:
        wanted = f"no UV map '{name}'" if name else "no UV map, which an image needs"
        raise ScatterError(f"Surface '{obj.name}' has {wanted}")
    return layer


def _picture(name: str, channel: str) -> dict[str, Any]:
    return laid_image(list(read_images(name)), channel) if name else {}


def check_camera(scene: bpy.types.Scene) -> None:
    """ScatterError if a scene has none."""
    if scene.camera is None:
        raise ScatterError(f"Scene '{scene.name}' has no camera, which Camera View needs")


def picture_of(scene: bpy.types.Scene) -> tuple[float, ...]:
    """Width and height of a render, and of its pixels."""
    render = scene.render
    size = (render.resolution_x, render.resolution_y)
    return (*size, render.pixel_aspect_x, render.pixel_aspect_y)


def read_camera(depsgraph: bpy.types.Depsgraph) -> Floats:
    """World space to clip space of the scene's camera."""
    scene = depsgraph.scene
    check_camera(scene)
    camera, (x, y, scale_x, scale_y) = scene.camera.evaluated_get(depsgraph), picture_of(scene)
    frame = camera.calc_matrix_camera(
        depsgraph, x=int(x), y=int(y), scale_x=scale_x, scale_y=scale_y
    )
    there = np.array(camera.matrix_world, dtype=np.float64)
    there[:3, :3] /= np.linalg.norm(there[:3, :3], axis=0)  # renders ignore a camera's scale
    found: Floats = np.array(frame, dtype=np.float64) @ np.linalg.inv(there)
    return found


def _mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[Floats, Ints]:
    arrays = read_surface(obj, depsgraph)
    return arrays.vertices, arrays.faces


def balls(others: list[bpy.types.Object], margin: float) -> tuple[Floats, Floats]:
    """Points of other scatters as they were optimized, and how far to keep away from each."""
    points, radii = [np.empty((0, 3))], [np.empty(0)]
    for obj in others:
        if is_scatter(obj):
            places = read_points(obj.data)
            check_columns({"position": places}, obj.name)
            places = to_world(obj, places)
            points.append(places)
            radii.append(np.maximum(_radii(obj, len(places)), margin))
    joined, sizes = np.concatenate(points), np.concatenate(radii)
    return joined[sizes > 0.0], sizes[sizes > 0.0]


def _radii(obj: bpy.types.Object, count: int) -> Floats:
    """Of a scatter's instances, by their classes; 0 where none is set."""
    own = np.array([kind.radius for kind in obj.dapple.classes])
    if not len(own) or "dapple_class" not in obj.data.attributes:
        return np.zeros(count)
    columns = read_columns(obj.data, {"dapple_class": "INT"})
    check_columns(columns, obj.name)
    found: Floats = own[np.minimum(columns["dapple_class"], len(own) - 1)]
    return found
