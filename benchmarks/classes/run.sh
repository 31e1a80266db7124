#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then judges many classes at once: a Markdown table with goals and verdicts.
#   benchmarks/classes/run.sh [FOLDER] [--only CASE ...] [--seeds N] [--json FILE] [--help]
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.classes "$@"
