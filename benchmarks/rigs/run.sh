#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then remeshes the parts of a rigged character in Blender and plays its actions; prints a table.
#   benchmarks/rigs/run.sh [--file FILE.glb] [--action Running_A ...] [--all] [--share 0.5 2] [--pictures FOLDER]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 3600 "$python" -m benchmarks.rigs "$@"
