#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the documentation site: build/docs/html/index.html. A warning is an error.
#   scripts/docs.sh [--as-built]     --as-built: the package as build/venv has it, without a build of what has changed
# It reads docs, the pages beside it, the Python package and the public headers; docs/site says how. Sphinx and what it
# needs go to a virtual environment of their own, scripts/requirements-docs.txt.
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case ${1:-} in
  '') scripts/setup.sh --dev ;;
  --as-built) ;;
  *) fail "unknown option $1; see the head of scripts/docs.sh" ;;
esac
site=build/docs
docs_venv=$root/$site/venv
export PYTHONPATH=$root
mkdir -p "$site"

# Behind its own packages it finds those of build/venv: Dapple's and what that needs.
create_venv() {
  /usr/bin/python3 -m venv --clear "$docs_venv" &&
    pip_install "$docs_venv/bin/python" -r scripts/requirements-docs.txt &&
    printf '%s\n' "$venv"/lib/python3*/site-packages >"$(echo "$docs_venv"/lib/python3*/site-packages)/dapple.pth"
}

# Pages that are gone leave nothing behind.
sphinx() {
  rm -rf "$site/html"
  "$docs_venv/bin/python" -m sphinx -b html -E -W --keep-going -d "$site/doctrees" "$site/source" "$site/html"
}

need_packages doxygen
stamp=$(hash_of "$root" "$(/usr/bin/python3 --version)" "$(<scripts/requirements-docs.txt)" "$(<"$constraints")" \
  "$(declare -f create_venv)")
if ! up_to_date "$docs_venv/.stamp" "$stamp"; then
  stage 'environment of the site' create_venv
  echo "$stamp" >"$docs_venv/.stamp"
fi
rm -rf "$site/xml"
stage 'pages' "$python" -m docs.site.stage "$site"
stage 'headers' doxygen docs/site/Doxyfile
stage 'reference' "$python" -m docs.site.reference "$site"
stage 'site' sphinx
echo "   $site/html/index.html"
