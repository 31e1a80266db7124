# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `blender -b shot.blend --command dapple bake`."""
