# SPDX-License-Identifier: GPL-3.0-or-later
"""What a density takes from beside its surface: an image, the camera, objects to avoid."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np

from ...core.bake.keys import Baked
from ...core.base.errors import ScatterError
from ...core.density.terms import names_of
from ...core.settings.values import DensitySettings, Settings, materials_of
from ...core.surface.arrays import Floats, Ints, SurfaceArrays, Surroundings
from ...core.surface.mesh_snapshot import laid_image
from ...core.surface.records import check_columns
from ..base.mesh_arrays import matrix_of, read_columns
from ..scatter.object import is_scatter
from .beside import check_targets, obstacles_of, targets_of
from .images import is_film, read_images
from .joined import parts_of
from .lines import read_lines
from .played import points_now
from .surface_mesh import evaluated_mesh, read_surface

# Modifiers that leave weights as they are wherever vertices stay.
_KEEPS_WEIGHTS = {
    "ARMATURE",
    "CAST",
    "CLOTH",
    "COLLISION",
    "CORRECTIVE_SMOOTH",
    "CURVE",
    "DISPLACE",
    "HOOK",
    "LAPLACIANDEFORM",
    "LAPLACIANSMOOTH",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "MULTIRES",
    "NORMAL_EDIT",
    "SHRINKWRAP",
    "SIMPLE_DEFORM",
    "SMOOTH",
    "SOFT_BODY",
    "SUBSURF",
    "SURFACE",
    "SURFACE_DEFORM",
    "TRIANGULATE",
    "WARP",
    "WAVE",
    "WEIGHTED_NORMAL",
}


@dataclass
class Known:
    """What was read on a frame before, where it cannot have changed."""

    arrays: SurfaceArrays | None = None  # of the first frame with its faces
    meshes: dict[int, tuple[Any, ...]] = field(default_factory=dict)  # place, vertices, faces
    picture: dict[str, Any] | None = None
    scatters: dict[int, Baked] = field(default_factory=dict)  # keys of those that are baked

    def like(self, topology: str) -> SurfaceArrays | None:
        """What was read of the same polygons."""
        same = self.arrays is not None and self.arrays.topology == topology
        return self.arrays if same else None


def read_with(
    settings: Settings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None = None,
    known: Known | None = None,
) -> SurfaceArrays:
    """The evaluated surface with all that these settings take from it and from beside it.

    own is the scatter that they are for: nothing that it makes or places is its obstacle. known
    saves what reading again would find unchanged, from frame to frame of a bake.
    """
    names, materials = names_of(settings), materials_of(settings.density)
    if known is None:
        arrays = read_surface(obj, depsgraph, names, materials)
        return replace(arrays, around=read_around(settings, obj, depsgraph, own))
    first, still = known.arrays, lasting(obj, names)
    fresh = [name for name in names if name not in still]
    arrays = read_surface(obj, depsgraph, fresh, materials, like=first)
    if first is None or first.topology != arrays.topology:
        if still:
            arrays = read_surface(obj, depsgraph, names, materials)
        known.arrays = first = arrays
    weights = {name: first.weights[name] for name in still}
    arrays = replace(
        arrays, weights=weights | arrays.weights, digests=first.digests | arrays.digests
    )
    return replace(arrays, around=read_around(settings, obj, depsgraph, own, known, arrays))


def read_around(
    settings: Settings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None,
    known: Known | None = None,
    arrays: SurfaceArrays | None = None,
) -> Surroundings:
    """What these settings take from beside a surface, for this scatter."""
    density, points, radii, meshes = settings.density, np.empty((0, 3)), np.empty(0), []
    known = known or Known()
    if density.obstacles:
        others = obstacles_of(density.obstacles, obj, own)
        points, radii = balls(others, density.obstacle_margin, known.scatters)
        meshes = [_mesh(other, depsgraph, known) for other in others if not is_scatter(other)]
    targets, lines = _targets(density, obj, depsgraph, own, known)
    return Surroundings(
        uv=_uv(obj, density.uv_map, depsgraph, arrays) if density.image else None,
        camera=read_camera(depsgraph) if density.use_camera else None,
        obstacles=tuple(mesh for mesh in meshes if len(mesh[1])),
        points=points,
        radii=radii,
        targets=targets,
        lines=lines,
        **_picture(density.image, density.image_channel, known),
    )


def _targets(
    density: DensitySettings,
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    own: bpy.types.Object | None,
    known: Known,
) -> tuple[tuple[tuple[Floats, Ints], ...], Floats]:
    """Meshes and lines that a distance is measured to."""
    meshes, lines = [], [np.empty((0, 2, 3))]
    for other in targets_of(density, obj, own):
        found = read_lines(other, depsgraph, known.scatters)
        if found is None:
            meshes.append(_mesh(other, depsgraph, known))
        else:
            lines.append(found)
    check_targets(density, len(meshes) + sum(map(len, lines)))
    return tuple(meshes), np.concatenate(lines)


def _uv(
    obj: bpy.types.Object,
    name: str,
    depsgraph: bpy.types.Depsgraph,
    arrays: SurfaceArrays | None = None,
) -> Floats:
    """Texture coordinates (m, 3, 2) of the triangles' corners, as they were read if given."""
    with evaluated_mesh(obj, depsgraph) as mesh:
        layer = uv_layer(obj, mesh, name)
        places = np.empty(2 * len(mesh.loops), dtype=np.float32)
        layer.uv.foreach_get("vector", places)
        if arrays is not None and arrays.loops is not None:
            return np.ascontiguousarray(places.reshape(-1, 2)[arrays.loops].astype(np.float64))
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


