#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then builds a scene, renders it and prints a report.
#   blend_examples/run.sh [SCENE] [OPTIONS]
#     SCENE            cube, creature (default), side_by_side, scales, meadow, studs, mosaic, portrait, city, decals, edges, trimmed, leaning, colored, seen, logs, remeshed,
#                      hair, robot, reef, knight or ready
#     --count N        number of points
#     --seed N         another seed gives another scatter
#     --width PIXELS   width of a picture; 0 makes none
#     --out FOLDER     where the files go; build/examples by default
#     Of single scenes: decals --texture PIXELS; side_by_side --frames N, --only N, --back and --quality N; ready --previews.
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

scene=creature
case ${1:-} in
  '' | -*) ;;
  cube | creature | side_by_side | scales | meadow | studs | mosaic | portrait | city | decals | edges | trimmed | leaning | colored | seen | logs | remeshed | hair | robot | reef | knight | ready) scene=$1 && shift ;;
  *) fail "unknown scene $1; see the head of blend_examples/run.sh" ;;
esac
usage() {
  sed -n '/^#   blend/,/^[^#]/s/^#   //p' "$0"
  exit 0
}
for argument in "$@"; do case $argument in -h | --help) usage ;; esac; done
scripts/setup.sh
# Blender can hang at exit; nothing that holds bpy runs without a limit.
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m "blend_examples.$scene" "$@"
