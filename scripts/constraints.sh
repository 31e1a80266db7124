#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes scripts/constraints.txt: the exact version of every package that the requirements files bring with them, for all
# supported Pythons. Everything that installs packages here passes the file to pip.
#   scripts/constraints.sh [--as-of YYYY-MM-DD]
#     --as-of   choose the newest releases up to this day, UTC; without it the day and the versions in the file stay, as far
#               as the requirements allow
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

uv=0.13.9 # resolves for several Pythons at once, and as of a day
day=$(sed -n 's/^# As of \([0-9-]*\)\..*/\1/p' "$constraints") options=()
case ${1:-} in
  '') ;;
  --as-of) day=${2:?--as-of needs a day} options=(--upgrade) ;;
  *) fail "unknown option $1; see the head of scripts/constraints.sh" ;;
esac
[ -x "$python" ] || scripts/setup.sh --tools

need_uv() {
  ! up_to_date build/uv/.stamp "$uv" || return 0
  rm -rf build/uv && "$python" -m pip install --no-input --target build/uv "uv==$uv" && echo "$uv" >build/uv/.stamp
}
# The head is written last, so that it names a day that was resolved.
resolve() {
  local new=build/constraints.txt
  cp "$constraints" "$new" &&
    build/uv/bin/uv pip compile "${options[@]}" --quiet --no-config --universal --python-version 3.11 \
      --fork-strategy fewest --exclude-newer "$day" --no-annotate --no-header --no-strip-markers -o "$new" \
      scripts/requirements*.txt &&
    { printf '%s\n' "# As of $day. Made by scripts/constraints.sh of scripts/requirements*.txt; do not edit." &&
      cat "$new"; } >"$constraints"
}
stage 'uv' need_uv
stage 'constraints' resolve
git --no-pager diff --stat -- "$constraints"
