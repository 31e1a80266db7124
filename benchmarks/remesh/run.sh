#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then remeshes meshes by Dapple and by other packages and judges the results alike: a Markdown table.
#   benchmarks/remesh/run.sh [--only dapple pyacvd ...] [--mesh FILE COUNT] [--sequences] [--help]
# The packages go to the environment of benchmarks/peers, in build/peers. One that cannot be installed is left out. A program
# `vorpalite` of geogram takes part if there is one; CGAL's is compiled to build/peers/dapple_isotropic.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

peers=$root/build/peers/venv
scripts/setup.sh --dev >&2
[ -x "$peers/bin/python" ] || stage 'environment of the peers' /usr/bin/python3 -m venv "$peers" >&2
for package in pymeshlab pyacvd; do
  stage "peer $package" timeout 900 "$peers/bin/python" -m pip install --no-input -c "$root/$constraints" --prefer-binary "$package" >&2 ||
    printf '   it goes on without %s\n' "$package" >&2
done
isotropic=$root/build/peers/dapple_isotropic
[ "$isotropic" -nt "$root/benchmarks/remesh/isotropic.cpp" ] ||
  stage 'peer CGAL' c++ -std=c++20 -O2 -DNDEBUG -I/usr/include/eigen3 "$root/benchmarks/remesh/isotropic.cpp" -o "$isotropic" -lgmp -lmpfr >&2 ||
  printf '   it goes on without CGAL\n' >&2
export PATH=$root/build/peers:$PATH
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.remesh --peers-python "$peers/bin/python" "$@"
