#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then scatters over ordinary Blender objects and judges how even they come out.
#   benchmarks/zoo/run.sh [--only NAME] [--json FILE]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.zoo "$@"
