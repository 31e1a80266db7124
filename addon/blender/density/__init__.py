# SPDX-License-Identifier: GPL-3.0-or-later
"""The density: its panel, painting on the surface, its colors in the viewport."""
