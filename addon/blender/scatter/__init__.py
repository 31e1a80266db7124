# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatter object and what it stores: points, binding, keys, the modifier."""
