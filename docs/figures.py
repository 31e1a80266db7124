# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the diagrams of the pages: build/venv/bin/python docs/figures.py [FOLDER]"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dapple3d as dapple
import matplotlib
import numpy as np
from dapple3d import density
from dapple3d.extras.distributed import HeightField, sample_tiles
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

IMAGES = Path(__file__).resolve().parent / "images"
Floats = NDArray[np.float64]

INK = "#1f3a5f"
ACCENT = "#c8553d"
PALE = "#dde6f0"
LINE = "#8fa3ba"
GRAY = "#9a9a9a"
OWNERS = ("#3b6ea5", "#e0a030", "#5a9e6f", "#b05a9a", "#7a6a5a", "#40a0b0", "#c8553d", "#8880c8")
MINUS = {"arrowstyle": "-", "color": INK, "lw": 0.8}


def plain(size: tuple[float, float], columns: int = 1, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure whose axes show nothing but what is drawn."""
    figure = Figure(figsize=size, layout="constrained")
    axes = [figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)]
    for one in axes:
        one.set_aspect("equal")
        one.axis("off")
    return figure, axes


def label(axes: Axes, text: str, at: Any, to: Any = None, color: str = INK) -> None:
    """A text, with a line to what it names."""
    arrow = MINUS | {"color": color} if to is not None else None
    where: dict[str, Any] = {"ha": "center", "va": "center", "color": color, "fontsize": 11}
    where["annotation_clip"] = False
    axes.annotate(text, at if to is None else to, at, arrowprops=arrow, **where)


# ---- cells and tiles ----


SLOPE = np.radians(33.0)  # of both halves of the folded sheet


def folded_sheet() -> dapple.Surface:
    """Two rectangles that meet in a ridge along y."""
    x, z = np.cos(SLOPE), np.sin(SLOPE)
    rows = [(-x, 0, 0), (0, 0, z), (x, 0, 0), (-x, 1.5, 0), (0, 1.5, z), (x, 1.5, 0)]
    faces = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)]
    return dapple.Surface(np.array(rows, dtype=np.float64), np.array(faces))


def seen(points: Floats) -> Floats:
    """Points as seen from above, obliquely."""
    turn, tilt = np.radians(14.0), np.radians(52.0)
    x = np.cos(turn) * points[:, 0] + np.sin(turn) * points[:, 1]
    y = -np.sin(turn) * points[:, 0] + np.cos(turn) * points[:, 1]
    return np.stack([x, np.sin(tilt) * y + np.cos(tilt) * points[:, 2]], axis=1)


def polygons(mosaic: dapple.Mosaic) -> Iterator[tuple[int, Floats]]:
    """The site and the corners of each polygon."""
    vertices = seen(mosaic.vertices)
    for k, site in enumerate(mosaic.sites):
        yield int(site), vertices[mosaic.corners[mosaic.starts[k] : mosaic.starts[k + 1]]]


def draw_tiles(axes: Axes, mosaic: dapple.Mosaic, chosen: int, edge: str) -> None:
    for site, corners in polygons(mosaic):
        color = "#f0b9a8" if site == chosen else PALE
        axes.add_patch(Polygon(corners, facecolor=color, edgecolor=edge, lw=0.9))


def cells() -> Figure:
    surface = folded_sheet()
    samples = dapple.sample(surface, 22, seed=3)
    sites = seen(samples.positions)
    ridge = seen(np.array([[0.0, 0.0, np.sin(SLOPE)], [0.0, 1.5, np.sin(SLOPE)]]))
    chosen = int(np.argmin(np.linalg.norm(sites - ridge.mean(axis=0), axis=1)))
    figure, (left, right) = plain((9.0, 3.6), columns=2)
    whole = dapple.mosaic(surface, samples)
    draw_tiles(left, whole, chosen, LINE)
    draw_tiles(right, dapple.mosaic(surface, samples, grout=0.07), chosen, "none")
    for site, corners in polygons(whole):
        if site == chosen:
            right.add_patch(Polygon(corners, fill=False, edgecolor=ACCENT, lw=1.0, ls="--"))
    for axes in (left, right):
        axes.plot(*ridge.T, color=INK, lw=1.2, ls=(0, (6, 3)))
        axes.plot(*sites.T, "o", color=INK, ms=3.5)
        axes.plot(*sites[chosen], "o", color=ACCENT, ms=5.5)
    name_parts(left, whole, chosen, sites[chosen])
    label(left, "fold", ridge[1] + np.array([0.0, 0.1]))
    x, y = sites[chosen]
    label(right, "grout", (x - 0.6, y + 0.42), common_boundary(whole, chosen).mean(axis=0), ACCENT)
    right.set(xlim=(x - 0.7, x + 0.7), ylim=(y - 0.5, y + 0.5))
    return figure


def name_parts(axes: Axes, mosaic: dapple.Mosaic, chosen: int, x: Floats) -> None:
    boundary = common_boundary(mosaic, chosen)
    axes.plot(*boundary.T, color=ACCENT, lw=2.6, solid_capstyle="round")
    left, right = x[0] - 1.35, x[0] + 1.35
    label(axes, "site $x_i$", (right, x[1] + 0.65), x)
    label(axes, "cell $V_i$", (left, x[1] - 0.75), x - np.array([0.06, 0.07]))
    label(axes, "boundary $V_{ij}$", (left, x[1] + 0.6), boundary.mean(axis=0), ACCENT)


def common_boundary(mosaic: dapple.Mosaic, chosen: int) -> Floats:
    """The longest edge between the chosen cell and another."""
    edges: dict[tuple[tuple[float, ...], ...], set[int]] = {}
    for site, corners in polygons(mosaic):
        rounded = [tuple(corner) for corner in corners.round(6).tolist()]
        for a, b in zip(rounded, rounded[1:] + rounded[:1], strict=True):
            edges.setdefault((min(a, b), max(a, b)), set()).add(site)
    shared = [ends for ends, owners in edges.items() if chosen in owners and len(owners) == 2]
    return max(map(np.array, shared), key=lambda ends: float(np.linalg.norm(ends[1] - ends[0])))


# ---- uncovered faces ----

GAP = 0.16  # between the sheets
LENGTH = 3.0  # of each sheet


def hairpin(count: int) -> Floats:
    """Points along a sheet that is bent back onto itself, in cross-section."""
    arc = np.pi * GAP / 2
    t = np.linspace(0.0, 2 * LENGTH + arc, count)
    angle = np.clip((t - LENGTH) / arc, 0.0, 1.0) * np.pi
    back = np.clip(t - LENGTH - arc, 0.0, None)
    x = np.minimum(t, LENGTH) + 0.5 * GAP * np.sin(angle) - back
    return np.stack([x, 0.5 * GAP * np.cos(angle)], axis=1)


def nearest(points: Floats, sites: Floats) -> NDArray[np.int64]:
    found: NDArray[np.int64] = np.argmin(
        np.linalg.norm(points[:, None] - sites[None], axis=2), axis=1
    )
    return found


def covered(owner: NDArray[np.int64], seats: NDArray[np.int64]) -> NDArray[np.bool_]:
    """What floods reach that start at the sites."""
    result = np.zeros(len(owner), dtype=bool)
    for site, seat in enumerate(seats):
        for step in (-1, 1):
            k = int(seat)
            while 0 <= k < len(owner) and owner[k] == site:
                result[k] = True
                k += step
    return result


def propagated(
    points: Floats, sites: Floats, owner: NDArray[np.int64], known: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Labels spread from the faces with owners; the nearest site that arrives at a face owns it."""
    label_of = np.where(known, owner, -1)
    changed = True
    while changed:
        before = label_of.copy()
        for k in np.flatnonzero(~known):
            arrived = {int(before[j]) for j in (k - 1, k, k + 1) if 0 <= j < len(before)} - {-1}
            if arrived:
                label_of[k] = min(arrived, key=lambda i: np.linalg.norm(points[k] - sites[i]))
        changed = bool((label_of != before).any())
    return label_of


def draw_profile(axes: Axes, points: Floats, owner: NDArray[np.int64]) -> None:
    changes = np.flatnonzero(np.diff(owner)) + 1
    for run in np.split(np.arange(len(points)), changes):
        color = OWNERS[owner[run[0]]] if owner[run[0]] >= 0 else "#cccccc"
        axes.plot(*points[run[0] : run[-1] + 2].T, color=color, lw=5.0, solid_capstyle="butt")


def uncovered() -> Figure:
    points = hairpin(300)
    places = np.array([0.03, 0.17, 0.29, 0.43, 0.585, 0.725, 0.835, 0.95])
    seats = (places * (len(points) - 1)).astype(np.int64)
    sites = points[seats]
    euclidean = nearest(points, sites)
    known = covered(euclidean, seats)
    rows = (
        ("what the floods reach; gray: uncovered faces", np.where(known, euclidean, -1)),
        ("Euclidean cells: the nearest site in space", euclidean),
        ("connected cells: label propagation", propagated(points, sites, euclidean, known)),
    )
    figure, all_axes = plain((7.4, 3.2), rows=3)
    for axes, (title, owner) in zip(all_axes, rows, strict=True):
        draw_profile(axes, points, owner)
        for site, at in enumerate(sites):
            axes.plot(*at, "o", ms=8, color=OWNERS[site], markeredgecolor="black", mew=1.0)
        axes.set_title(title, fontsize=11, color=INK, loc="left")
        axes.margins(0.02, 0.35)
    return figure


# ---- repulsion ----


def repulsion() -> Figure:
    reach = 0.72
    angles = np.radians([20.0, 80.0, 140.0, 198.0, 262.0, 325.0])
    distances = np.array([0.98, 0.56, 1.02, 0.93, 1.0, 0.62])
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1) * distances[:, None]
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    left.set_aspect("equal")
    left.axis("off")
    left.add_patch(Circle((0, 0), reach, facecolor="#f9e4dd", edgecolor=ACCENT, lw=1.2))
    left.add_patch(Circle((0, 0), 1.0, fill=False, edgecolor=LINE, lw=1.0, ls="--"))
    near = distances < reach
    pushes = around * (0.34 / distances)[:, None]
    for at, push in [*zip(around[near], pushes[near], strict=True), ((0, 0), -pushes[near].sum(0))]:
        arrow = {"arrowstyle": "-|>", "color": ACCENT, "lw": 1.4, "shrinkA": 4}
        left.annotate("", at + push, at, arrowprops=arrow)
    left.plot(*around[near].T, "o", ms=6, color=ACCENT)
    left.plot(*around[~near].T, "o", ms=6, color=INK)
    left.plot(0, 0, "o", ms=7, color=INK)
    label(left, "$r$ = 0.72", (-1.3, -0.95), (-0.56, -0.45), ACCENT)
    label(left, "local spacing", (1.2, -1.05), (0.6, -0.8))
    left.margins(0.12)
    d = np.linspace(0.0, 1.2, 241)
    right.plot(d, np.clip(1 - d / reach, 0, None) ** 2, color=INK, lw=2)
    right.axvline(reach, color=ACCENT, lw=1.0, ls="--")
    right.set(xlim=(0, 1.2), ylim=(0, 1.05), xlabel="distance / local spacing")
    right.set_ylabel(r"$(1 - |x_i - x_j| / r)^2$")
    right.spines[["top", "right"]].set_visible(False)
    label(right, "$r$", (reach + 0.05, 0.95), color=ACCENT)
    return figure


