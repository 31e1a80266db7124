#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then runs every test and names those that failed; the last line counts them. The native tests
# are compiled while the others run.
#   tests/run.sh [--all | --quick | --thorough] [--only native|python|blender|package|style] [--zip FILE]
#     --all     before a release: clang-tidy over every source, all Blender tests on the installed zip, the documentation site
#     --thorough  --all, and what takes most of a day: every case of what is sampled otherwise (allocations that fail,
#               damaged files, 200 random sequences of 60 operations, 50 kills, 2,000 meshes for each property),
#               sanitizers, an hour of fuzzing, lines broken on purpose, coverage, soak
#     --quick   where everything is built, an answer in three minutes; it says what it leaves out
#     --only    one part
#     --zip     with --only package: this zip instead of a new one. Nothing is set up: build/venv has pytest and bpy.
# The part "package" is the tests of the add-on on the extension as Blender installs it from the zip that ships, the
# native package being the one in it: some of the files among others and with --zip, all with --all or --only package.
# Tests run side by side, one process for each core, the style checks beside them. build/reports keeps what each
# process printed and its JUnit report.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

only='' depth='' zip=''
while [ $# -gt 0 ]; do
  case $1 in
    --all | --quick | --thorough)
      [ -z "$depth" ] || fail "$depth and $1 exclude each other"
      depth=$1
      ;;
    --only)
      only=${2:?--only needs native, python, blender, package or style}
      shift
      ;;
    --zip)
      zip=$(cd "$here" && realpath -e -- "${2:?--zip needs a file}")
      shift
      ;;
    *) fail "unknown option $1; see the head of tests/run.sh" ;;
  esac
  shift
done
case $only in
  '' | native | python | blender | package | style) ;;
  *) fail "--only $only: it must be native, python, blender, package or style" ;;
esac
[ "$depth$only" != --quickpackage ] || fail '--quick leaves out the part "package"'
[ -z "$zip" ] || [ "$only" = package ] || fail '--zip goes with --only package'

# A registered class can hang Blender at exit, so nothing that holds bpy runs without a limit: twice what it takes on two
# busy cores.
limit=(timeout --kill-after=10 2400)
[ "$depth" != --thorough ] || limit=(timeout --kill-after=10 36000)
workers=$(build_jobs)
tested=$root/build/tested
reports=$root/build/reports
rm -rf "$reports" && mkdir "$reports"
results=() parts=0 failures=0 passed=0 failed=0
DAPPLE_BUILT_ZIP=

# What runs beside this script ignores Ctrl-C: it ends when the script does, with what it has started itself.
end_jobs() {
  local job
  for job in $(jobs -p); do kill -- "-$job" 2>/dev/null || kill "$job" 2>/dev/null || true; done
}
trap end_jobs EXIT

is_all() { [ "$depth" = --all ] || [ "$depth" = --thorough ]; }

wanted() { [ -z "$only" ] || [ "$only" = "$1" ]; }

# part GROUP NAME COMMAND...: runs the command, which may leave JUnit reports $report*.xml; keeps the outcome for the
# summary.
part() {
  local group=$1 name=$2 rc=0
  shift 2
  wanted "$group" || return 0
  printf '\n== %s\n' "$name"
  SECONDS=0
  report=$reports/$((++parts))
  "$@" </dev/null || rc=$?
  keep_outcome "$rc" "$name, $SECONDS s"
}

# keep_outcome STATUS NAME: what leaves no report counts as one test, and so does a failure that no report tells.
keep_outcome() {
  local rc=$1 lines good bad skipped outcome=passed
  mapfile -t lines < <("$python" tests/tally.py "$report"[.-]*xml)
  read -r good bad skipped <<<"${lines[0]}"
  if [ "$rc" -ne 0 ]; then
    outcome="FAILED ($rc)" failures=$((failures + 1))
    [ "$bad" -gt 0 ] || bad=1
  elif [ "$good" -eq 0 ]; then
    good=1
  fi
  passed=$((passed + good)) failed=$((failed + bad))
  results+=("$outcome  $2: $good passed, $bad failed, $skipped skipped" "${lines[@]:1}")
}

