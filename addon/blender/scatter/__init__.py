# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatter object and its stored data: points, binding, keyframes, the modifier."""
