#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a draft of a release, which only its makers see, of the files in a folder; its text is that of CHANGELOG.md, then
# that of the folder's .md files. A person looks at it and publishes it.
#   scripts/draft_release.sh FOLDER
# It needs GitHub's command `gh`, signed in.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:?scripts/draft_release.sh needs the folder with the files of the release}
shopt -s nullglob
files=("$folder"/*.{tar.gz,zip} "$folder"/wheels/*.whl) texts=("$folder"/*.md)
[ "${#files[@]}" -gt 0 ] || { echo "error: $folder has no wheels, sdist or extensions" >&2; exit 1; }
version=$(python3 -c 'from scripts import release_notes as notes; print(notes.version(open("CMakeLists.txt").read()))')
head=$(git rev-parse HEAD)
tagged=$(git rev-parse --verify --quiet "refs/tags/v$version^{commit}") || tagged=$head
[ "$tagged" = "$head" ] || { echo "error: the tag v$version is another commit than this one" >&2; exit 1; }
notes=$(mktemp)
trap 'rm -f "$notes"' EXIT
python3 scripts/release_notes.py "${texts[@]}" >"$notes"
gh release create "v$version" --draft --title "Dapple $version" --notes-file "$notes" --target "$head" \
  "${files[@]}"
