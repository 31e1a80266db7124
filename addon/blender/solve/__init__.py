# SPDX-License-Identifier: GPL-3.0-or-later
"""Optimize, Reattach and Auto Update, with their panels."""
