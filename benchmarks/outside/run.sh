#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then samples models made of parts with and without what is hidden; prints a table.
#   benchmarks/outside/run.sh [--count 1500] [--seeds 3] [MESH...]
# Without meshes: bodies of balls and boxes that are stuck into each other.
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 3600 "$python" -m benchmarks.outside "$@"
