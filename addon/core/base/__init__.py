# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors, the native package, work in steps, worker threads, files written as a whole."""
