#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures baked scatters: bytes in the .blend, time of a frame.
#   benchmarks/bake/run.sh [--frames N] [--sites N] [--faces N] [--moving SHARE]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.bake "$@"
