# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: stored, applied, fitted to a surface."""
