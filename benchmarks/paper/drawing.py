# SPDX-License-Identifier: GPL-3.0-or-later
"""Sites, cells and spectra of the plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import dapple3d as dapple
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.spatial import Voronoi  # type: ignore[import-untyped]

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
INK, ACCENT, PALE = "#1f3a5f", "#c8553d", "#dfe7f1"
CLASS_COLORS = ["#c8553d", "#1f6fb2", "#3a8f4d"]
DPI = 110


SIDES = {5: "#f2d7a0", 6: PALE, 7: "#b9d9c0"}  # of a cell; what has fewer or more is gray


def sheet(
    rows: int, columns: int, side: float = 3.0, ratio: float = 1.0
) -> tuple[Figure, list[list[Axes]]]:
    """A figure of so many axes, each about `side` inches wide; ratio: of height to width."""
    size = (side * columns, side * ratio * rows)
    figure = Figure(figsize=size, dpi=DPI, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    return figure, [list(row) for row in axes]


def show(axes: Axes, picture: NDArray[np.uint8], title: str) -> None:
    """A picture without a frame."""
    axes.imshow(picture, cmap="gray")  # the map counts for gray ones only
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)


def bare(axes: Axes, title: str = "") -> None:
    axes.set(xticks=[], yticks=[], aspect="equal")
    axes.set_title(title, fontsize=9)


def periodic_images(points: Array) -> Array:
    """Points (9 n, 2) of the unit torus and around it; the first n are those within."""
    shifts = [(0, 0)] + [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]
    return np.vstack([points + shift for shift in shifts])


def draw_cells(axes: Axes, points: Array) -> None:
    """Sites and Voronoi cells of the unit torus, colored by how many sides they have."""
    found = Voronoi(periodic_images(points))
    regions = [found.regions[k] for k in found.point_region]
    polygons = [found.vertices[region] for region in regions if region and -1 not in region]
    colors = [SIDES.get(len(polygon), "0.8") for polygon in polygons]
    axes.add_collection(PolyCollection(polygons, facecolors=colors, edgecolors=INK, linewidths=0.4))
    axes.scatter(points[:, 0], points[:, 1], s=3.0, color=INK, linewidths=0, zorder=3)
    axes.set(xlim=(0, 1), ylim=(0, 1))


def draw_points(
    axes: Axes, points: Array, colors: str | list[str] = INK, size: float = 0.0
) -> None:
    """Points of the unit square."""
    size = size or float(np.clip(2500.0 / max(len(points), 1), 0.3, 12.0))
    axes.scatter(points[:, 0], points[:, 1], s=size, c=colors, linewidths=0)
    axes.set(xlim=(0, 1), ylim=(0, 1))


def draw_periodogram(axes: Axes, spectrum: dapple.Spectrum, title: str = "") -> None:
    """Black is 0, white three times white noise; f = 0 is left out."""
    power = spectrum.periodogram.copy()
    power[spectrum.half_width, spectrum.half_width] = 0.0
    axes.imshow(power, origin="lower", cmap="gray", vmin=0.0, vmax=3.0, interpolation="nearest")
    bare(axes, title)


def draw_radial(axes: Axes, radial: dapple.RadialStatistics, unit: float, title: str = "") -> None:
    """Mean power (dark, left scale) and anisotropy in dB (red, right) over the frequency."""
    reach = radial.radius / unit
    axes.plot(reach, radial.mean, color=INK, linewidth=1.0)
    axes.axhline(1.0, color="0.7", linewidth=0.6, linestyle="--")
    axes.set(xlim=(0, reach[-1]), ylim=(0, 4))
    axes.set_title(title, fontsize=9)
    axes.tick_params(labelsize=7)
    other = axes.twinx()
    other.plot(
        reach,
        np.where(np.isfinite(radial.anisotropy), radial.anisotropy, np.nan),
        color=ACCENT,
        linewidth=0.8,
    )
    other.set_ylim(-30, 20)
    other.tick_params(labelsize=7, labelcolor=ACCENT)
    axes.set_xlabel(r"frequency / $\sqrt{n\,/\,\mathrm{area}}$", fontsize=7)


def half_frequency(radial: dapple.RadialStatistics, unit: float) -> float:
    """Mean power at 0.3 to 0.7 of the frequency sqrt(n / area); white noise has 1."""
    reach = radial.radius / unit
    return float(np.mean(radial.mean[(reach > 0.3) & (reach < 0.7)]))


def peak(radial: dapple.RadialStatistics) -> float:
    """The highest mean power of any frequency; the more regular, the higher."""
    return float(np.nanmax(radial.mean[1:]))
