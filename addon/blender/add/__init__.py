# SPDX-License-Identifier: GPL-3.0-or-later
"""Add, and the list of the scatters of a surface."""