def _picture(name: str, channel: str, known: Known) -> dict[str, Any]:
    if not name:
        return {}
    if known.picture is None or is_film(name):
        known.picture = laid_image(list(read_images(name)), channel)
    return known.picture


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


def _mesh(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, known: Known
) -> tuple[Floats, Ints]:
    place = matrix_of(obj.evaluated_get(depsgraph))
    before = known.meshes.get(obj.session_uid)
    if before is not None and is_rigid(obj) and np.array_equal(before[0], place):
        return before[1], before[2]
    arrays = read_surface(obj, depsgraph)
    known.meshes[obj.session_uid] = (place, arrays.vertices, arrays.faces)
    return arrays.vertices, arrays.faces


def balls(
    others: list[bpy.types.Object], margin: float, known: dict[int, Baked] | None = None
) -> tuple[Floats, Floats]:
    """Points of other scatters as they are now, and how far to keep away from each."""
    points, radii = [np.empty((0, 3))], [np.empty(0)]
    for obj in others:
        if is_scatter(obj):
            places, there = points_now(obj, {} if known is None else known)
            check_columns({"position": places}, obj.name)
            points.append(places[there])
            radii.append(np.maximum(_radii(obj, len(places)), margin)[there])
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


def lasting(obj: bpy.types.Object, names: Iterable[str]) -> list[str]:
    """Those of a surface's values that no frame changes: vertex groups, which are slow to read,
    below modifiers that leave them alone.
    """
    parts = parts_of(obj)
    kept = all(
        modifier.type in _KEEPS_WEIGHTS for part in parts for modifier in part.modifiers
    ) and not any(_is_animated(part.data) for part in parts)
    if not kept:
        return []
    attributes = {one.name for part in parts for one in getattr(part.data, "attributes", ())}
    return [name for name in names if name not in attributes]


def is_rigid(obj: bpy.types.Object) -> bool:
    """Whether the shape of an object is the same on all frames."""
    mesh = obj.data
    plain = obj.type == "MESH" and not obj.modifiers and not mesh.shape_keys
    return bool(plain and not _is_animated(mesh))


def _is_animated(block: bpy.types.ID) -> bool:
    return getattr(block, "animation_data", None) is not None
