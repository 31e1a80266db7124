#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Style and static checks. Runs all of them, names those that failed.
#   scripts/check.sh [--fix] [--quick | --all | --since COMMIT] [--only CHECK]
#     --fix     apply what clang-format and ruff can mend
#     --quick   all but clang-tidy
#     --all     clang-tidy looks at every source: before a release
#     --since   clang-tidy looks at what has changed since this commit
#     --only    one of: clang-format rooms clang-tidy ruff mypy spelling shellcheck workflows
# clang-tidy takes by far the longest, so it looks at what has changed only: sources, and those that include a changed
# header themselves. Without --since that is what has changed since the first of these commits that there is:
#   the last one that clang-tidy found clean in this folder, if it is an ancestor
#   the one where this branch left origin/main, unless that is this very commit
#   the one before this: so in a fresh clone of the main branch the last commit is looked at
# What is not committed yet counts as changed. Where git knows none of them, and when clang-tidy itself or its rules have
# changed, it looks at every source.
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

fix='' quick='' all='' since='' only=''
while [ $# -gt 0 ]; do
  case $1 in
    --fix) fix=1 ;;
    --quick) quick=1 ;;
    --all) all=1 ;;
    --since)
      since=$(git rev-parse --verify --quiet "${2:?--since needs a commit}^{commit}") || fail "git knows no commit $2"
      shift
      ;;
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
mapfile -t python_folders < <(for d in native/python addon benchmarks blend_examples docs scripts tests; do [ ! -d $d ] || echo $d; done)
# A stub speaks for the module beside it.
mapfile -t typed < <(find_files '.*\.pyi?' native/python addon benchmarks blend_examples docs scripts |
  while read -r file; do [ -f "${file}i" ] || echo "$file"; done)
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
# libstdc++ uses a function of its own that is deprecated, which clang says of every stable_sort; GCC watches ours.
tidy_one() {
  local key
  key=$(sha256sum "$1" | cut -d ' ' -f 1)-$2
  [ ! -f "build/tidy/$key" ] || return 0
  clang-tidy --quiet -p build/tidy/commands --extra-arg=-Wno-unknown-warning-option \
    --extra-arg=-Wno-deprecated-declarations "$1" 2>&1 |
    sed '/^[0-9]* warnings\{0,1\}.* generated/d' && touch "build/tidy/$key"
}
export -f tidy_one

# The commit that changes are counted from; nothing where git knows none.
tidy_base() {
  local last=build/tidy/clean main
  if [ -f "$last" ] && git merge-base --is-ancestor "$(<"$last")" HEAD; then
    cat "$last"
  elif main=$(git merge-base HEAD origin/main) && [ "$main" != "$(git rev-parse HEAD)" ]; then
    echo "$main"
  else
    git rev-parse --verify --quiet HEAD^
  fi 2>/dev/null
}

# changed_since COMMIT PATH...: files that differ from a commit, new ones too.
changed_since() {
  local commit=$1
  shift
  git diff --name-only --diff-filter=d "$commit" -- "$@"
  git ls-files --others --exclude-standard -- "$@"
}

# tidy_rules_changed COMMIT: whether the tool or its rules are others than there.
tidy_rules_changed() {
  [ -n "$(changed_since "$1" .clang-tidy)" ] ||
    [ -n "$(git diff -U0 "$1" -- scripts/requirements-tools.txt | sed -n '/^[+-]clang-tidy/p')" ]
}

# includers HEADER: the sources that include a header themselves; where only headers do, the sources of those.
includers() {
  local found header
  found=$(grep -rlE --include='*.[ch]pp' "^#include [<\"]([a-z]+/)?${1##*/}[>\"]" native) || return 0
  if grep '\.cpp$' <<<"$found"; then return; fi
  for header in $found; do includers "$header"; done
}

# tidy_sources COMMIT: of all sources, those that a change since then concerns.
tidy_sources() {
  local file
  changed_since "$1" native | while read -r file; do
    case $file in
      *.cpp) echo "$file" ;;
      *.hpp) includers "$file" ;;
    esac
  done | sort -u
}

clang_tidy_check() {
  local common sources
  mkdir -p build/tidy
  # Its own commands: one for each source, without GCC's precompiled headers.
  cmake --preset release -B build/tidy/commands -DDAPPLE_FAST_COMPILE=OFF >build/tidy/configure.log 2>&1 ||
    fail 'clang-tidy needs a set-up: run scripts/setup.sh --dev; see build/tidy/configure.log'
  [ -n "$all$since" ] || since=$(tidy_base) || echo '   git knows no commit to compare with: every source'
  mapfile -t sources < <(find_files '.*\.cpp' native)
  if [ -z "$all" ] && [ -n "$since" ] && ! tidy_rules_changed "$since"; then
    mapfile -t sources < <(tidy_sources "$since")
    echo "   ${#sources[@]} sources that changed since $(git rev-parse --short "$since") or include what did; --all: every one"
  fi
  common=$({
    find_files '.*\.hpp' native | xargs cat
    cat .clang-tidy build/tidy/commands/compile_commands.json scripts/requirements-tools.txt
  } | sha256sum | cut -c 1-16)
  printf '%s\n' "${sources[@]}" |
    xargs -r -P "$(build_jobs)" -I '{}' bash -o pipefail -c 'tidy_one "$@"' _ '{}' "$common" || return
  git rev-parse --verify --quiet HEAD >build/tidy/clean || rm build/tidy/clean
}

# Against the numpy of both Pythons, whichever build/venv has: what is clean here is clean on the other system.
mypy_check() {
  local version rc=0
  for version in 3.11 3.13; do
    [ -d "$(numpy_types "$version")" ] || fail 'mypy needs the types of numpy: run scripts/setup.sh --dev'
    PYTHONPATH=$(numpy_types "$version") mypy --python-version "$version" "${typed[@]}" || rc=$?
  done
  return "$rc"
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
[ "${#cxx[@]}" -eq 0 ] || run_check rooms scripts/rooms.py
run_check ruff ruff_check
[ "${#typed[@]}" -eq 0 ] || run_check mypy mypy_check
run_check spelling python3 scripts/spelling.py
run_check shellcheck shellcheck "${shell[@]}" .ci/run
run_check workflows check-jsonschema --quiet --builtin-schema vendor.github-workflows .github/workflows/*.yml
[ -n "$quick" ] || run_check clang-tidy clang_tidy_check

[ "${#failed[@]}" -eq 0 ] || fail "style: ${failed[*]} (scripts/check.sh --fix mends what can be mended)"
echo 'style: clean'
