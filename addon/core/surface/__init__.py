# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as arrays, and how points are bound to it."""
