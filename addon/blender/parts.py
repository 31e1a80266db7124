# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a surface part by part: between two of them the artist's events are let through.

Only what Blender has to hand out is done here, in the main thread; a worker puts it together.
Something may change between two parts: whoever reads watches for that and begins anew.
"""

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ..core.density import names_of
from ..core.errors import ScatterError
from ..core.raw import RawImage, RawMesh, RawValues, brightness, density_at_vertices, surface_of_raw
from ..core.settings import Settings
from ..core.steps import PAUSE, Task
from ..core.surface import Floats, SurfaceArrays, Surroundings
from .corners import corner_vertices
from .held import Held
from .meshio import evaluated_mesh
from .scatter import is_fluid, is_scatter
from .surroundings import balls, obstacles_of, read_camera, read_image, uv_layer
from .weights import GROUP_PART, group_weights, raw_values


@dataclass
class Read:
    """What was read of a surface and from beside it."""

    mesh: RawMesh
    values: list[RawValues] = field(default_factory=list)
    uv: Any = None  # (c, 2) of the corners
    image: RawImage | None = None
    camera: Floats | None = None
    obstacles: list[RawMesh] = field(default_factory=list)
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))
    radii: Floats = field(default_factory=lambda: np.empty(0))

    def arrays(self) -> SurfaceArrays:
        """All of it, as read_with would have read it; for a worker."""
        meshes = map(surface_of_raw, self.obstacles)
        around = Surroundings(
            image=None if self.image is None else brightness(self.image),
            camera=self.camera,
            obstacles=tuple((one.vertices, one.faces) for one in meshes if len(one.faces)),
            points=self.points,
            radii=self.radii,
        )
        values = {raw.name: density_at_vertices(self.mesh, raw) for raw in self.values}
        return surface_of_raw(self.mesh, values, around, self.uv)


Parts = Generator[Task, Any, Any]


def read_parts(settings: Settings, surface: Held, own: Held) -> Parts:
    """Read what these settings take from a surface and from beside it, for a scatter."""
    found = Read((yield from mesh_parts(surface)))
    for name in names_of(settings):
        found.values.append((yield from _value_parts(surface, found.mesh, name)))
    density = settings.density
    if density.image:
        found.uv = _read_uv(surface, found.mesh, density.uv_map)
        yield PAUSE
        found.image = read_image(density.image)
        yield PAUSE
    if density.use_camera:
        found.camera = read_camera(_depsgraph())
    if density.obstacles:
        others = obstacles_of(density.obstacles, surface.get(), own.get())
        found.points, found.radii = balls(others, density.obstacle_margin)
        for other in [Held(one) for one in others if not is_scatter(one)]:
            found.obstacles.append((yield from mesh_parts(other)))
    return found


def mesh_parts(surface: Held, known: RawMesh | None = None) -> Parts:
    """Read a mesh; what polygons it has, only where they are not those of one known before."""
    obj = surface.get()
    with evaluated_mesh(obj, _depsgraph()) as mesh:
        positions = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        if len(positions):
            mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
        corners, count = corner_vertices(mesh), len(mesh.polygons)
    matrix = np.array(obj.evaluated_get(_depsgraph()).matrix_world, dtype=np.float64)
    fluid = is_fluid(obj)
    if known is not None and len(known.starts) == count:
        found = RawMesh(obj.name, positions, corners, known.starts, known.cut, matrix, fluid)
        if found.same_faces(known):
            return found
    yield PAUSE
    starts = _starts(surface, len(corners), count)
    cut = None
    if np.max(np.diff(np.append(starts, len(corners))), initial=3) > 4:
        yield PAUSE
        cut = _cut(surface, len(corners))
    return RawMesh(obj.name, positions, corners, starts, cut, matrix, fluid)


def _starts(surface: Held, corner_count: int, count: int) -> Any:
    if corner_count == 3 * count:  # all are triangles
        return np.arange(0, corner_count, 3, dtype=np.int32)
    starts = np.empty(count, dtype=np.int32)
    with evaluated_mesh(surface.get(), _depsgraph()) as mesh:
        _check_count(surface, len(mesh.polygons), count)
        mesh.polygons.foreach_get("loop_start", starts)
    return starts


def _cut(surface: Held, corner_count: int) -> Any:
    """Blender's own triangles, of polygons that are not cut in an obvious way."""
    with evaluated_mesh(surface.get(), _depsgraph()) as mesh:
        _check_count(surface, len(mesh.loops), corner_count)
        mesh.calc_loop_triangles()
        cut = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("loops", cut)
    return cut.reshape(-1, 3)


def _value_parts(surface: Held, known: RawMesh, name: str) -> Parts:
    yield PAUSE
    obj = surface.get()
    with evaluated_mesh(obj, _depsgraph()) as mesh:
        _check_count(surface, len(mesh.vertices), len(known.positions))
        found = raw_values(obj, mesh, name)
    if found is not None:
        return found
    values = np.zeros(len(known.positions), dtype=np.float32)
    for first in range(0, len(values), GROUP_PART):
        yield PAUSE
        with evaluated_mesh(surface.get(), _depsgraph()) as mesh:
            _check_count(surface, len(mesh.vertices), len(values))
            part = slice(first, first + GROUP_PART)
            values[part] = group_weights(surface.get(), mesh, name, part)
    return RawValues(name, "POINT", values)


def _read_uv(surface: Held, known: RawMesh, name: str) -> Any:
    with evaluated_mesh(surface.get(), _depsgraph()) as mesh:
        _check_count(surface, len(mesh.loops), len(known.corners))
        places = np.empty((len(known.corners), 2), dtype=np.float32)
        uv_layer(surface.get(), mesh, name).uv.foreach_get("vector", places.ravel())
    return places


def _check_count(surface: Held, count: int, known: int) -> None:
    if count != known:
        raise ScatterError(f"Surface '{surface.name}' changed while it was read")


def _depsgraph() -> bpy.types.Depsgraph:
    return bpy.context.evaluated_depsgraph_get()
