# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the add-on that uses numpy and the native package, but not bpy."""