# side_by_side COMMAND...: pytest over tests/blender in as many processes as there are cores, each of which takes the
# next file that no other has taken (tests/blender/conftest.py). One after the other shows what it printed.
side_by_side() {
  local processes=() i rc=0
  mkdir "$report.taken"
  for ((i = 0; i < workers; i++)); do
    DAPPLE_TAKEN=$report.taken "$@" --junitxml="$report-$i.xml" >"$report-$i.log" 2>&1 &
    processes+=($!)
  done
  for i in "${!processes[@]}"; do
    wait "${processes[i]}" || rc=$?
    cat "$report-$i.log"
  done
  return "$rc"
}

# real_blender FOLDER ARGUMENT...: a process, started beside the script, for the tests in the executable, whose Python
# finds pytest and others in a folder. The virtual environment is no part of the path: there Blender's own Python looks
# for the folder that it belongs to.
real_blender() {
  local folder=$1
  shift
  PYTHONPATH=$folder PATH=${PATH#"$venv/bin:"} exec "${limit[@]}" blender -b --factory-startup --python-use-system-env \
    --python-exit-code 1 -P tests/blender/run.py -- "$@"
}

# The zip that ships, and beside it the packages of build/venv without Dapple's own.
make_package() {
  local entry
  rm -rf "$tested"
  [ -n "$zip" ] || scripts/package.sh --build build/release --to "$tested" >/dev/null || return
  mkdir -p "$tested/site-packages"
  for entry in "$site_packages"/*; do
    [[ ${entry##*/} == dapple* ]] || ln -s "$entry" "$tested/site-packages"
  done
  DAPPLE_BUILT_ZIP=${zip:-$(ls "$tested"/*.zip)} && export DAPPLE_BUILT_ZIP # for the tests of the zip itself
}

# on_package COMMAND...: with the add-on as it is installed from that zip, and no virtual environment.
on_package() {
  DAPPLE_TESTED_ZIP=${DAPPLE_BUILT_ZIP:-missing} PYTHONPATH=$tested/site-packages PATH=${PATH#"$venv/bin:"} "$@"
}

# The checks run beside the tests; their part waits for them and shows what they said.
begin_style() {
  setsid scripts/check.sh "$@" >"$reports/style.log" 2>&1 </dev/null &
  style=$!
}
end_style() {
  local rc=0
  wait "$style" || rc=$?
  cat "$reports/style.log"
  return "$rc"
}

# The tests of the library are compiled, at low priority, while those run that need only the library and the bindings.
begin_build() {
  setsid nice -n 19 scripts/setup.sh --tests >"$reports/build.log" 2>&1 </dev/null &
  build=$!
}
# Waits for that; where it fails the native tests are not run.
end_build() {
  local rc=0
  wait "$build" || rc=$?
  [ "$rc" -eq 0 ] || cat "$reports/build.log" >&2
  built=$rc
  return "$rc"
}

native_tests() {
  ctest --test-dir build/release -j "$workers" --output-on-failure --no-tests=error --output-junit "$report.xml" "$@"
}
python_tests() {
  "$python" -m pytest -q -n "$workers" --junitxml="$report.xml" tests/python "$@"
}
# Over new meshes every time: what it finds is printed with what repeats it.
properties() {
  "$python" -m pytest -q -n "$workers" --junitxml="$report.xml" --hypothesis-profile=thorough tests/python/test_properties.py
}
blender_tests() { side_by_side "${limit[@]}" "$python" -m pytest "$@"; }
real_blender_tests() { side_by_side real_blender "$@"; }
tests_on_package() { on_package side_by_side "${limit[@]}" /usr/bin/python3 -m pytest "${on_zip[@]}"; }
real_tests_on_package() { on_package side_by_side real_blender "$tested/site-packages" "${on_zip[@]}"; }

# all_native ARGUMENT...: the build of the tests, then the tests.
all_native() {
  part native 'build of the tests' end_build
  [ "$built" -ne 0 ] || part native 'native tests (CTest)' native_tests "$@"
}

# What takes longest or is far from the core is left out by name, so that what is new is run.
quick_parts() {
  part python 'Python tests' python_tests "${slow_python[@]/#/--ignore=}"
  part blender 'Blender tests (bpy module)' blender_tests tests/blender "${slow_blender[@]/#/--ignore=}"
  all_native --exclude-regex "$slow_native"
  part style 'style' end_style
}

say_left_out() {
  echo '   --quick has left out:'
  printf '     native tests named %s\n' "$slow_native"
  printf '     %s\n' "${slow_python[*]}" "${slow_blender[*]}" \
    'the tests in the real executable and on the installed zip' 'clang-tidy'
}

all_parts() {
  part python 'Python tests' python_tests
  part package 'the zip that ships' make_package
  part blender 'Blender tests (bpy module)' blender_tests tests/blender
  [ -z "$real" ] || part blender 'Blender tests (the real executable)' real_blender_tests "$site_packages"
  part package 'Blender tests on the installed zip' tests_on_package
  [ -z "$real" ] || part package 'Blender tests on the installed zip (the real executable)' real_tests_on_package
  all_native
  part style 'style' end_style
  ! is_all || part style 'the documentation site' scripts/docs.sh --as-built
}

# What is no part of CI for the time that it takes; each has a command of its own.
thorough_parts() {
  part native 'native tests under sanitizers' tests/sanitize.sh --seconds 14400
  part native 'fuzzers' tests/fuzz.sh --seconds 240
  part native 'lines broken on purpose' "$python" tests/mutate.py
  part native 'coverage of the library' tests/coverage.sh --only native
  part python 'coverage of the package' tests/coverage.sh --only python
  part python 'properties' properties
  part blender 'coverage of the add-on' tests/coverage.sh --only blender
  part blender 'soak' tests/soak.sh
}

real=''
[ "$(system_name)" != debian-13 ] || real=1
# Those that meet what packing could lose or change: wheel, files, folders, a process of its own.
on_zip=(
  tests/blender/test_{addon,docs,operators,window}.py tests/blender/{assets/test_assets,bake/test_bake,command/test_command}.py
  tests/blender/{density/test_density,object_types/test_object_types,presets/test_presets,settings/test_translation,tiles/test_tiles}.py
)
[ -z "$zip" ] || on_zip+=(tests/blender/test_package.py)
if is_all || { [ -n "$only" ] && [ -z "$zip" ]; }; then on_zip=(tests/blender); fi
slow_native='^(Consumer|Gradient|SamplerBands|Tracker)\.|RealMesh'
slow_python=(tests/python/test_{animations,distribution,paper_report}.py)
slow_blender=(
  tests/blender/test_{datablocks,examples,failures,hostile,libraries,package,undo}.py tests/blender/command/test_farm.py
  tests/blender/{bake/test_contents_bake,bake/test_unfinished_bakes,freshness/test_contents,freshness/test_contents_kept}.py
)

[ -n "$zip" ] || scripts/setup.sh --dev
site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
if [ "$depth" = --thorough ]; then export DAPPLE_THOROUGH=1 DAPPLE_SEEDS=200 DAPPLE_ROUNDS=60 DAPPLE_KILLS=50; fi
case $depth in
  --quick) checks=(--quick) ;;
  --all | --thorough) checks=(--all) ;;
  *) checks=() ;;
esac
built=0
! wanted native || begin_build
! wanted style || begin_style "${checks[@]}"
if [ "$depth" = --quick ]; then quick_parts; else all_parts; fi
[ "$depth" != --thorough ] || thorough_parts

printf '\n== summary\n'
printf '   %s\n' "${results[@]}"
[ "$depth" != --quick ] || say_left_out
[ "$failures" -eq 0 ] || printf 'error: %d of %d parts failed\n' "$failures" "$parts" >&2
printf '%d passed, %d failed\n' "$passed" "$failed"
[ "$failures" -eq 0 ]
