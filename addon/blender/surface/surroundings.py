# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of a density besides its surface: an image, the camera, objects to avoid."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ...core.bake.keys import Baked
from ...core.base.errors import ScatterError
from ...core.base.steps import PAUSE, run_now
from ...core.export import LongInts
from ...core.settings.values import DensitySettings, Settings
from ...core.surface.arrays import Floats, Ints, SurfaceArrays, Surroundings
from ...core.surface.mesh_snapshot import RawImage, RawMesh, image_density, surface_of_raw
from ...core.surface.records import check_columns
from ..base.mesh_arrays import matrix_of, read_columns
from ..base.object_handles import ObjectHandle
from ..scatter.instance_shapes import InstanceShapes
from ..scatter.object import is_scatter
from .avoided_shapes import KnownShapes, avoided_shapes
from .images import is_film, read_images
from .joined_parts import parts_of
from .mesh import Parts, evaluated, mesh_parts, read_uv
from .playback import points_now
from .scene_objects import check_targets, obstacles_of, read_lines, targets_of

# Modifiers that do not change weights of the vertices that stay.
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


_NONE = np.empty(0, dtype=np.int32)


@dataclass
class Known:
    """Data of previous frames that cannot have changed."""

    mesh: RawMesh | None = None  # the first frame with these faces
    arrays: SurfaceArrays | None = None  # the arrays made from it
    meshes: dict[int, RawMesh] = field(default_factory=dict)  # other meshes
    picture: dict[str, Any] | None = None
    scatters: dict[int, Baked] = field(default_factory=dict)  # keyframes of baked scatters
    shapes: dict[int, KnownShapes] = field(default_factory=dict)  # of the instances of scatters

    def like(self, topology: str) -> SurfaceArrays | None:
        """The arrays that were read for the same polygons."""
        same = self.arrays is not None and self.arrays.topology == topology
        return self.arrays if same else None


@dataclass
class Nearby:
    """The inputs besides a surface, as they were read."""

    uv: Any = None  # (c, 2) of the surface's corners
    images: list[RawImage] = field(default_factory=list)  # one image, or its tiles
    channel: str = ""  # of the image
    picture: dict[str, Any] | None = None  # the density of the images, if it is known
    camera: Floats | None = None
    obstacles: list[RawMesh] = field(default_factory=list)
    hiding: list[RawMesh] = field(default_factory=list)
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))
    radii: Floats = field(default_factory=lambda: np.empty(0))
    hulls: list[InstanceShapes] = field(default_factory=list)
    targets: list[RawMesh] = field(default_factory=list)
    lines: list[Floats] = field(default_factory=lambda: [np.empty((0, 2, 3))])

    def surroundings(self) -> Surroundings:
        """All inputs except texture coordinates, which belong to triangles; called in a worker."""
        if self.picture is None:
            self.picture = image_density(self.images, self.channel)
        return Surroundings(
            camera=self.camera,
            obstacles=_solids(self.obstacles),
            hiding=_solids(self.hiding),
            points=self.points,
            radii=self.radii,
            hulls=np.concatenate([np.empty((0, 3)), *(one.points for one in self.hulls)]),
            hull_counts=np.concatenate([_NONE, *(one.counts for one in self.hulls)]),
            targets=_solids(self.targets),
            lines=np.concatenate(self.lines),
            **self.picture,
        )


def _solids(meshes: list[RawMesh]) -> tuple[tuple[Floats, Ints], ...]:
    """Vertices and faces of the meshes that have faces."""
    return tuple(one.solid for one in meshes if len(one.solid[1]))


def nearby_parts(
    density: DensitySettings,
    surface: ObjectHandle,
    own: ObjectHandle | None,
    mesh: RawMesh | None,
    known: Known,
) -> Parts:
    """Read the inputs of a density besides its surface.

    The scatter `own` does not avoid its own objects. The mesh of the surface is needed if there is
    an image.
    """
    found = Nearby()
    if density.image:
        found.uv = read_uv(surface, mesh, density.uv_map) if mesh is not None else None
        yield PAUSE
        yield from _picture_parts(found, density, known)
    if density.use_camera_view:
        found.camera = read_camera(evaluated())
        if density.camera_hidden and density.hiding_collection:
            others = obstacles_of(density.hiding_collection, surface.get(), _object(own))
            found.hiding = yield from _solid_parts(others, known)
    if density.avoid_collection:
        others = obstacles_of(density.avoid_collection, surface.get(), _object(own))
        found.hulls, shaped = avoided_shapes(others, density.avoid_shape, known.shapes)
        found.points, found.radii = balls(others, density.avoid_margin, known.scatters, shaped)
        yield PAUSE
        found.obstacles = yield from _solid_parts(others, known)
    yield from _target_parts(found, density, surface, own, known)
    return found


