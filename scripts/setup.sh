#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a bare Debian 12 or 13 ready: packages, build/venv, the release build of the library, the Python package.
# What is already there is kept, so a second run takes about a second.
#   scripts/setup.sh [--dev | --tests | --tools]
#     (none)    only what the examples need: library, bindings, Blender as a Python module
#     --dev     also the tools of tests, checks and benchmarks; on Debian 13 the real Blender and a virtual display
#     --tests   --dev, and builds tests, fuzz targets and benchmarks
#     --tools   --dev without building anything
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

option=${1:-}
case $option in
  '' | --dev | --tests | --tools) ;;
  *) fail "unknown option $option; see the head of scripts/setup.sh" ;;
esac
begun=$(date +%s)
system=$(system_name)
packages=(
  ca-certificates git g++ ccache cmake ninja-build python3 python3-venv python3-dev
  libcgal-dev libembree-dev libopenmesh-dev pybind11-dev libtbb-dev libeigen3-dev libnanoflann-dev
  "${bpy_packages[@]}"
)
dev_packages=(libgtest-dev libbenchmark-dev)
case $system in
  debian-12) ;;
  # The real Blender, and a virtual display for the tests that need its window.
  debian-13) dev_packages+=(blender python3-numpy xvfb xauth) ;;
  *) fail "this system is $system; supported are Debian 12 (bookworm) and Debian 13 (trixie)" ;;
esac
[ -z "$option" ] || packages+=("${dev_packages[@]}")
# A folder that has the tools once keeps them.
tools=''
if [ -n "$option" ] || [ -x "$venv/bin/pytest" ]; then tools=1; fi
[ "$(uname -m)" = x86_64 ] || fail "this machine is $(uname -m); Blender's Python module needs x86_64"

create_venv() {
  [ ! -L "$venv" ] || fail 'build/venv is a link: making it anew would empty what it points to'
  /usr/bin/python3 -m venv --clear "$venv" &&
    pip_install "$python" -r scripts/requirements.txt
}

install_tools() { pip_install "$python" -r scripts/requirements-tools.txt; }

# Both systems check types against the numpy of both: the wheel for the other Python is no part of build/venv.
unpack_types() {
  local version at
  rm -rf build/types
  for version in 3.11 3.13; do
    at=$(numpy_types "$version")
    "$python" -m pip install --no-input --no-deps --target "$at" --only-binary=:all: --python-version "$version" \
      "numpy==$(numpy_of "$version")" && find "$at" -name '*.so*' -delete || return
  done
}

configure() {
  # A new folder: CMake's --fresh would keep objects made by another compiler.
  rm -rf build/release &&
    cmake --preset release -DDAPPLE_PYTHON_INSTALL_DIR="$site_packages" -DDAPPLE_TESTS=OFF -DDAPPLE_BENCHMARKS=OFF
}
configure_tests() { cmake -DDAPPLE_TESTS=ON -DDAPPLE_BENCHMARKS=ON build/release; }

exec 9>build/setup.lock
flock -n 9 || { echo '== waiting for another set-up of this folder'; flock 9; }

need_packages "${packages[@]}"

python_version=$(/usr/bin/python3 -c 'import platform; print(platform.python_version())')
venv_hash=$(hash_of "$root" "$python_version" "$(<scripts/requirements.txt)" "$(<"$constraints")")
if ! up_to_date "$venv/.stamp" "$venv_hash"; then
  stage "virtual environment" create_venv
  echo "$venv_hash" >"$venv/.stamp"
fi
tools_hash=$(hash_of "$venv_hash" "$(<scripts/requirements-tools.txt)")
if [ -n "$tools" ] && ! up_to_date "$venv/.tools" "$tools_hash"; then
  stage "tools" install_tools
  stage "types of numpy" unpack_types
  echo "$tools_hash" >"$venv/.tools"
fi
[ "$option" != --tools ] || exit 0

site_packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
configure_hash=$(hash_of "$root" "$system" "$python_version" "$(<CMakePresets.json)" "$(cmake --version)")
if ! up_to_date build/release/.stamp "$configure_hash"; then
  stage 'configure' configure
  echo "$configure_hash" >build/release/.stamp
fi
# Tests and benchmarks would take most of the time, for someone who wants to see a first picture.
targets=(dapple _native)
if [ "$option" = --tests ]; then
  targets=(all)
  grep -q '^DAPPLE_TESTS:BOOL=ON' build/release/CMakeCache.txt || stage 'configure tests' configure_tests
fi
stage 'build' cmake --build build/release -j "$(build_jobs)" --target "${targets[@]}"
stage 'install the Python package' cmake --install build/release --component python
# Modules that were renamed or removed would still be imported.
comm -23 <(find "$site_packages/dapple3d" -type f -not -path '*/__pycache__/*' | sort) \
  <(sort build/release/install_manifest_python.txt) | xargs -r -d '\n' rm
printf '== ready after %d s\n' "$(($(date +%s) - begun))"
