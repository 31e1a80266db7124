#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then scatters over ordinary Blender objects and judges how even they come out; with --cost,
# what an evaluation costs on bodies that are hard against that on a sphere; with --characters, bakes of rigged characters.
#   benchmarks/zoo/run.sh [--only NAME] [--json FILE]
#   benchmarks/zoo/run.sh --characters [--folder FOLDER]
#   benchmarks/zoo/run.sh --cost [--counts N...]
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

module=benchmarks.zoo
case ${1:-} in
  --cost | --characters)
    module=benchmarks.zoo.${1#--}
    shift
    ;;
esac
scripts/setup.sh --dev >&2
PYTHONPATH=$root exec timeout --kill-after=10 1800 "$python" -m "$module" "$@"
