# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown in the viewport only: the live preview, the density as colors."""
