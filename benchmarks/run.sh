#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then measures how fast evaluations and whole runs are: a Markdown table.
#   benchmarks/run.sh [--only CASE ...] [--seeds N] [--processors N ...] [--mesh FILE] [--json FILE]
#     [--against FOLDER] [--against-benchmarks FILE]
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

scripts/setup.sh --tests >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.speed "$@"
