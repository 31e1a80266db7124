# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of point sets and their spectra; needs matplotlib.

Each function returns a Figure of its own and leaves matplotlib's global state alone:

>>> from dapple3d import plot
>>> plot.radial_power(dapple.spectrum(points)).savefig("power.png")
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import RadialStatistics, Samples, Spectrum, SurfaceSpectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["anisotropy", "differentials", "periodogram", "points", "radial_power", "summary"]

SQUARE = (4.8, 4.2)  # inches
WIDE = (6.4, 3.6)
INK = "#1f3a5f"
ACCENT = "#c8553d"
BRIGHTEST = 3.0  # times white noise: the peaks of blue noise stay just below


def points(positions: ArrayLike | Samples, *, title: str = "") -> "Figure":
    """Draw points of the plane, or samples seen along z, colored by class.

    Args:
        positions: (n, 2) or (n, 3) float64, or Samples.
        title: shown above.

    Raises:
        ValueError: for an array of another shape.
        ImportError: matplotlib is not installed.
    """
    classes = positions.classes if isinstance(positions, Samples) else None
    array = np.asarray(positions.positions if isinstance(positions, Samples) else positions)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"positions has the shape {array.shape}: (n, 2) or (n, 3) is needed")
    figure, axes = _figure(SQUARE, title)
    many = classes is not None and len(np.unique(classes)) > 1
    colors: dict[str, Any] = {"c": classes, "cmap": "tab10"} if many else {"color": INK}
    size = float(np.clip(4000.0 / max(len(array), 1), 0.5, 30.0))
    axes[0].scatter(array[:, 0], array[:, 1], s=size, linewidths=0, **colors)
    axes[0].set(aspect="equal", xlabel="x", ylabel="y")
    return figure


def periodogram(spectrum: Spectrum | SurfaceSpectrum, *, title: str = "") -> "Figure":
    """Draw the power over the frequencies, without f = 0; white noise is an even 1.

    Args:
        spectrum: from dapple.spectrum() or dapple.surface_spectrum().
        title: shown above.

    Raises:
        ImportError: matplotlib is not installed.
    """
    figure, axes = _figure(SQUARE, title)
    _draw_periodogram(axes[0], _View(spectrum))
    return figure


def radial_power(spectrum: Spectrum | SurfaceSpectrum, *, title: str = "") -> "Figure":
    """Draw the mean power at each frequency; the dashed line is white noise.

    Args:
        spectrum: from dapple.spectrum() or dapple.surface_spectrum().
        title: shown above.

    Raises:
        ImportError: matplotlib is not installed.
    """
    figure, axes = _figure(WIDE, title)
    _draw_radial_power(axes[0], _View(spectrum))
    return figure


def anisotropy(spectrum: Spectrum | SurfaceSpectrum, *, title: str = "") -> "Figure":
    """Draw how much the power varies with direction, in decibels.

    In the plane the dashed line is white noise, -10 log10(runs): values near it mean that no
    direction is preferred.

    Args:
        spectrum: from dapple.spectrum() or dapple.surface_spectrum().
        title: shown above.

    Raises:
        ImportError: matplotlib is not installed.
    """
    figure, axes = _figure(WIDE, title)
    _draw_anisotropy(axes[0], _View(spectrum))
    return figure


def differentials(spectrum: SurfaceSpectrum, *, title: str = "") -> "Figure":
    """Draw the density of the differentials between samples, and its radial mean.

    Args:
        spectrum: from dapple.surface_spectrum().
        title: shown above.

    Raises:
        ImportError: matplotlib is not installed.
    """
    figure, (picture, curve) = _figure((10.0, 4.0), title, 2)
    _draw_image(picture, spectrum.differentials, spectrum.radius, "pairs / white noise")
    picture.set(xlabel="along the x axis / spacing", ylabel="across it / spacing")
    _draw_mean(curve, spectrum.radial_differentials, 1.0)
    curve.set(xlabel="distance / spacing", ylabel="pairs / white noise")
    return figure


