# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters as assets, and the asset library."""
