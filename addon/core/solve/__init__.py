# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving one frame: from the start, or from existing points."""
