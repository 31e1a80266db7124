#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then builds a scene, renders it and reports.
#   blend_examples/run.sh [cube|creature|side_by_side|scales|meadow|studs|mosaic|portrait|city|decals|ready] [--count N] [--seed N] [--width PIXELS] [--out FOLDER] [--help]
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

scene=creature
case ${1:-} in
  '' | -*) ;;
  cube | creature | side_by_side | scales | meadow | studs | mosaic | portrait | city | decals | ready) scene=$1 && shift ;;
  *) fail "unknown scene $1; see the head of blend_examples/run.sh" ;;
esac
scripts/setup.sh
# Blender can hang at exit; nothing that holds bpy runs without a limit.
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m "blend_examples.$scene" "$@"
