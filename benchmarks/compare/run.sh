#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then compares over real meshes and prints Markdown tables.
#   benchmarks/compare/run.sh methods|settings|converge|components [FOLDER] [--help and other options]
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.compare "$@"
