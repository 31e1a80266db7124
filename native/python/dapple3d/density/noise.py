# SPDX-License-Identifier: GPL-3.0-or-later
"""Gradient noise after Perlin in integer hashes: the same bytes on every machine.

No function here is rounded otherwise elsewhere: products, sums, square roots.
"""

import numpy as np
from numpy.typing import NDArray

from .arrays import Floats

_PART = 65_536  # places at a time, which fit into the cache
_SPREAD = 4.8  # factor of the values with which they spread evenly over 0 to 1
_BENT = 0.7  # deviation from a line over a length of the patches' size; rarely more
# Directions to the edges of a cube; four of them twice, so that there are 16.
_EDGES = [(0, a, b) for a in (1, -1) for b in (1, -1)]
_EDGES += [(a, 0, b) for a in (1, -1) for b in (1, -1)]
_EDGES += [(a, b, 0) for a in (1, -1) for b in (1, -1)]
_GRADIENTS = np.array([*_EDGES, (1, 1, 0), (-1, 1, 0), (0, -1, 1), (0, -1, -1)], dtype=np.float64)
_SHIFT = np.array(
    [0.317, 0.713, 0.529]
)  # moves the point where all octaves are 0 away from the origin
_PRIMES = np.array([0x8DA6B343, 0xD8163841, 0xCB1AB31F, 0x9E3779B1], dtype=np.uint32)
Words = NDArray[np.uint32]


def noise(places: Floats, detail: int, seed: int) -> Floats:
    """Values (n,) from 0 to 1 at places (n, 3), which are in units of the largest patches' size.

    Values are spread evenly: about a share t of space has values below t.

    Args:
        detail: how many finer noises are added, each of half the size and half the height.
        seed: each gives another noise.
    """
    found = np.empty(len(places))
    for first in range(0, len(places), _PART):
        part = slice(first, first + _PART)
        found[part] = _even(_summed(_turned(places[part]), detail, seed))
    return found


def bend(lengths: Floats, detail: int) -> Floats:
    """How far values are from a straight line, over lengths in sizes of the largest patches."""
    found = np.zeros(len(lengths))
    for octave in range(detail + 1):
        found += 0.5**octave * np.minimum(_BENT * (lengths * 2.0**octave) ** 2, 1.0)
    return found / _norm(detail)


def _norm(detail: int) -> float:
    return float(np.sqrt(sum(0.25**octave for octave in range(detail + 1))))


def _summed(places: Floats, detail: int, seed: int) -> Floats:
    total = np.zeros(len(places))
    for octave in range(detail + 1):
        words = np.array([[seed], [octave]], dtype=np.int64).astype(np.uint32)
        key = _mixed(_mixed(words[0]) + words[1] * _PRIMES[3])
        total += 0.5**octave * _octave((places + _SHIFT) * 2.0**octave, key)
    found: Floats = total / _norm(detail)
    return found


def _turned(places: Floats) -> Floats:
    """Turned, as noise is duller in planes along its lattice, where many surfaces lie."""
    x, y, z = places.T
    side, up = -0.211324865405187 * (x + y), 0.577350269189626 * z
    third = -0.577350269189626 * (x + y) + up
    return np.stack([x + side + up, y + side + up, third], axis=1)


def _octave(places: Floats, key: Words) -> Floats:
    cells = np.floor(places)
    inside = places - cells
    ease = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0)
    first = cells.astype(np.int64).astype(np.uint32)
    words = [(first + np.uint32(one)) * _PRIMES[:3] for one in (0, 1)]
    shares, away = (1.0 - ease, ease), (inside, inside - 1.0)
    total = np.zeros(len(places))
    for i, j, k in np.ndindex(2, 2, 2):
        hashed = _mixed(words[i][:, 0] ^ words[j][:, 1] ^ words[k][:, 2] ^ key)
        toward = _GRADIENTS[hashed >> np.uint32(28)]
        x, y, z = away[i][:, 0], away[j][:, 1], away[k][:, 2]
        height = toward[:, 0] * x + toward[:, 1] * y + toward[:, 2] * z
        total += shares[i][:, 0] * shares[j][:, 1] * shares[k][:, 2] * height
    return total


def _mixed(words: Words) -> Words:
    """Hashes in which all bits count."""
    words = (words ^ (words >> np.uint32(16))) * np.uint32(0x7FEB352D)
    words = (words ^ (words >> np.uint32(15))) * np.uint32(0x846CA68B)
    found: Words = words ^ (words >> np.uint32(16))
    return found


def _even(values: Floats) -> Floats:
    """In place of bell-shaped values of mean 0, how much of them is below each."""
    spread = _SPREAD * values
    found: Floats = 0.5 + 0.5 * spread / np.sqrt(2.0 + spread * spread)
    return found
