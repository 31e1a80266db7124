# SPDX-License-Identifier: GPL-3.0-or-later
"""Dapple: even, never patterned scattering over surfaces that deform."""


def register() -> None:
    from . import blender

    blender.register()


def unregister() -> None:
    from . import blender

    blender.unregister()