# ---- keyframes ----

BEND = {1: 0.0, 3: 0.2, 5: 0.45}  # how far the surface is bent in a frame


def bent(t: Floats, frame: int) -> Floats:
    """Points of the surface of a frame, for t in 0..1."""
    bend = BEND[frame]
    return np.stack([2.6 * t, bend * (1.6 * np.sin(np.pi * t) + 1.2)], axis=-1)


def keyframes() -> Figure:
    figure = Figure(figsize=(9.0, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    for axes in (left, right):
        axes.axis("off")
    left.plot([1, 9], [0, 0], color=LINE, lw=1.2, zorder=0)
    for frame in range(1, 10):
        key = frame % 4 == 1
        left.plot(frame, 0, "s" if key else "o", ms=11 if key else 6, color=INK if key else GRAY)
        label(left, str(frame), (frame, -0.45))
    for frame, name in ((1, "keyframe 0"), (5, "keyframe 1"), (9, "keyframe 2")):
        label(left, name, (frame, 0.5))
    label(left, "frame 3: dapple_key 0, dapple_since 2, dapple_span 4", (4.4, -1.15), (3, -0.62))
    label(left, "plays 1/2 keyframe 0 + 1/2 keyframe 1", (4.4, -1.62))
    left.set(xlim=(0.2, 9.8), ylim=(-1.9, 0.9))
    draw_mixing(right)
    return figure


def draw_mixing(axes: Axes) -> None:
    t = np.linspace(0.0, 1.0, 121)
    before, after = np.array(0.3), np.array(0.62)  # where the keyframes have the point
    for frame in BEND:
        now = frame == 3
        axes.plot(*bent(t, frame).T, color=INK if now else LINE, lw=2.2 if now else 1.2)
        label(axes, f"frame {frame}", bent(np.array(1.0), frame) + np.array([0.36, 0.0]))
    ends = np.stack([bent(before, 3), bent(after, 3)])
    axes.plot(*ends.T, "o", ms=7, markerfacecolor="white", markeredgecolor=ACCENT, ls="-", lw=1.0)
    axes.lines[-1].set_color(ACCENT)
    axes.plot(*ends.mean(axis=0), "o", ms=7, color=ACCENT)
    for place, frame in ((before, 1), (after, 5)):
        axes.plot(*bent(place, frame), "s", ms=8, color=INK)
    label(axes, "keyframe 0", (0.5, -0.32), bent(before, 1))
    label(axes, "keyframe 1", (2.45, 1.32), bent(after, 5))
    label(axes, "played", (1.35, -0.32), ends.mean(axis=0), ACCENT)
    axes.set(xlim=(-0.1, 3.3), ylim=(-0.5, 1.45))


# ---- a terrain in tiles ----


SIDE, POINTS = 100, 8_000  # of the terrain; in four tiles


def terrain() -> HeightField:
    """Gentle hills."""
    y, x = np.mgrid[:SIDE, :SIDE].astype(np.float64)
    return HeightField(4 * np.sin(x / 19) * np.cos(y / 17))


def solved_alone(lines: list[float]) -> Floats:
    """The points of four tiles that know nothing of each other."""
    whole = terrain()
    parts = []
    for rows in (slice(0, int(lines[1]) + 1), slice(int(lines[1]), SIDE)):
        for columns in (slice(0, int(lines[0]) + 1), slice(int(lines[0]), SIDE)):
            origin = (float(columns.start), float(rows.start))
            part = HeightField(whole.heights[rows, columns], origin=origin)
            patch = part.read((-np.inf, np.inf), (-np.inf, np.inf))
            surface = dapple.Surface(patch.vertices, patch.faces)
            count = round(POINTS * len(patch.faces) / whole.face_count)
            parts.append(dapple.sample(surface, count).positions)
    return np.concatenate(parts)


def seams() -> Figure:
    figure, (left, right) = plain((9.6, 4.9), columns=2)
    with tempfile.TemporaryDirectory() as folder:
        tiles = sample_tiles(terrain(), folder, POINTS, tile=POINTS // 4)
        together = np.concatenate([tile.positions for tile in tiles.tiles()])
        lines = [
            float(values[1]) for values in (tiles.plan().layout.columns, tiles.plan().layout.rows)
        ]
    for axes, points in ((left, solved_alone(lines)), (right, together)):
        draw_corner(axes, points, lines)
    label(left, "each tile alone", (lines[0], lines[1] - 20.0))
    label(right, "sample_tiles()", (lines[0], lines[1] - 20.0))
    return figure


def draw_corner(axes: Axes, points: Floats, lines: list[float]) -> None:
    """The points around the place where four tiles meet; marks show where the seams are."""
    reach = 17.0
    near = (np.abs(points[:, :2] - lines) < reach - 0.4).all(axis=1)
    axes.plot(*points[near, :2].T, "o", ms=2.6, color=INK)
    for sign in (-1, 1):
        ends = np.array([reach, reach + 1.2]) * sign
        axes.plot([lines[0]] * 2, lines[1] + ends, color=ACCENT, lw=1.6)
        axes.plot(lines[0] + ends, [lines[1]] * 2, color=ACCENT, lw=1.6)


# ---- masks ----


SPAN, STEPS = 10.0, 96  # side of the hills, and of how many squares
ROAD = np.array([[-0.5, 2.0], [3.0, 3.2], [5.5, 6.4], [10.5, 8.0]])  # seen from above


def hills() -> tuple[dapple.Surface, Floats]:
    """Some hills, and their heights in rows."""
    y, x = np.mgrid[: STEPS + 1, : STEPS + 1] * SPAN / STEPS
    z = 1.1 * np.sin(0.9 * x + 0.4) * np.cos(0.7 * y) + 0.5 * np.cos(0.5 * x - 0.9 * y)
    rows, columns = np.indices((STEPS, STEPS)).reshape(2, -1)
    a = rows * (STEPS + 1) + columns
    b, c, d = a + 1, a + STEPS + 2, a + STEPS + 1
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    vertices = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    return dapple.Surface(vertices, faces.astype(np.int32), sharp_angle=180.0), z


def masked(surface: dapple.Surface, name: str) -> density.MaskedSurface:
    """The hills in one mask."""
    normals, within = surface.corner_normals, density.Range
    road = np.column_stack([ROAD, np.zeros(len(ROAD))])
    segments = np.stack([road[:-1], road[1:]], axis=1)
    border = density.border_edges(surface.vertices, surface.faces)
    factors: dict[str, Floats] = {
        "slope": density.slope(normals, within(0.0, np.radians(25.0), falloff=np.radians(5.0))),
        "aspect": density.aspect(normals, within(0.0, np.radians(60.0), falloff=np.radians(30.0))),
    }
    fields: dict[str, density.Field] = {
        "height": density.Height(within(0.3, np.inf)),
        "distance": density.Distance(
            within(0.4, 1.0, falloff=0.8), density.Nearest(segments=segments, plan=True)
        ),
        "border": density.Distance(within(1.5, np.inf), density.Nearest(segments=border)),
        "noise": density.Noise(within(0.55, 1.0, falloff=0.05), size=2.0),
    }
    if name in factors:
        surface = density.multiplied(surface, factors[name])
    return density.MaskedSurface(surface, [fields[name]] if name in fields else [], count=900)


def masks() -> Figure:
    """Each mask of the command line on the same hills, seen from above."""
    figure, axes = plain((9.0, 6.4), columns=3, rows=2)
    surface, heights = hills()
    for one, name in zip(
        axes, ("slope", "height", "distance", "border", "aspect", "noise"), strict=True
    ):
        found = masked(surface, name)
        samples = dapple.sample(found.surface, 900)
        ends = (0.0, SPAN, 0.0, SPAN)
        one.contour(heights, 7, extent=ends, colors=LINE, linewidths=0.6, negative_linestyles="-")
        if name == "distance":
            one.plot(*ROAD.T, color=ACCENT, lw=1.5)
        one.scatter(
            samples.positions[:, 0], samples.positions[:, 1], s=2.2, color=INK, linewidths=0
        )
        one.set(xlim=(0.0, SPAN), ylim=(0.0, SPAN))
        one.set_title(name, color=INK, fontsize=11)
    return figure


# ---- symmetry ----


def lobes() -> dapple.Surface:
    """A flat sheet with lobes, symmetric across x = 0."""
    t = np.linspace(-np.pi, np.pi, 361)[:-1]
    radius = 1.0 + 0.75 * np.abs(np.sin(t)) ** 0.5 * np.cos(3.0 * (np.abs(t) - 1.75)) ** 2
    rim = radius[:, None] * np.stack([np.sin(t) * 1.25, np.cos(t) * 0.8], axis=1)
    inner = np.linspace(0.0, 1.0, 31)[1:]
    rings = [np.column_stack([share * rim, np.zeros(len(rim))]) for share in inner]
    around = np.arange(len(rim))
    after = np.roll(around, -1)
    faces = [np.stack([np.zeros_like(around), 1 + around, 1 + after], axis=1)]
    for k in range(len(inner) - 1):
        a, b = 1 + k * len(rim) + around, 1 + k * len(rim) + after
        c, d = a + len(rim), b + len(rim)
        faces += [np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)]
    return dapple.Surface(np.concatenate([[[0.0, 0.0, 0.0]], *rings]), np.concatenate(faces))


def symmetry() -> Figure:
    """Samples as sample() places them, and in pairs of mirror images."""
    figure, axes = plain((9.0, 3.4), columns=2)
    surface = lobes()
    rim = surface.vertices[-360:, :2]
    pairs = dapple.sample_symmetric(surface, 501)
    alone = pairs.mirror == np.arange(len(pairs))
    for one, name in zip(axes, ("sample", "sample_symmetric"), strict=True):
        one.add_patch(Polygon(rim, facecolor=PALE, edgecolor=LINE, lw=0.8))
        one.plot(
            [0, 0], [rim[:, 1].min() - 0.15, rim[:, 1].max() + 0.15], color=GRAY, lw=0.8, ls="--"
        )
        samples = dapple.sample(surface, 501) if name == "sample" else pairs.samples
        one.plot(*samples.positions[:, :2].T, "o", color=INK, ms=2.6, mew=0)
        one.set_title(name, color=INK, fontsize=11)
    axes[1].plot(*pairs.samples.positions[alone, :2].T, "o", color=ACCENT, ms=3.4, mew=0)
    return figure


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES
    matplotlib.rcParams["svg.hashsalt"] = "dapple"  # the same names in every run
    for draw in (cells, uncovered, repulsion, keyframes, seams, symmetry):
        draw().savefig(folder / f"{draw.__name__}.svg", facecolor="white", metadata={"Date": None})
    masks().savefig(folder / "masks.png", facecolor="white", dpi=110)  # too many dots for paths


if __name__ == "__main__":
    main()
