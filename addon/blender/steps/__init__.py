# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators do: add, optimize, bake, cut tiles."""
