# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview, viewport share and levels of detail."""
