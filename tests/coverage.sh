#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, runs the tests and prints which share of the lines and branches of each room they run.
#   tests/coverage.sh [--only native|python|blender] [--report]
#     --only     one part: the native tests; those of the package; those of the add-on in the module bpy
#     --report   of what was counted before: nothing is run
# It fails where a room has less than it should (tests/coverage.py). build/coverage/PART.html shows each line.
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

only='' run=1
while [ $# -gt 0 ]; do
  case $1 in
    --only) only=${2:?--only needs native, python or blender}; shift ;;
    --report) run='' ;;
    *) fail "unknown option $1; see the head of tests/coverage.sh" ;;
  esac
  shift
done
case $only in
  '') parts=(native python blender) ;;
  native | python | blender) parts=("$only") ;;
  *) fail "--only $only: it must be native, python or blender" ;;
esac

folder=$root/build/coverage
tools=$folder/tools
mkdir -p "$folder"
[ -z "$run" ] || scripts/setup.sh --dev
need_tools() {
  local hash
  hash=$(hash_of "$(<scripts/requirements-coverage.txt)" "$(<"$constraints")" "$("$python" --version)")
  ! up_to_date "$folder/.tools" "$hash" || return 0
  rm -rf "$tools"
  stage 'tools' pip_install "$python" --target "$tools" -r scripts/requirements-coverage.txt
  echo "$hash" >"$folder/.tools"
}
with_tools() { PYTHONPATH=$tools "$python" -m "$@"; }

# A test that fails is shown and does not stop the count.
run_native() {
  stage 'configure' cmake --preset coverage
  stage 'build' cmake --build --preset coverage -j "$(build_jobs)"
  find "$folder" -name '*.gcda' -delete
  stage 'native tests' ctest --test-dir "$folder" -j "$(build_jobs)" -E '^Consumer\.' || true
}
count_native() {
  stage 'count' with_tools gcovr --root "$root" --object-directory "$folder" --filter native/src/ --filter native/include/ \
    --exclude-throw-branches --exclude-unreachable-branches --merge-mode-functions=separate \
    --exclude-directories '.*CompilerId.*' -j "$(build_jobs)" \
    --json-summary "$folder/native.json" --html-details "$folder/native.html" "$folder"
}

# run_tests PART SOURCE: in one process, and what it starts. The lines are those of a package or a folder.
run_tests() {
  rm -f "$folder/$1".data*
  stage "tests of $1" with_tools coverage run --rcfile tests/coverage.ini --data-file "$folder/$1.data" \
    --source "$2" -m pytest -q "tests/$1" || true
}
count_lines() {
  local data=(--rcfile tests/coverage.ini --data-file "$folder/$1.data")
  if compgen -G "$folder/$1.data.*" >/dev/null; then stage 'combine' with_tools coverage combine -q --append "${data[@]}"; fi
  stage 'count' with_tools coverage json -q "${data[@]}" -o "$folder/$1.json"
}
run_python() { run_tests python dapple3d; }
run_blender() { run_tests blender addon; }
count_python() { count_lines python; }
count_blender() { count_lines blender; }

need_tools
for part in "${parts[@]}"; do
  [ -z "$run" ] || "run_$part"
  "count_$part"
done
exec "$python" tests/coverage.py "${parts[@]/#/$folder/}"
