# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters that follow changes by themselves."""
