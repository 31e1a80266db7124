#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Takes screenshots in a real window, on Debian 13: of the add-on's panel in each state (build/window/*.png), or
# the pictures of docs/manual (build/manual/*.png).
#   blend_examples/window.sh [window|manual]
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

[ "$(system_name)" = debian-13 ] || fail 'a window needs a Blender program, which Debian ships from 13 (trixie) on'
command -v import >/dev/null || fail 'imagemagick is missing: apt-get install imagemagick'
told=${1:-window}
case $told in
  window) size=1600x1100 ;;
  manual) size=1240x920 ;;
  *) fail "unknown story $told; see the head of blend_examples/window.sh" ;;
esac
scripts/setup.sh --dev
site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
export PYTHONPATH=$site_packages DAPPLE_SHOTS=$root/build/$told LIBGL_ALWAYS_SOFTWARE=1
BLENDER_USER_RESOURCES=$(mktemp -d)
export BLENDER_USER_RESOURCES
mkdir -p "$DAPPLE_SHOTS"
timeout --kill-after=10 1800 xvfb-run -a -s "-screen 0 ${size}x24 +extension GLX" \
  blender --factory-startup --python-use-system-env --python-exit-code 1 --window-geometry 0 0 "${size%x*}" "${size#*x}" \
  --gpu-backend opengl --enable-event-simulate --python "blend_examples/$told.py"
