#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then runs every test and names those parts that failed.
#   tests/run.sh [--only native|python|blender|package|style]
# The part "package" is the tests of the add-on on the extension as Blender installs it from the zip that ships, the
# native package being the one in it: some of the files among others, all of them with --only package.
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

only=''
case ${1:-} in
  '') ;;
  --only) only=${2:?--only needs native, python, blender, package or style} ;;
  *) fail "unknown option $1; see the head of tests/run.sh" ;;
esac
case $only in
  '' | native | python | blender | package | style) ;;
  *) fail "--only $only: it must be native, python, blender, package or style" ;;
esac

# A registered class can hang Blender at exit, so nothing that holds bpy runs without a limit.
limit=(timeout --kill-after=10 1500)
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

# real_blender FOLDER ARGUMENT...: the tests in the executable, whose Python finds pytest and others in a folder.
real_blender() {
  local folder=$1
  shift
  PYTHONPATH=$folder "${limit[@]}" blender -b --factory-startup --python-use-system-env \
    --python-exit-code 1 -P tests/blender/run.py -- -q "$@"
}

# The zip that ships, and beside it the packages of build/venv without Dapple's own.
make_package() {
  local entry
  rm -rf "$tested"
  scripts/package.sh --build build/release --to "$tested" >/dev/null && mkdir "$tested/site-packages" || return
  for entry in "$site_packages"/*; do
    [[ ${entry##*/} == dapple* ]] || ln -s "$entry" "$tested/site-packages"
  done
}

# on_package COMMAND...: with the add-on as it is installed from that zip. The virtual environment is left out, of the
# path too: there Blender's own Python looks for the folder it belongs to.
on_package() {
  local archives=("$tested"/*.zip)
  DAPPLE_TESTED_ZIP=${archives[0]} PYTHONPATH=$tested/site-packages PATH=${PATH#"$venv/bin:"} "$@"
}

scripts/setup.sh
site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
part native 'native tests (CTest)' ctest --test-dir build/release -j "$(nproc)" --output-on-failure --no-tests=error
part python 'Python tests' "$python" -m pytest -q tests/python
part blender 'Blender tests (bpy module)' "${limit[@]}" "$python" -m pytest -q tests/blender
if [ "$(system_name)" = debian-13 ]; then
  part blender 'Blender tests (the real executable)' real_blender "$site_packages"
fi
tested=$root/build/tested
# Those that meet what packing could lose or change: wheel, files, folders, a process of its own.
on_zip=(tests/blender/test_{addon,assets,bake,classes,density,docs,operators,presets,tiles,translation,window}.py)
[ -z "$only" ] || on_zip=(tests/blender)
part package 'the zip that ships' make_package
part package 'Blender tests on the installed zip' \
  on_package "${limit[@]}" /usr/bin/python3 -m pytest -q "${on_zip[@]}"
if [ "$(system_name)" = debian-13 ]; then
  part package 'Blender tests on the installed zip (the real executable)' \
    on_package real_blender "$tested/site-packages" "${on_zip[@]}"
fi
part style 'style' scripts/check.sh

printf '\n== summary\n'
printf '   %s\n' "${results[@]}"
[ "$failures" -eq 0 ] || fail "$failures of ${#results[@]} parts failed"
