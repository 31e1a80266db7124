#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then remeshes meshes by Dapple and by other packages and judges the results alike: a Markdown table.
#   benchmarks/remesh/run.sh [--only dapple pyacvd ...] [--mesh FILE COUNT] [--help]
# The packages go to the environment of benchmarks/peers, in build/peers. One that cannot be installed is left out. A program
# `vorpalite` of geogram takes part if there is one.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

peers=$root/build/peers/venv
scripts/setup.sh --dev >&2
[ -x "$peers/bin/python" ] || stage 'environment of the peers' /usr/bin/python3 -m venv "$peers" >&2
for package in pymeshlab pyacvd; do
  stage "peer $package" timeout 900 "$peers/bin/python" -m pip install --no-input -c "$root/$constraints" --prefer-binary "$package" >&2 ||
    printf '   it goes on without %s\n' "$package" >&2
done
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.remesh --peers-python "$peers/bin/python" "$@"
