# SPDX-License-Identifier: GPL-3.0-or-later
"""Dapple: even scattering without patterns, on surfaces that deform."""


def register() -> None:
    from . import blender

    blender.register()


def unregister() -> None:
    from . import blender

    blender.unregister()
