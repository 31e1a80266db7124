#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then samples a ground with mixtures of classes, some with discs, and judges how even and how fast.
#   benchmarks/mixtures/run.sh [--only NAME] [--seeds 1] [--two-stages] [--pictures FOLDER]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.mixtures "$@"
