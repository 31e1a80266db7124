#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the native tests under sanitizers, each within a limit of time, and prints a table.
#   tests/sanitize.sh [--only address|thread|valgrind] [--seconds N]
#     --only      one of them
#     --seconds   limit for the tests of each, without what it takes to build them; 3600 without it
#   address    AddressSanitizer with its search for leaks, and UndefinedBehaviorSanitizer
#   thread     ThreadSanitizer; native/src/base/hand_over.hpp says what it is told of oneTBB
#   valgrind   memcheck, which also knows uninitialized values, on those tests of the release build that $small names
# What each said is in build/reports; a test that did not end in time counts as failed.
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

seconds=3600 only=''
while [ $# -gt 0 ]; do
  case $1 in
    --seconds)
      seconds=${2:?--seconds needs a number}
      shift
      ;;
    --only)
      only=${2:?--only needs address, thread or valgrind}
      shift
      ;;
    *) fail "unknown option $1; see the head of tests/sanitize.sh" ;;
  esac
  shift
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || fail "--seconds $seconds: it must be a whole number above 0"
case $only in
  '' | address | thread | valgrind) ;;
  *) fail "--only $only: it must be address, thread or valgrind" ;;
esac
reports=$root/build/reports
mkdir -p "$reports" && rm -f "$reports"/sanitize-*

results=() failures=0

# keep NAME STATUS: a row of the table, from the report that the tests left.
keep() {
  local outcome=clean
  [ "$2" -eq 0 ] || outcome=FAILED failures=$((failures + 1))
  results+=("$(printf '%-10s %-8s %6d s   %s' "$1" "$outcome" "$SECONDS" \
    "$("$python" tests/tally.py --sentence "$reports/sanitize-$1"*.xml)")")
}

# sanitized NAME PRESET: builds and runs the native tests of a preset. Those that read consumers' projects are not in it.
sanitized() {
  local name=$1 preset=$2 rc=0
  [ -z "$only" ] || [ "$only" = "$name" ] || return 0
  configure_with_clang "$preset"
  stage "build $preset" cmake --build --preset "$preset" -j "$(build_jobs)"
  printf '== %s\n' "$name"
  SECONDS=0
  timeout --kill-after=10 "$seconds" ctest --preset "$preset" -j "$(build_jobs)" --no-tests=error --timeout 900 \
    --output-junit "$reports/sanitize-$name.xml" >"$reports/sanitize-$name.log" 2>&1 </dev/null || rc=$?
  keep "$name" "$rc"
}

# What valgrind takes some minutes for: it makes a program some fifty times slower, and one thread of it runs at a time.
small='FuzzCorpus.TakesAnEmptyInput*:*/FuzzCorpus.TakesAnEmptyInput*:*FuzzCorpus.HoldsNoInputThatBreaksARule/readers'
small+=':MeshFile.*:MeshText.*:Weld.*:Surface.*:Topology.*:CutSurface.*:Decals.*:Rings.*:HalfSpaces.*:Bisectors.*'

memcheck() {
  local rc=0 program name
  [ -z "$only" ] || [ "$only" = valgrind ] || return 0
  need_packages valgrind
  scripts/setup.sh --tests
  printf '== valgrind\n'
  SECONDS=0
  for program in native/dapple_tests fuzz/dapple_fuzz_tests; do
    name=$reports/sanitize-valgrind-${program#*/}
    timeout --kill-after=10 "$seconds" valgrind --quiet --error-exitcode=99 --leak-check=full \
      --show-leak-kinds=definite --errors-for-leak-kinds=definite \
      "build/release/tests/$program" --gtest_filter="$small" --gtest_brief=1 --gtest_output="xml:$name.xml" \
      >"$name.log" 2>&1 </dev/null || rc=$?
  done
  keep valgrind "$rc"
}

scripts/setup.sh --tools
export ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1
sanitized address asan
sanitized thread tsan
memcheck

printf '\n== summary\n'
printf '   %s\n' "${results[@]}"
[ "$failures" -eq 0 ] || fail "$failures not clean: what they said is in build/reports/sanitize-*.log"
