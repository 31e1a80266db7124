# SPDX-License-Identifier: GPL-3.0-or-later
"""The density of a surface: its terms, the ground that is solved, its colors."""
