#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the extension that Blender installs from disk, the native package and the node groups as assets in it:
# build/package/dapple-VERSION-PLATFORM.zip. The same build gives the same bytes. It suits Blenders of the Python that it
# was made with: 3.11 on Debian 12 (as Blender 4.5), 3.13 on Debian 13 (as Blender 5.2); --wheel adds the other one.
#   scripts/package.sh [--build FOLDER] [--wheel FILE]... [--to FOLDER]
#     --build   package this build as it is; otherwise scripts/setup.sh makes build/release
#     --wheel   put this wheel in too: one made for another Python, from extension/wheels beside its zip
#     --to      write there instead of build/package
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
. scripts/extension.sh

platform=linux-x64
build='' others=() to=$root/build/package
while [ $# -gt 0 ]; do
  case $1 in
    --build) build=$(cd "$here" && realpath -- "${2:?--build needs a folder}") ;;
    --wheel) others+=("$(cd "$here" && realpath -- "${2:?--wheel needs a file}")") ;;
    --to) to=$(cd "$here" && realpath -m -- "${2:?--to needs a folder}") ;;
    *) fail "unknown option $1; see the head of scripts/package.sh" ;;
  esac
  shift 2
done
[ ! -e "$to/extension" ] || [ -f "$to/extension/blender_manifest.toml" ] ||
  fail "$to/extension is in the way: --to needs a folder that only this script writes to"
[ "$(uname -sm)" = 'Linux x86_64' ] || fail "this machine is $(uname -sm); packages are made for Linux x86_64"

if [ -z "$build" ]; then
  scripts/setup.sh --dev
  build=$root/build/release
fi
python_tag=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
for other in "${others[@]}"; do
  [[ ${other##*/} != *-"$python_tag"-* ]] || fail "${other##*/}: there is another wheel for $python_tag"
done

umask 022
export SOURCE_DATE_EPOCH=315532800 # the first day that a zip can hold, so that contents alone decide the bytes
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Packages whose code is in the module or beside it: their licenses travel along.
bundled=(libboost-dev libcgal-dev libeigen3-dev libembree-dev libgmp10 libnanoflann-dev libopenmesh-dev libtbb-dev
  pybind11-dev)

stage_files() {
  DESTDIR=$work/installed cmake --install "$build" --component python || return
  local module
  module=$(find "$work/installed" -name '_native.*.so' -print -quit)
  [ -n "$module" ] || { echo "$build has no Python package: configure it with DAPPLE_PYTHON=ON"; return 1; }
  mkdir -p "$work/tree" && mv "${module%/*}" "$work/tree/dapple3d"
}

build_wheel() {
  local licenses=() name
  for name in "${bundled[@]}"; do licenses+=("/usr/share/doc/$name/copyright"); done
  mkdir "$work/linux" &&
    "$python" scripts/package.py describe "$work/tree" "$version" "${licenses[@]}" &&
    wheel pack "$work/tree" --dest-dir "$work/linux" &&
    auditwheel repair --wheel-dir "$work/wheels" "$work"/linux/*.whl
}

# Blender exports rtc* functions of its own: the wheel must neither use nor offer functions of these names, and its
# module finds in its private Embree all that it uses (native/python/CMakeLists.txt).
check_wheel() {
  local files used offered
  "$python" -m zipfile -e "$work"/wheels/*.whl "$work/unpacked" || return
  mapfile -t files < <(find "$work/unpacked" -name '*.so*')
  if nm -D "${files[@]}" | grep -E ' rtc[A-Z]'; then
    echo 'the wheel uses or offers functions of the names above, which Blender has too'
    return 1
  fi
  used=$(nm -D --undefined-only "$work"/unpacked/dapple3d/_native.*.so | grep -o 'dapple_rtc.*' | sort) || {
    echo 'the module uses no private Embree'
    return 1
  }
  offered=$(nm -D --defined-only "$work/unpacked/dapple3d/libdapple_embree.so" | grep -o 'dapple_rtc.*' | sort)
  comm -23 <(echo "$used") <(echo "$offered") >"$work/missing"
  [ ! -s "$work/missing" ] || { echo "the private Embree lacks: $(<"$work/missing")"; return 1; }
}

put_in_place() {
  rm -rf "$to/extension" && mkdir -p "$to" && mv "$work/extension" "$work/$zip" "$to"
}

stage 'stage the Python package' stage_files
version=$(PYTHONPATH=$work/tree "$python" -B -c 'import dapple3d; print(dapple3d.__version__)')
zip=dapple-$version-$platform.zip
stage 'build the wheel' build_wheel
stage 'check the wheel' check_wheel
stage 'build the assets' build_assets "$work/assets.blend" "$work/blender"
stage 'build the extension' build_extension "$work/extension" "$work/$zip" "$platform" "$version" "$work/assets.blend" \
  "$work"/wheels/*.whl "${others[@]}"
put_in_place
"$python" scripts/package.py show "$to/$zip"
