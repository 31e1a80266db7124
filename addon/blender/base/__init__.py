# SPDX-License-Identifier: GPL-3.0-or-later
"""What all of the edge needs: words, times, jobs, meshes as arrays; it knows no scatter."""
