# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a surface part by part: between two of them the artist's events are let through.

Only what Blender has to hand out is done here, in the main thread; a worker puts it together.
Something may change between two parts: whoever reads watches for that and begins anew.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...core.base.steps import PAUSE
from ...core.density.terms import names_of
from ...core.settings.values import DensitySettings, Settings, materials_of
from ...core.surface.arrays import Floats, Ints, SurfaceArrays, Surroundings
from ...core.surface.mesh_snapshot import RawImage, RawMesh, RawValues, laid_image, surface_of_raw
from ..base.object_handles import Held
from ..scatter.object import is_scatter
from .beside import check_targets, obstacles_of, targets_of
from .images import read_images
from .lines import read_lines
from .mesh_parts import Parts, evaluated, material_values, mesh_parts, read_uv, value_parts
from .surroundings import balls, read_camera


@dataclass
class Read:
    """What was read of a surface and from beside it."""

    mesh: RawMesh
    values: list[RawValues] = field(default_factory=list)
    uv: Any = None  # (c, 2) of the corners
    images: list[RawImage] = field(default_factory=list)  # one, or its tiles
    channel: str = ""  # of the image
    camera: Floats | None = None
    obstacles: list[RawMesh] = field(default_factory=list)
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))
    radii: Floats = field(default_factory=lambda: np.empty(0))
    targets: list[RawMesh] = field(default_factory=list)
    lines: list[Floats] = field(default_factory=lambda: [np.empty((0, 2, 3))])

    def arrays(self) -> SurfaceArrays:
        """All of it, as read_with would have read it; for a worker."""
        around = Surroundings(
            camera=self.camera,
            obstacles=_meshes(self.obstacles),
            points=self.points,
            radii=self.radii,
            targets=_meshes(self.targets),
            lines=np.concatenate(self.lines),
            **laid_image(self.images, self.channel),
        )
        return surface_of_raw(self.mesh, self.values, around, self.uv)


def _meshes(raw: list[RawMesh]) -> tuple[tuple[Floats, Ints], ...]:
    """Vertices and faces of those that have some."""
    found = map(surface_of_raw, raw)
    return tuple((one.vertices, one.faces) for one in found if len(one.faces))


def read_parts(settings: Settings, surface: Held, own: Held) -> Parts:
    """Read what these settings take from a surface and from beside it, for a scatter."""
    found = Read((yield from mesh_parts(surface)))
    for name in names_of(settings):
        found.values.append((yield from value_parts(surface, found.mesh, name)))
    density = settings.density
    if materials_of(density):
        yield PAUSE
        found.values.append(material_values(surface, found.mesh, materials_of(density)))
    if density.image:
        found.uv = read_uv(surface, found.mesh, density.uv_map)
        yield PAUSE
        found.channel = density.image_channel
        for image in read_images(density.image):
            found.images.append(image)
            yield PAUSE
    if density.use_camera:
        found.camera = read_camera(evaluated())
    if density.obstacles:
        others = obstacles_of(density.obstacles, surface.get(), own.get())
        found.points, found.radii = balls(others, density.obstacle_margin)
        for other in [Held(one) for one in others if not is_scatter(one)]:
            found.obstacles.append((yield from mesh_parts(other, shaded=False)))
    yield from _target_parts(found, density, surface, own)
    return found


def _target_parts(found: Read, density: DensitySettings, surface: Held, own: Held) -> Parts:
    """Read what a distance is measured to."""
    for other in [Held(one) for one in targets_of(density, surface.get(), own.get())]:
        lines = read_lines(other.get(), evaluated())
        if lines is None:
            found.targets.append((yield from mesh_parts(other, shaded=False)))
        else:
            found.lines.append(lines)
        yield PAUSE
    check_targets(density, len(found.targets) + sum(map(len, found.lines)))
