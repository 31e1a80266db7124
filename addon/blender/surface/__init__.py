# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces and what is beside them, read as arrays; joined surfaces."""
