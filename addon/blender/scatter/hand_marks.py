# SPDX-License-Identifier: GPL-3.0-or-later
"""Where points of a scatter were placed by hand: its mesh keeps that until the others are even
around them, so that undo, redo and files do too.
"""

import bpy
import numpy as np

from ...core.surface.arrays import Floats
from ...core.surface.records import TOUCHED_KEY
from .library import own_mesh


def touched_places(obj: bpy.types.Object) -> Floats | None:
    """Places (k, 3) in the surface's own space; None where all points are even."""
    stored = obj.data.get(TOUCHED_KEY)
    return None if stored is None else np.array(stored, dtype=np.float64).reshape(-1, 3)


def add_touched(obj: bpy.types.Object, places: Floats) -> None:
    """Keep more of them."""
    before = touched_places(obj)
    joined = places if before is None else np.concatenate([before, places])
    if len(joined):
        own_mesh(obj)[TOUCHED_KEY] = joined.ravel().tolist()


def forget_touched(obj: bpy.types.Object) -> None:
    """The points are even around all of them."""
    if TOUCHED_KEY in obj.data:
        del own_mesh(obj)[TOUCHED_KEY]
