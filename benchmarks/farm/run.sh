#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures how much faster several Blender processes bake several shots than one.
#   benchmarks/farm/run.sh [--shots N] [--frames N] [--sites N] [--processes N] [--blender PROGRAM]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 7200 "$python" -m benchmarks.farm "$@"
