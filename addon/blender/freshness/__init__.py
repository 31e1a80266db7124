# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a result still fits the scene, and frames that stopped bakes have left."""