def summary(spectrum: Spectrum | SurfaceSpectrum, *, title: str = "") -> "Figure":
    """Draw periodogram, radial mean power and anisotropy side by side.

    Args:
        spectrum: from dapple.spectrum() or dapple.surface_spectrum().
        title: shown above.

    Raises:
        ImportError: matplotlib is not installed.
    """
    figure, axes = _figure((13.2, 3.8), title, 3)
    view = _View(spectrum)
    _draw_periodogram(axes[0], view)
    _draw_radial_power(axes[1], view)
    _draw_anisotropy(axes[2], view)
    return figure


class _View:
    """The common interface of both spectra: powers at multiples of a frequency step."""

    def __init__(self, spectrum: Spectrum | SurfaceSpectrum) -> None:
        if isinstance(spectrum, Spectrum):
            self.power, self.radial = spectrum.periodogram, spectrum.radial
            self.unit = spectrum.frequency_unit
            self.reach = (spectrum.half_width + 0.5) / self.unit
            self.label = r"frequency / $\sqrt{n}$"
            self.white_noise: float | None = -10.0 * np.log10(spectrum.runs)
        else:
            self.power, self.radial = spectrum.power, spectrum.radial_power
            self.unit = 1.0
            self.reach = (spectrum.half_width + 0.5) * spectrum.frequency_step
            self.label = r"frequency / $\sqrt{n\,/\,\mathrm{area}}$"
            self.white_noise = None  # the estimates at near frequencies depend on each other


def _figure(size: tuple[float, float], title: str, columns: int = 1) -> "tuple[Figure, list[Axes]]":
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError(
            "dapple3d.plot draws with matplotlib, which is not installed: pip install matplotlib"
        ) from error
    figure = Figure(figsize=size, dpi=120, layout="constrained")
    axes = [figure.add_subplot(1, columns, k + 1) for k in range(columns)]
    if title:
        figure.suptitle(title, fontsize="medium")
    return figure, axes


def _draw_periodogram(axes: "Axes", view: _View) -> None:
    power = view.power.copy()
    middle = len(power) // 2
    power[middle, middle] = 0.0
    _draw_image(axes, power, view.reach, "power")
    axes.set(xlabel=view.label, ylabel=view.label)


def _draw_radial_power(axes: "Axes", view: _View) -> None:
    _draw_mean(axes, view.radial, view.unit)
    axes.set(xlabel=view.label, ylabel="radial mean power")


def _draw_anisotropy(axes: "Axes", view: _View) -> None:
    values = np.where(np.isfinite(view.radial.anisotropy), view.radial.anisotropy, np.nan)
    axes.plot(view.radial.radius / view.unit, values, color=ACCENT, linewidth=1.2)
    if view.white_noise is not None:
        _draw_level(axes, view.white_noise)
    low, high = axes.get_ylim()
    axes.set(xlabel=view.label, ylabel="anisotropy (dB)", ylim=(min(low, -20.0), max(high, 10.0)))
    axes.set_xlim(left=0.0)


def _draw_image(axes: "Axes", values: NDArray[np.float64], reach: float, label: str) -> None:
    image = axes.imshow(
        values,
        origin="lower",
        extent=(-reach, reach, -reach, reach),
        cmap="gray",
        vmin=0.0,
        vmax=BRIGHTEST,
        interpolation="nearest",
    )
    axes.figure.colorbar(image, ax=axes, label=label, shrink=0.85, extend="max")


def _draw_mean(axes: "Axes", radial: RadialStatistics, unit: float) -> None:
    axes.plot(radial.radius / unit, radial.mean, color=INK, linewidth=1.2)
    _draw_level(axes, 1.0)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)


def _draw_level(axes: "Axes", level: float) -> None:
    axes.axhline(level, color="0.6", linewidth=0.8, linestyle="--", label="white noise")
    axes.legend(loc="best", frameon=False, fontsize="small")
