#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures how honest the progress of each piece of long work is and how soon it stops.
#   benchmarks/progress/run.sh [--only NAME] [--size N]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.progress "$@"
