#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fuzzes algorithms and readers by libFuzzer with AddressSanitizer and UndefinedBehaviorSanitizer, and the readers of the
# Python package by damaged files: tests/fuzz/README.md.
#   tests/fuzz.sh [--seconds N] [--only TARGET] [--corpus DIR] [--keep]
#     --seconds   for each target, after the kept inputs; 60 without it
#     --only      one of the targets: a name in tests/fuzz/targets, or files, the readers of the Python package
#     --corpus    where found inputs are read and written, a folder for each target; build/fuzz/corpus without it
#     --keep      at the end the smallest set of inputs that reaches as much becomes tests/fuzz/corpus
# A target ends at its first finding. Its input is then in build/fuzz/findings, what it said in build/fuzz/logs.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

seconds=60 only='' corpus=$root/build/fuzz/corpus keep=''
while [ $# -gt 0 ]; do
  case $1 in
    --seconds)
      seconds=${2:?--seconds needs a number}
      shift
      ;;
    --only)
      only=${2:?--only needs a target}
      shift
      ;;
    --corpus)
      corpus=$(cd "$here" && realpath -m -- "${2:?--corpus needs a folder}")
      shift
      ;;
    --keep) keep=1 ;;
    *) fail "unknown option $1; see the head of tests/fuzz.sh" ;;
  esac
  shift
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || fail "--seconds $seconds: it must be a whole number above 0"
mapfile -t native < <(basename -s .cpp -a tests/fuzz/targets/*.cpp)
targets=("${native[@]}" files)
if [ -n "$only" ]; then
  [[ " ${targets[*]} " == *" $only "* ]] || fail "--only $only: it must be one of ${targets[*]}"
  targets=("$only")
fi

build=$root/build/fuzz
kept=$build/kept
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=0:symbolize=1
export UBSAN_OPTIONS=print_stacktrace=1

# fuzz TARGET: the log says how it went.
fuzz() {
  if [ "$1" = files ]; then
    "$python" -W ignore tests/fuzz/files.py --seconds "$seconds" --seed "$RANDOM" --findings "$build/findings"
    return
  fi
  local dictionary=tests/fuzz/$1.dict
  mkdir -p "$corpus/$1" "$kept/$1"
  [ ! -f "$dictionary" ] || set -- "$1" -dict="$dictionary"
  "$build/tests/fuzz/fuzz_$1" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="$build/findings/$1-" "${@:2}" "$corpus/$1" "$kept/$1"
}

# row TARGET: runs it and prints its line of the table.
row() {
  local log=$build/logs/$1.log rc=0 runs covered cpu
  TIMEFORMAT='%U %S'
  cpu=$({ time fuzz "$1" >"$log" 2>&1 </dev/null; } 2>&1) || rc=$?
  cpu=$(tail -n 1 <<<"$cpu" | awk '{printf "%d", $1 + $2}')
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p; s/^\([0-9]*\) runs.*/\1/p' "$log" | tail -n 1)
  covered=$(sed -n 's/.* cov: \([0-9]*\).*/\1/p' "$log" | tail -n 1)
  printf '   %-12s %10s %10s %10s   %s\n' "$1" "${runs:-?}" "$cpu" "${covered:--}" "$(finding "$1" "$rc")"
  total=$((total + cpu))
  [ "$rc" -eq 0 ] || found+=("$1")
}

finding() {
  local input
  [ "$2" -ne 0 ] || { echo none; return; }
  input=$(sed -n 's/.*Test unit written to //p; s/^\(.*\/files-[^:]*\):$/\1/p' "$build/logs/$1.log" | tail -n 1)
  input=${input#"$root"/}
  echo "${input:-"none kept: see the log"}"
}

# The inputs that together reach what all of them do.
minimize() {
  local target smallest=$build/smallest
  rm -rf "$smallest"
  for target in "${targets[@]}"; do
    [ "$target" != files ] || continue
    mkdir -p "$smallest/$target"
    "$build/tests/fuzz/fuzz_$target" -set_cover_merge=1 -timeout=20 "$smallest/$target" "$corpus/$target" "$kept/$target" \
      >"$build/logs/$target-merge.log" 2>&1 || return
  done
  "$python" tests/fuzz/corpus.py pack "$smallest"
}

build_fuzzers() {
  configure_with_clang fuzz
  stage 'build the fuzzers' cmake --build --preset fuzz -j "$(build_jobs)"
}

case $only in
  '' | files) scripts/setup.sh --dev ;;
  *) scripts/setup.sh --tools ;;
esac
[ "$only" = files ] || build_fuzzers
rm -rf "$kept" && mkdir -p "$build"/{findings,logs}
"$python" tests/fuzz/corpus.py unpack "$kept"

found=() total=0
printf '   %-12s %10s %10s %10s   %s\n' target runs 'CPU s' coverage findings
for target in "${targets[@]}"; do row "$target"; done
printf '   %d s of processor, %d findings\n' "$total" "${#found[@]}"
[ -z "$keep" ] || stage 'keep the smallest corpus' minimize
[ "${#found[@]}" -eq 0 ] || fail "findings: ${found[*]}; the inputs are in build/fuzz/findings, what was said in build/fuzz/logs"
