# SPDX-License-Identifier: GPL-3.0-or-later
"""The ground: a surface with its density, cut finer where that varies within its faces.

A camera's frame, a range of heights, a distance, an obstacle or a picture knows nothing of the
surface's faces. So the faces are cut before samples are made, and samples are returned on the faces
that the file has. During a deformation the fine vertices follow the coarse ones.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .density import density_of, product
from .fine import Places, Term, at_corners, blocked, fine_terms, to_cut
from .frames import SMOOTH, shaded
from .native import package
from .settings import Settings
from .surface import Floats, Ints, SurfaceArrays
from .udim import Tile, crossing, laid_out

_FINE = 0.3  # longest edge where a density changes within faces, in spacings of the points
_AT_BORDER = 0.05  # the same at the border of a UDIM tile, where a density may jump
_ROUNDS = 24  # of halving edges there
_MOST_FACES = 1_000_000
_ROUNDING = 1e-6  # of texture coordinates, which are stored in single precision
_PIXELS = 8.0  # of a picture, for each spacing of the points; finer ones are averaged
_REPEATED = 1.5  # the same of one that the surface has many times, which is fine everywhere
_SHORTEST = 0.7  # edge that a picture still has cut, in spacings where it is densest


class Ground:
    """What is sampled and tracked in place of the surface that was read."""

    def __init__(
        self,
        arrays: SurfaceArrays,
        settings: Settings,
        context: Any = None,
        like: "Ground | None" = None,
        first: SurfaceArrays | None = None,
    ) -> None:
        """Raises ValueError as dapple.Surface does; a dapple.Context can cancel the cutting.

        A ground with the same faces, `like`, saves measuring anew those that have not changed.
        What belongs to the surface is as on the first frame, if that is given.
        """
        self.arrays, self._context, self._first = arrays, context, first
        self._refined: Any = None
        density = density_of(arrays, settings.density, first)
        self._base: Any = _measured(
            arrays, density, settings.merge_doubled, None if like is None else like._base
        )
        self.surface = self._base
        terms = fine_terms(arrays, settings.density, first)
        around, count = arrays.around, _wanted(self.surface, settings)
        if terms or len(around.points):
            self._cut_for(terms, count)
        if around.image is not None and around.uv is not None:
            self._lay_picture(around.image, around.uv, count)
        if around.tiles and around.uv is not None:
            self._lay_tiles(around.tiles, around.uv, count)

    def there(self, samples: Any) -> Any:
        """dapple.Samples of the faces that were read, on the surface that is sampled."""
        return samples if self._refined is None else self._refined.from_original(samples)

    def back(self, samples: Any) -> Any:
        """dapple.Samples of the surface that is sampled, on the faces that were read."""
        return samples if self._refined is None else self._refined.to_original(samples)

    @property
    def is_cut(self) -> bool:
        """Whether there are other faces than those that were read."""
        return self._refined is not None

    @property
    def pieces(self) -> tuple[Ints, Floats]:
        """Of each face that is sampled, the one (m,) that was read, and its corners (m, 3, 3) there
        in barycentrics.
        """
        if self._refined is not None:
            return self._refined.parents, self._refined.barycentric
        count = len(self.surface.faces)
        corners = np.broadcast_to(np.eye(3), (count, 3, 3))
        return np.arange(count, dtype=np.int32), corners

    @property
    def uncut(self) -> Floats:
        """Density (m, 3) at the corners of the faces that were read, as long as none is cut."""
        return _at_corners(_density(self._base), self._base.faces)

    @property
    def original(self) -> Any:
        """dapple.Surface with the faces that were read."""
        return self.surface if self._refined is None else self._refined.original

    def vertices(self, coarse: Floats) -> Floats:
        """Where the vertices are once those that were read are at coarse (v, 3)."""
        if self._refined is None:
            return coarse
        fine: Floats = self._refined.vertices(coarse)
        return fine

    def class_density(self, name: str) -> dict[str, Any]:
        """Options of a dapple.SampleClass whose density is multiplied by values of the surface."""
        if not name:
            return {}
        own, common = self._carried(self.arrays.weights[name]), _density(self.surface)
        found = own if common is None else product([own, common], self.surface.faces)
        values, place = _placed(found)
        return {"density": values, "density_at": place}

    def at_corners(self, name: str = "") -> Floats:
        """Density (m, 3) at the corners of the faces, of a class with values of that name."""
        own, common = [], _density(self.surface)
        if name:
            own.append(self._carried(self.arrays.weights[name]))
        if common is not None:
            own.append(common)
        faces = self.surface.faces
        return _at_corners(product(own, faces) if own else None, faces)

    def densities(self, samples: Any) -> Floats:
        """Density (n,) at samples of the surface; 1 where it is the same everywhere."""
        density, at = _density(self.surface), samples.faces
        if density is None:
            return np.ones(len(samples))
        values = density[at] if density.ndim == 2 else density[self.surface.faces[at]]
        found: Floats = np.einsum(
            "nk,nk->n", samples.barycentric, np.broadcast_to(values, (len(at), 3))
        )
        return found

    def shares(self, densities: Floats) -> Floats:
        """The same as shares of the largest there is."""
        density = self.surface.density
        return densities if density is None else densities / density.max()

    def _carried(self, values: Floats) -> Floats:
        """Values of what was read, as they are on the faces that are sampled."""
        if self._refined is None:
            return values
        if values.ndim == 2:
            parents, corners = self.pieces
            own = values[parents]
            return own if own.shape[1] == 1 else np.einsum("mkc,mc->mk", corners, own)
        fine: Floats = self._refined.vertices(np.repeat(values[:, None], 3, axis=1))[:, 0]
        return fine

    def _cut_for(self, terms: list[Term], count: int) -> None:
        """Halve the edges of the faces on which terms change, until they are short."""

        def long(lengths: Floats) -> NDArray[np.bool_]:
            target = _FINE * _spacing(self.surface, self._product(terms), count)
            return to_cut(terms, self._places(terms), self.surface.faces, lengths, target)

        self._halve(long)
        if self._refined is None:
            self._extend(package().refine_edges(self.surface, np.inf))
        self._take_away(terms)

    def _halve(self, long: Callable[[Floats], NDArray[np.bool_]]) -> None:
        """Halve the edges of faces, until by their longest edges (m,) none is too long any more."""
        for _ in range(_ROUNDS):
            lengths = _longest_edges(self.surface)
            chosen = long(lengths)
            if not chosen.any():
                break
            limits = np.where(chosen, 0.51 * lengths, np.inf)
            cut = package().refine_edges(
                self.surface, limits, max_faces=_MOST_FACES, context=self._context
            )
            self._extend(cut)
            if not cut.resolved:
                break

    def _take_away(self, terms: list[Term]) -> None:
        density, around = self._product(terms), self.arrays.around
        surface = self.surface.with_density(density, density_at="corners")
        self._extend(
            package().refine_obstacles(
                surface,
                around.points,
                around.radii,
                areas=blocked(terms, surface),
                max_faces=4 * _MOST_FACES,
                context=self._context,
            )
        )

    def _product(self, terms: list[Term]) -> Floats:
        """The density (m, 3) at the corners of the faces as they are cut so far."""
        places, faces = self._places(terms), self.surface.faces
        factors = np.ones((len(faces), 3))
        for term in terms:
            factors = factors * at_corners(term, places, faces)
        return factors * self.at_corners()

    def _places(self, terms: list[Term]) -> Places:
        """Vertices as they are now, and on the first frame if any term rides."""
        now = self.surface.vertices
        if self._first is None or not any(term.rides for term in terms):
            return Places(now, now)
        return Places(now, self.vertices(self._first.vertices))

    def _cut_uv(self, uv: Floats) -> Floats:
        """Texture coordinates of the faces as they are cut so far, of those that were read."""
        if self._refined is None:
            return uv
        found: Floats = np.einsum(
            "fkc,fcd->fkd", self._refined.barycentric, uv[self._refined.parents]
        )
        return found

    def _lay_tiles(self, tiles: tuple[Tile, ...], uv: Floats, count: int) -> None:
        self._cut_at_borders(tiles, uv, count)
        most = int(_PIXELS * np.sqrt(count))
        small = [(number, reduced(picture, most)) for number, picture in tiles]
        picture, places = laid_out(self._cut_uv(uv), small)
        share = min(_share(one) for _, one in tiles)
        options = {"max_faces": 2 * _MOST_FACES, "context": self._context}
        options["shortest"] = self._shortest(count, share)
        self._extend(package().refine_image(self.surface, places, picture, **options))

    def _cut_at_borders(self, tiles: tuple[Tile, ...], uv: Floats, count: int) -> None:
        """Halve the edges of the faces that reach over a tile's border, until they are short."""
        target = _AT_BORDER * _spacing(self.surface, self.at_corners(), count)
        self._halve(lambda lengths: crossing(self._cut_uv(uv), tiles) & (lengths > target))

    def _lay_picture(self, image: Floats, uv: Floats, count: int) -> None:
        uv = self._cut_uv(uv)
        times, share = max(_area(uv), 1.0), _share(image)
        least = min(_REPEATED / float(np.sqrt(times * share)), _PIXELS)
        most = max(_PIXELS / times, least) * np.sqrt(count)
        picture = reduced(image, max(int(most), 1))
        beyond = float(uv.min()) < -_ROUNDING or float(uv.max()) > 1.0 + _ROUNDING
        options = {"max_faces": 2 * _MOST_FACES, "context": self._context}
        options |= {"repeat": beyond, "shortest": self._shortest(count, share)}
        self._extend(package().refine_image(self.surface, uv, picture, **options))

    def _shortest(self, count: int, share: float) -> float:
        """Edge that a picture has cut; what is finer averages out in the areas of the points."""
        spacing = _spacing(self.surface, self.at_corners(), count)
        return _SHORTEST * float(np.sqrt(share)) * spacing

    def _extend(self, cut: Any) -> None:
        self._refined = cut if self._refined is None else self._refined.then(cut)
        self.surface = self._refined.surface