def _object(handle: ObjectHandle | None) -> bpy.types.Object | None:
    return handle.get() if handle is not None else None


def _picture_parts(found: Nearby, density: DensitySettings, known: Known) -> Parts:
    if known.picture is not None and not is_film(density.image):
        found.picture = known.picture
        return
    found.channel = density.image_channel
    for image in read_images(density.image):
        found.images.append(image)
        yield PAUSE


def _nearby_mesh(other: ObjectHandle, known: Known) -> Parts:
    obj = other.get()
    before = known.meshes.get(other.uid)
    place = matrix_of(obj.evaluated_get(evaluated()))
    if before is not None and is_rigid(obj) and np.array_equal(before.matrix, place):
        return before
    known.meshes[other.uid] = mesh = yield from mesh_parts(other, shaded=False)
    return mesh


def _solid_parts(others: list[bpy.types.Object], known: Known) -> Parts:
    """Read the meshes of objects, without those of scatters."""
    found = []
    for other in [ObjectHandle(one) for one in others if not is_scatter(one)]:
        found.append((yield from _nearby_mesh(other, known)))
    return found


def _target_parts(
    found: Nearby,
    density: DensitySettings,
    surface: ObjectHandle,
    own: ObjectHandle | None,
    known: Known,
) -> Parts:
    """Read the objects to which a distance is measured."""
    for other in [ObjectHandle(one) for one in targets_of(density, surface.get(), _object(own))]:
        lines = read_lines(other.get(), evaluated(), known.scatters)
        if lines is None:
            found.targets.append((yield from _nearby_mesh(other, known)))
        else:
            found.lines.append(lines)
        yield PAUSE
    check_targets(density, len(found.targets) + sum(map(len, found.lines)))


def read_around(
    settings: Settings, obj: bpy.types.Object, own: bpy.types.Object | None
) -> Surroundings:
    """The inputs besides the surface that a scatter's settings need."""
    surface, scatter = ObjectHandle(obj), ObjectHandle(own) if own is not None else None
    mesh = run_now(mesh_parts(surface, shaded=False)) if settings.density.image else None
    found = run_now(nearby_parts(settings.density, surface, scatter, mesh, Known()))
    around: Surroundings = found.surroundings()
    return around if mesh is None else surface_of_raw(mesh, (), around, found.uv).around


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


def balls(
    others: list[bpy.types.Object],
    margin: float,
    known: dict[int, Baked] | None = None,
    shaped: dict[int, LongInts] | None = None,
) -> tuple[Floats, Floats]:
    """Current points of other scatters, and the distance to keep from each, without those whose
    instances have other shapes: their ids by the scatters' session_uid.
    """
    points, radii = [np.empty((0, 3))], [np.empty(0)]
    for obj in others:
        if is_scatter(obj):
            places, there = points_now(obj, {} if known is None else known)
            check_columns({"position": places}, obj.name)
            if shaped and obj.session_uid in shaped:
                own = read_columns(obj.data, {"id": "INT"})["id"]
                there = there & ~np.isin(own, shaped[obj.session_uid])
            points.append(places[there])
            radii.append(np.maximum(_radii(obj, len(places)), margin)[there])
    joined, sizes = np.concatenate(points), np.concatenate(radii)
    return joined[sizes > 0.0], sizes[sizes > 0.0]


def _radii(obj: bpy.types.Object, count: int) -> Floats:
    """Radius of each instance of a scatter by its object type; 0 if none is set."""
    own = np.array([kind.radius for kind in obj.dapple.object_types])
    if not len(own) or "dapple_object_type" not in obj.data.attributes:
        return np.zeros(count)
    columns = read_columns(obj.data, {"dapple_object_type": "INT"})
    check_columns(columns, obj.name)
    found: Floats = own[np.minimum(columns["dapple_object_type"], len(own) - 1)]
    return found


def lasting(obj: bpy.types.Object, names: Iterable[str]) -> list[str]:
    """Names of the surface's values that do not change between frames.

    These are vertex groups, which are slow to read, below modifiers that do not change them.
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
    """Whether the shape of an object is the same in all frames."""
    mesh = obj.data
    plain = obj.type == "MESH" and not obj.modifiers and not mesh.shape_keys
    return bool(plain and not _is_animated(mesh))


def _is_animated(block: bpy.types.ID) -> bool:
    return getattr(block, "animation_data", None) is not None
