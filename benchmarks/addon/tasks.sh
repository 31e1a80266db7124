#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Does nine tasks in a real window, on Debian 13, and counts clicks and seconds: build/tasks/.
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

[ "$(system_name)" = debian-13 ] || fail 'a window needs a Blender program, which Debian ships from 13 (trixie) on'
command -v import >/dev/null || fail 'imagemagick is missing: apt-get install imagemagick'
scripts/setup.sh --dev >&2
site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
export PYTHONPATH=$site_packages DAPPLE_SHOTS=$root/build/tasks LIBGL_ALWAYS_SOFTWARE=1
BLENDER_USER_RESOURCES=$(mktemp -d)
export BLENDER_USER_RESOURCES
mkdir -p "$DAPPLE_SHOTS"
timeout --kill-after=10 2400 xvfb-run -a -s '-screen 0 1920x1500x24 +extension GLX' \
  blender --factory-startup --python-use-system-env --python-exit-code 1 --window-geometry 0 0 1920 1500 \
  --gpu-backend opengl --enable-event-simulate --python benchmarks/addon/tasks.py
