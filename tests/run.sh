#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then runs every test and names those parts that failed.
#   tests/run.sh [--only native|python|blender|style]
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

only=''
case ${1:-} in
  '') ;;
  --only) only=${2:?--only needs native, python, blender or style} ;;
  *) fail "unknown option $1; see the head of tests/run.sh" ;;
esac
case $only in
  '' | native | python | blender | style) ;;
  *) fail "--only $only: it must be native, python, blender or style" ;;
esac

# A registered class can hang Blender at exit, so nothing that holds bpy runs without a limit.
limit=(timeout --kill-after=10 900)
results=() failures=0

# part GROUP NAME COMMAND...: runs the command, keeps the outcome for the summary.
part() {
  local group=$1 name=$2 rc=0
  shift 2
  [ -z "$only" ] || [ "$only" = "$group" ] || return 0
  printf '\n== %s\n' "$name"
  SECONDS=0
  "$@" </dev/null || rc=$?
  [ "$rc" -eq 0 ] || failures=$((failures + 1))
  results+=("$([ "$rc" -eq 0 ] && echo passed || echo "FAILED ($rc)")  $name, $SECONDS s")
}

real_blender() {
  local site_packages
  site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  PYTHONPATH=$site_packages "${limit[@]}" blender -b --factory-startup --python-use-system-env \
    --python-exit-code 1 -P tests/blender/run.py -- -q
}

scripts/setup.sh
part native 'native tests (CTest)' ctest --test-dir build/release -j "$(nproc)" --output-on-failure --no-tests=error
part python 'Python tests' "$python" -m pytest -q tests/python
part blender 'Blender tests (bpy module)' "${limit[@]}" "$python" -m pytest -q tests/blender
if [ "$(system_name)" = debian-13 ]; then
  part blender 'Blender tests (the real executable)' real_blender
fi
part style 'style' scripts/check.sh

printf '\n== summary\n'
printf '   %s\n' "${results[@]}"
[ "$failures" -eq 0 ] || fail "$failures of ${#results[@]} parts failed"
