#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures the add-on: playback, redraw, node groups, reading, enabling, strokes.
#   benchmarks/addon/run.sh [--sites N] [--rounds N] [--only playback|redraw|groups|reading|enabling|following]
#     [--moved] [--flat] [--against CHECKOUT [--turns N]]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.addon "$@"
