#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then judges samples on deforming bodies: tables, build/tracking/*.png.
#   benchmarks/tracking/run.sh [--quick] [--frames N] [--sites N] [--json FILE] [--shared FOLDER] ...
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.tracking "$@"
