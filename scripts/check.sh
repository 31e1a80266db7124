#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Style and static checks. Runs all of them, names those that failed.
#   scripts/check.sh [--fix] [--quick] [--only CHECK]
#     --fix     apply what clang-format and ruff can mend
#     --quick   all but clang-tidy
#     --only    one of: clang-format clang-tidy ruff mypy shellcheck
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

fix='' quick='' only=''
while [ $# -gt 0 ]; do
  case $1 in
    --fix) fix=1 ;;
    --quick) quick=1 ;;
    --only) only=${2:?--only needs the name of a check}; shift ;;
    *) fail "unknown option $1; see the head of scripts/check.sh" ;;
  esac
  shift
done

# find_files NAME_PATTERN FOLDER...: those of the folders that exist are searched.
find_files() {
  local pattern=$1 folders=() folder
  shift
  for folder in "$@"; do [ ! -d "$folder" ] || folders+=("$folder"); done
  [ "${#folders[@]}" -eq 0 ] || find "${folders[@]}" -type f -regextype posix-extended -regex "$pattern" | sort
}
mapfile -t cxx < <(find_files '.*\.[ch]pp' native tests benchmarks)
mapfile -t python_folders < <(for d in native/python addon benchmarks blend_examples scripts tests; do [ ! -d $d ] || echo $d; done)
mapfile -t typed < <(find_files '.*\.pyi?' native/python addon benchmarks blend_examples scripts)
mapfile -t shell < <(find_files '.*\.sh' scripts tests blend_examples benchmarks)

clang_format_check() {
  if [ -n "$fix" ]; then clang-format -i "${cxx[@]}"; else clang-format --dry-run --Werror "${cxx[@]}"; fi
}

ruff_check() {
  if [ -n "$fix" ]; then
    ruff format -q "${python_folders[@]}"
    ruff check -q --fix "${python_folders[@]}"
  else
    ruff format -q --check --diff "${python_folders[@]}" && ruff check -q "${python_folders[@]}"
  fi
}

# A file is looked at again only when it, a header, its compile command or the rules have changed.
tidy_one() {
  local key
  key=$(sha256sum "$1" | cut -d ' ' -f 1)-$2
  [ ! -f "build/tidy/$key" ] || return 0
  clang-tidy --quiet -p build/release --extra-arg=-Wno-unknown-warning-option "$1" 2>&1 |
    sed '/^[0-9]* warnings\{0,1\}.* generated/d' && touch "build/tidy/$key"
}
export -f tidy_one

clang_tidy_check() {
  local common
  [ -f build/release/compile_commands.json ] || fail 'clang-tidy needs the release build: run scripts/setup.sh'
  mkdir -p build/tidy
  common=$({
    find_files '.*\.hpp' native | xargs cat
    cat .clang-tidy build/release/compile_commands.json scripts/requirements.txt
  } | sha256sum | cut -c 1-16)
  find_files '.*\.cpp' native | xargs -P "$(build_jobs)" -I '{}' bash -o pipefail -c 'tidy_one "$@"' _ '{}' "$common"
}

failed=()
run_check() {
  local name=$1
  shift
  [ -z "$only" ] || [ "$only" = "$name" ] || return 0
  printf -- '-- %s\n' "$name"
  "$@" || failed+=("$name")
}

[ "${#cxx[@]}" -eq 0 ] || run_check clang-format clang_format_check
run_check ruff ruff_check
[ "${#typed[@]}" -eq 0 ] || run_check mypy mypy "${typed[@]}"
run_check shellcheck shellcheck "${shell[@]}" .ci/run
[ -n "$quick" ] || run_check clang-tidy clang_tidy_check

[ "${#failed[@]}" -eq 0 ] || fail "style: ${failed[*]} (scripts/check.sh --fix mends what can be mended)"
echo 'style: clean'
