# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown in the viewport only, and far from the camera."""
