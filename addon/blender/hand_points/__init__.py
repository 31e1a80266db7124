# SPDX-License-Identifier: GPL-3.0-or-later
"""Points placed, moved, removed and locked by hand."""
