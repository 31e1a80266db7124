#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then samples what scans and assemblies bring (specks, far parts, noise) and judges its time beside plain surfaces.
#   benchmarks/specks/run.sh [--only "far parts"] [--small]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 3600 "$python" -m benchmarks.specks "$@"
