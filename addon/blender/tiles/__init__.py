# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Tiles: its steps, operator and panel."""
