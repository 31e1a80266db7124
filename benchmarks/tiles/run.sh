#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures surfaces that are solved tile by tile: how even points are beside seams, how long
# and how much memory many points take, what Dask costs. Markdown tables.
#   benchmarks/tiles/run.sh [--only seams|speed|dask ...] [--count N] [--workers N] [--seeds N] [--help]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec "$python" -m benchmarks.tiles "$@"
