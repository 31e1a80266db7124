# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: frames solved one after another, and packed as keys."""
