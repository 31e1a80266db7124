# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of a surface and from beside it."""
