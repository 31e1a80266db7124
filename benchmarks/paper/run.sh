#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then makes the paper's figures again: pictures and one table in build/paper.
#   benchmarks/paper/run.sh [FOLDER] [--only FIGURE ...] [--quick] [--out FOLDER] [--help and other options]
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.paper "$@"