def _at_corners(density: Floats | None, faces: Ints) -> Floats:
    """A density of vertices, faces or corners, at the corners (m, 3)."""
    if density is None:
        return np.ones((len(faces), 3))
    if density.ndim == 1:
        return density[faces]
    found: Floats = np.broadcast_to(density, (len(faces), 3))
    return found


def _density(surface: Any) -> Floats | None:
    """Of a dapple.Surface: (v,) at its vertices, (m, 1) on its faces, (m, 3) at their corners."""
    density: Floats | None = surface.density
    if density is None or surface.density_at != "faces":
        return density
    return density[:, None]


def _placed(density: Floats | None) -> tuple[Floats | None, str]:
    """A density as dapple.Surface takes it, and where its values are."""
    if density is None or density.ndim == 1:
        return density, "vertices"
    return (density[:, 0], "faces") if density.shape[1] == 1 else (density, "corners")


def _measured(arrays: SurfaceArrays, density: Floats | None, merge: bool, like: Any) -> Any:
    """dapple.Surface of what was read; that of the same faces saves most of the work."""
    values, at = _placed(density)
    own = shaded(arrays)
    same = like is not None and like.merge_doubled == merge
    same = same and (like.sharp_angle == SMOOTH) == ("normals" not in own)
    if not same or not np.array_equal(like.faces, arrays.faces):
        own |= {"density_at": at, "merge_doubled": merge}
        return package().Surface(arrays.vertices, arrays.faces, values, **own)
    if "normals" in own or not np.array_equal(like.vertices, arrays.vertices):
        like = like.deformed(arrays.vertices, normals=own.get("normals"))
    return like.with_density(values, density_at=at)


