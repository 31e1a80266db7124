#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then does the same for a long time and tells whether memory and speed stay as they are: a
# Markdown table. It fails where memory grows, or a file, a thread or a process is left behind.
#   tests/soak.sh [--only tracking|updates|playback ...] [--minutes N] [--frames N]
#     --only      tracking: a body that never rests; updates: random edits with Auto Update; playback: of a bake
#     --minutes   of tracking, and of updates (60)
#     --frames    of playback (5000)
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

scripts/setup.sh --dev >&2
BLENDER_USER_RESOURCES=$(mktemp -d) && export BLENDER_USER_RESOURCES # never the user's own settings
trap 'rm -rf "$BLENDER_USER_RESOURCES"' EXIT
PYTHONPATH=$root/tests:$root/tests/blender:$root "$python" -m soak "$@"
