# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file keeps of a scatter, read and written."""
