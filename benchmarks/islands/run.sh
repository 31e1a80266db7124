#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then samples a ground under masks with islands, bays and paths, and judges how even it comes out.
#   benchmarks/islands/run.sh [--only NAME] [--seeds 1] [--pictures FOLDER] [--node] [--moving]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.islands "$@"
