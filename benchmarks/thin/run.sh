#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then samples bodies thinner than the spacing and judges how even they come out.
#   benchmarks/thin/run.sh [--seeds 20] [--only NAME]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root:$root/tests/python exec timeout --kill-after=10 1800 "$python" -m benchmarks.thin "$@"
