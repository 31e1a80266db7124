#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then exports scatters by Blender's own exporters and by Dapple's, imports the files into another
# Blender and says what is left of them: docs/export.md has the table.
#   benchmarks/export/run.sh [--only NAME] [--keep FOLDER]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m benchmarks.export "$@"
