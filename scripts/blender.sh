#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Opens Debian 13's Blender with the add-on as it lies in this folder; arguments go to Blender.
#   scripts/blender.sh [build/examples/creature.blend]
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ "$(system_name)" = debian-13 ] || fail 'Dapple needs Blender 4.3, which Debian ships from 13 (trixie) on'
scripts/setup.sh --dev
PYTHONPATH=$root:$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
export PYTHONPATH
exec blender --python-use-system-env --python-expr 'import addon; addon.register()' "$@"
