# SPDX-License-Identifier: GPL-3.0-or-later
"""One file for each command: its name is the command's, and it defines `command`."""
