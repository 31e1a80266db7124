# SPDX-License-Identifier: GPL-3.0-or-later
"""When nothing may be updated, as something else has the file."""

from ..base import artist, renders, step_operators


def is_held() -> bool:
    """Whether Blender renders, plays, paints a stroke, or an operator of the add-on works."""
    return (
        renders.busy()
        or step_operators.is_under_way()
        or artist.is_playing()
        or artist.is_painting()
    )
