# SPDX-License-Identifier: GPL-3.0-or-later
"""What is placed on the points: the list of object types, radii, overlaps."""
