#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then animates a creature, scatters over it, renders and reports.
#   blend_examples/run.sh [--frames N] [--count N] [--seed N] [--width PIXELS] [--out FOLDER]
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

scripts/setup.sh
# Blender can hang at exit; nothing that holds bpy runs without a limit.
exec timeout --kill-after=10 1800 "$python" blend_examples/creature.py "$@"
