# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings: the tables that all of them are made from, their values, presets."""
