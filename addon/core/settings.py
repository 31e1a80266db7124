# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sets before a scatter is optimized; field names as in the native package."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class ClassSettings:
    """One object type among several."""

    share: float = 1.0  # of the points that no class counts itself, in relation to other shares
    count: int = 0  # exactly so many; 0: by its share
    radius: float = 0.0  # of an instance, in world units: they are kept from overlapping
    density: str = ""  # values of the surface that multiply its density for this class


@dataclass(frozen=True)
class DensitySettings:
    """Terms that are multiplied; none: the same density everywhere. Angles in radians."""

    attribute: str = ""  # values of the surface's vertices, faces or corners, or a vertex group
    curvature: float = 0.0  # 0..1: how much thinner flat places are than bent ones
    use_slope: bool = False  # the angle between normal and world Z
    slope_from: float = 0.0
    slope_to: float = 0.7853982
    slope_fade: float = 0.1745329
    use_height: bool = False  # world Z
    height_from: float = 0.0
    height_to: float = 1.0
    height_fade: float = 0.1
    image: str = ""  # brightness of a picture
    uv_map: str = ""  # through these texture coordinates; none: those that renders use
    use_camera: bool = False  # where the scene's camera looks
    camera_margin: float = 0.1  # and so much beyond its frame, of half the frame
    obstacles: str = ""  # objects of a collection that points avoid
    obstacle_margin: float = 0.05  # by so much, in world units


@dataclass(frozen=True)
class Settings:
    """Options of one optimization."""

    count: int = 1000  # number of points, met exactly
    per_area: float = 0.0  # points on a unit of area where the density is 1; 0: count holds
    seed: int = 0  # another seed, another scatter
    capacity_weight: float = 30.0  # lambda: equal areas against regular spacing
    repulsion_weight: float = 3.0  # kappa: keeps neighbors apart
    tolerance: float = 5e-5  # stop at this relative decrease of the energy: smaller is more regular
    max_evaluations: int = 200  # stop after so many evaluations of the energy
    forward: str = "NONE"  # or an axis of the surface, X to -Z, along which instances point
    stickiness: float = 0.0  # gamma: points slide less on a deforming surface, and are less even
    classes: tuple[ClassSettings, ...] = ()  # none: all points are alike
    density: DensitySettings = DensitySettings()

    def sample_options(self) -> dict[str, Any]:
        """Keyword options of dapple.sample, without count, classes and density."""
        options = asdict(self)
        for name in ("count", "per_area", "forward", "stickiness", "classes", "density"):
            del options[name]
        return options

    def tracker_options(self) -> dict[str, Any]:
        """Keyword options of dapple.Tracker, which has a limit of evaluations of its own, without
        classes."""
        names = ("capacity_weight", "repulsion_weight", "tolerance", "stickiness")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True)
class BakeSettings:
    """What only a bake takes; the solution that it begins with has no part in it."""

    stickiness: float = 0.0
    key_every: int = 1  # frames from one key to the next
    smoothing: str = "FORWARDS"  # or BOTH_WAYS, LOOP
    count_over_time: str = "KEEP_COUNT"  # or KEEP_DENSITY
    fade: int = 0  # frames that a point takes to appear or to vanish, where some do
