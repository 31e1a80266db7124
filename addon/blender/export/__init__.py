# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of scatters as files for other programs."""
