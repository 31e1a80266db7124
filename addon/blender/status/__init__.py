# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a result still fits, and what stopped bakes have left."""