def _wanted(surface: Any, settings: Settings) -> int:
    count = settings.count
    if settings.per_area:
        count = round(settings.per_area * surface.area)
    return min(max(count, 100), 1_000_000)


def _longest_edges(surface: Any) -> Floats:
    corners = surface.vertices[surface.faces]
    found: Floats = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    return found


def _spacing(surface: Any, density: Floats, count: int) -> float:
    """Of so many points, packed as well as can be on what the density leaves of a surface."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    left = float((areas * (density.mean(axis=1) > 0.0)).sum())
    return float(np.sqrt(2.0 * left / (np.sqrt(3.0) * count)))


def _area(uv: Floats) -> float:
    """Of all faces (m, 3, 2) in texture space: how often they have the whole picture."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return float(0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def _share(image: Floats) -> float:
    """Mean of a picture over its maximum; at least a thousandth, also where it is black."""
    most = float(image.max())
    return max(float(image.mean()) / most, 1e-3) if most > 0.0 else 1.0


def reduced(image: Floats, most: int) -> Floats:
    """A picture of at most so many rows and columns: means of blocks of pixels."""
    for axis in (0, 1):
        length = image.shape[axis]
        if length > most:
            starts = np.arange(most) * length // most
            sums = np.add.reduceat(image, starts, axis=axis)
            sizes = np.diff(np.append(starts, length))
            image = sums / (sizes[:, None] if axis == 0 else sizes)
    return image
