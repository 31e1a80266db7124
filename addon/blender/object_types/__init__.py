# SPDX-License-Identifier: GPL-3.0-or-later
"""Object types: their list, radii, overlaps, and the panel Instances."""
