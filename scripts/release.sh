#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds all files of a release on Debian 12: a wheel for each platform and each Python of a Blender that is in use, an
# sdist, an extension for each platform with both wheels, and a repository of the extensions for any static server. Each
# wheel is audited (scripts/audit.py), each extension is validated by Blender's own tool. What was built before is kept in
# build/ship, so that a second run takes minutes. tests/release.sh runs the part that one machine can run.
#   scripts/release.sh [PLATFORM]...
#     PLATFORM   linux-x64 windows-x64 macos-arm64 macos-x64; none: all of them
# The files are in build/ship/release.
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
. scripts/extension.sh

platforms=("$@")
[ "${#platforms[@]}" -gt 0 ] || platforms=(linux-x64 windows-x64 macos-arm64 macos-x64)
pythons=(3.11 3.13) # of Blender 4.3 to 5.0, and of 5.1 and later
ship=$root/build/ship
release=$ship/release

# The tag of a platform's wheels: the oldest system that scripts/dependencies.sh compiles for.
wheel_tag() {
  case $1 in
    linux-x64) echo manylinux_2_28_x86_64 ;;
    windows-x64) echo win_amd64 ;;
    macos-arm64) echo macosx_11_0_arm64 ;;
    macos-x64) echo macosx_11_0_x86_64 ;;
    *) fail "there is no platform $1; see the head of scripts/release.sh" ;;
  esac
}

# build_module PLATFORM PYTHON: the Python package, into tree-PYTHON beside its build folder.
build_module() {
  local build=$ship/$1/build-$2 tree=$ship/$1/tree-$2
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE=cmake/toolchains/zig.cmake \
    -DDAPPLE_TARGET="$1" -DDAPPLE_PYTHON_VERSION="$2" -DDAPPLE_PYTHON_INSTALL_DIR=. -DDAPPLE_TESTS=OFF \
    -DDAPPLE_BENCHMARKS=OFF -DDAPPLE_WERROR=OFF &&
    cmake --build "$build" -j "$(build_jobs)" &&
    rm -rf "$tree" && DESTDIR=$tree cmake --install "$build" --prefix / --component python
}

# build_wheel PLATFORM PYTHON: from what build_module has left.
build_wheel() {
  local tree=$ship/$1/tree-$2 digits=cp${2/./}
  rm -rf "$tree"/*.dist-info
  "$python" scripts/package.py describe "$tree" "$version" "$ship"/licenses/*.txt &&
    "$python" scripts/package.py retag "$tree" "$digits-$digits-$(wheel_tag "$1")" &&
    "$python" scripts/bill_of_materials.py "$tree" "$version" &&
    wheel pack "$tree" --dest-dir "$release/wheels"
}

build_sdist() { "$python" -m build --no-isolation --sdist --outdir "$release" .; }

# build_zip PLATFORM
build_zip() {
  local folder=$ship/$1/extension
  rm -rf "$folder"
  build_extension "$folder" "$release/dapple-$version-$1.zip" "$1" "$version" "$ship/assets.blend" \
    "$release"/wheels/*-"$(wheel_tag "$1")".whl
}

# A static server with these files is a repository that Blender's preferences take by its address.
build_repository() {
  mkdir "$release/repository" &&
    cp "$release"/dapple-*.zip "$release/repository" &&
    blender_ext server-generate --repo-dir "$release/repository" --html
}

# What was built; tests/release.sh and tests/cross.sh write there what ran.
write_table() {
  local platform
  for platform in "${platforms[@]}"; do
    case $platform in
      linux-x64) line 'Linux x64, Python 3.11' && line 'Linux x64, Python 3.13' ;;
      windows-x64) line 'Windows x64' ;;
      macos-arm64) line 'macOS arm64' ;;
      macos-x64) line 'macOS x64' ;;
    esac || return
  done
}
line() { "$python" tests/platforms.py "$release/platforms.md" "$1" yes no no; }

for platform in "${platforms[@]}"; do wheel_tag "$platform" >/dev/null; done
scripts/dependencies.sh "${platforms[@]}"
scripts/setup.sh --dev

umask 022
export SOURCE_DATE_EPOCH=315532800 # the first day that a zip can hold, so that contents alone decide the bytes
version=$(sed -n 's/^project(dapple VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
rm -rf "$release" && mkdir -p "$release/wheels"
for platform in "${platforms[@]}"; do
  for number in "${pythons[@]}"; do
    stage "module for $platform, Python $number" build_module "$platform" "$number"
    stage "wheel for $platform, Python $number" build_wheel "$platform" "$number"
  done
done
stage 'audit of the wheels' "$python" scripts/audit.py "$release"/wheels/*.whl
cat build/logs/audit-of-the-wheels.log
stage 'sdist' build_sdist
stage 'assets' build_assets "$ship/assets.blend" "$ship/blender"
for platform in "${platforms[@]}"; do stage "extension for $platform" build_zip "$platform"; done
stage 'repository' build_repository
stage 'table' write_table
ls -l "$release"/*.zip "$release"/*.tar.gz
