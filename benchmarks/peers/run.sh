#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up what is missing, then places points by Dapple and by other packages on the same meshes and judges them alike: a
# Markdown table on stdout and in build/peers/peers.md, all figures in build/peers/peers.json.
#   benchmarks/peers/run.sh [--large] [--meshes NAME...] [--counts N...] [--only NAME...] [--help]
# The packages go to a virtual environment of their own, in build/peers. One that cannot be installed is a line of the table.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"

peers=$root/build/peers/venv
install() { timeout 900 "$peers/bin/python" -m pip install --no-input -c "$root/$constraints" --prefer-binary "$@"; }

scripts/setup.sh --dev >&2
[ -x "$peers/bin/python" ] || stage 'environment of the peers' /usr/bin/python3 -m venv "$peers" >&2
for package in point-cloud-utils libigl pymeshlab open3d-cpu pyacvd 'trimesh scipy'; do
  read -ra names <<<"$package"
  stage "peer ${names[0]}" install "${names[@]}" >&2 || printf '   it goes on without %s\n' "${names[0]}" >&2
done
cd "$here"
PYTHONPATH=$root exec "$python" -m benchmarks.peers --peers-python "$peers/bin/python" "$@"
