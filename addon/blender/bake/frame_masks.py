# SPDX-License-Identifier: GPL-3.0-or-later
"""What the density of a bake takes from each frame, where masks are those of each frame."""

from dataclasses import dataclass, field, replace

from ...core.base.errors import ScatterError
from ...core.settings.values import Settings
from ...core.surface.arrays import SurfaceArrays
from ..base.object_handles import Held
from ..surface.reading import at_frame
from ..surface.surroundings import Known


@dataclass
class Masks:
    """Reads frames of a surface with all that these settings take."""

    settings: Settings
    last: SurfaceArrays  # with which it was read
    known: Known = field(init=False)

    def __post_init__(self) -> None:
        self.known = Known(self.last)

    def at_frame(
        self, surface: Held, held: Held, frame: int, kind: str, may_be_bare: bool
    ) -> SurfaceArrays:
        """The surface on a frame; where something is not there, all is as on the frame before."""
        try:
            arrays = at_frame(
                surface,
                frame,
                settings=self.settings,
                own=held,
                kind=kind,
                may_be_bare=may_be_bare,
                known=self.known,
            )
        except ScatterError:
            arrays = at_frame(surface, frame, kind=kind, may_be_bare=may_be_bare)
            if arrays.topology == self.last.topology:
                last = self.last
                return replace(
                    arrays, weights=last.weights, digests=last.digests, around=last.around
                )
            raise
        self.last = arrays if len(arrays.faces) else self.last
        return arrays
