#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then judges stippled pictures: a Markdown table on stdout, pictures in build/stipple.
#   benchmarks/stipple/run.sh [--only gray|color] [--seeds N] [--pictures FOLDER] [--help]
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.stipple "$@"
