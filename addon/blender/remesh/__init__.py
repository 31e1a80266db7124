# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple: its operator, and what the new mesh takes over from the old one."""
