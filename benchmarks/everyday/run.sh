#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then does everyday jobs in Blender as combinations of features, and judges what each of them promises.
#   benchmarks/everyday/run.sh [--only TEXT]  exits with 1 if a promise is broken
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 3000 "$python" -m benchmarks.everyday "$@"
