# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line, by click; nothing else in the package imports it."""
