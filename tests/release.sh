#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests the Linux files of a release where nothing of Dapple was built: in bare systems, each in a folder of build/roots.
#   tests/release.sh [FOLDER] [--all] [--only debian-11|debian-12|debian-13]      FOLDER: build/ship/release
#     debian-11   an old C library: both wheels in Pythons that are built there, as that system has only 3.9
#     debian-12   the wheel in the system's Python 3.11; the extension in Blender 4.5 (the module bpy)
#     debian-13   the wheel in the system's Python 3.13; the extension in Blender 5.2 (bpy) and in the system's own, 4.3
# With --all every Blender test is run, which takes long, else those that meet what packing could lose or change.
# It writes what ran into FOLDER/platforms.md; what others have written there stays. As root, on Debian 12 or 13; the first
# run fetches about 2 GB and builds two Pythons, what it has made is kept.
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

release=$root/build/ship/release only='' depth=()
while [ $# -gt 0 ]; do
  case $1 in
    --all) depth=(--all) ;;
    --only) only=${2:?--only needs debian-11, debian-12 or debian-13}; shift ;;
    -*) fail "unknown option $1; see the head of tests/release.sh" ;;
    *) release=$(cd "$here" && realpath -- "$1") ;;
  esac
  shift
done
case $only in
  '' | debian-11 | debian-12 | debian-13) ;;
  *) fail "--only $only: it must be debian-11, debian-12 or debian-13" ;;
esac
[ "$(id -u)" -eq 0 ] || fail 'only root can make and enter other systems'
zip=$(find "$release" -maxdepth 1 -name 'dapple-*-linux-x64.zip')
[ -f "$zip" ] || fail "$release has no dapple-*-linux-x64.zip: scripts/release.sh makes it"

roots=$root/build/roots
# What ran, counted, for these files.
results=$roots/results/$(cat "$zip" "$release"/wheels/*linux*.whl | sha256sum | cut -c 1-16)
mkdir -p "$results"
need_packages debootstrap debian-archive-keyring python3-venv
failed=()
mapfile -t needed < <(PYTHONPATH=tests /usr/bin/python3 -c 'import wheel; print(*wheel.NEEDED, sep="\n")')

# inside ROOT COMMAND...: in a root, where the release lies in /release and fetched wheels in /wheels.
inside() {
  local at=$roots/$1
  shift
  mkdir -p "$at/release" "$at/wheels" "$roots/wheels"
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --kill-child bash -ec '
    mount -t proc proc "$1/proc" && mount --rbind /dev "$1/dev" && mount --rbind /sys "$1/sys"
    mount --bind "$2" "$1/release" && mount --bind "$3" "$1/wheels"
    at=$1
    shift 3
    exec chroot "$at" "$@"' _ "$at" "$release" "$roots/wheels" \
    env -i HOME=/root LC_ALL=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    DEBIAN_FRONTEND=noninteractive PIP_NO_INDEX=1 PIP_FIND_LINKS=/wheels PIP_ROOT_USER_ACTION=ignore "$@"
}

bootstrap() {
  local at=$roots/$1 suite=$2 from
  from=$(debian_mirror)
  rm -rf "$at" "$at.part"
  debootstrap --variant=minbase "$suite" "$at.part" "$from" || return
  # Newer sources, as Debian 11 has no Python that Dapple supports.
  printf "deb%s $from %s main\n" '' "$suite" -src bookworm -src trixie >"$at.part/etc/apt/sources.list"
  ln -sf /proc/self/mounts "$at.part/etc/mtab"
  mv "$at.part" "$at"
}
add_packages() {
  local name=$1
  shift
  inside "$name" apt-get -q update && inside "$name" apt-get -q install -y --no-install-recommends "$@"
}

# need_root NAME SUITE PACKAGE...
need_root() {
  local name=$1 suite=$2 hash
  shift 2
  hash=$(hash_of "$suite" "$@")
  [ -d "$roots/$name" ] || stage "root $name" bootstrap "$name" "$suite"
  up_to_date "$roots/$name.stamp" "$hash" || stage "packages of $name" add_packages "$name" "$@"
  echo "$hash" >"$roots/$name.stamp"
}

# pinned PYTHON: the lines of scripts/constraints.txt that hold for it, which pip asks the Python that runs.
pinned() {
  "$roots/tools/bin/python" - "$1" "$constraints" <<'END'
import sys
from pip._vendor.packaging.requirements import Requirement

version, constraints = sys.argv[1:]
python = {"python_version": version, "python_full_version": f"{version}.0"}
for line in open(constraints):
    text = line.partition("#")[0].strip()
    if text and (not (pin := Requirement(text)).marker or pin.marker.evaluate(python)):
        print(f"{pin.name}{pin.specifier}")
END
}

# fetch PYTHON: wheels of what the tests need, for systems with a C library of 2.28 or newer.
fetch() {
  local version=$1 platforms=(manylinux{1,2014,_2_5,_2_12,_2_17,_2_24,_2_27,_2_28}_x86_64 any)
  pinned "$version" >"$roots/constraints-$version.txt" &&
    "$roots/tools/bin/python" -m pip download -q --dest "$roots/wheels" --only-binary=:all: --implementation cp \
      -c "$roots/constraints-$version.txt" --python-version "$version" "${platforms[@]/#/--platform=}" bpy "${needed[@]}"
}
need_wheels() {
  local stamp=$roots/wheels.stamp hash
  [ -x "$roots/tools/bin/python" ] || stage pip /usr/bin/python3 -m venv "$roots/tools"
  hash=$(hash_of "$(<"$constraints")" "${needed[@]}")
  ! up_to_date "$stamp" "$hash" || return 0
  rm -rf "$roots/wheels"
  stage 'wheels for Python 3.11' fetch 3.11
  stage 'wheels for Python 3.13' fetch 3.13
  echo "$hash" >"$stamp"
}

# build_python VERSION SUITE: CPython in debian-11 from the source package of a newer Debian.
build_python() {
  local source=/src/python$1
  inside debian-11 sh -ec "mkdir -p $source && cd $source && apt-get -q source --download-only python$1/$2 &&
    tar --strip-components=1 -xf python$1_*.orig.tar.?z && ./configure -q --disable-test-modules --prefix=/opt/python$1 &&
    make -s -j$(build_jobs) && make -s install"
}

need_python() {
  [ -x "$roots/debian-11/opt/python$1/bin/python$1" ] || stage "Python $1 for debian-11" build_python "$@"
}

# The checkout as it is, without anything that was built.
copy_checkout() {
  local at=$roots/$1/dapple
  rm -rf "$at" && mkdir -p "$at"
  git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$at"
}

# test_wheel ROOT VERSION PYTHON: the Python tests on the wheel that this Python takes.
test_wheel() {
  inside "$1" env PYTEST_ADDOPTS="--junitxml=/dapple/build/python$2.xml" "$3" /dapple/tests/wheel.py /release/wheels
}

# test_extension ROOT: the Blender tests on the extension, in the module bpy and in the root's own Blender.
test_extension() {
  inside "$1" sh -ec "rm -rf /venv && python3 -m venv /venv && mkdir -p /dapple/build && ln -s /venv /dapple/build/venv
    /venv/bin/pip install -q -c /dapple/scripts/constraints.txt bpy ${needed[*]}" &&
    inside "$1" /dapple/tests/run.sh "${depth[@]}" --only package --zip "/release/${zip##*/}"
}

# run_tests NAME RESULT=REPORTS... -- COMMAND...: keeps what JUnit reports below a root's build folder say.
run_tests() {
  local name=$1 kept=() one said
  shift
  while [ "$1" != -- ]; do kept+=("$1") && shift; done
  shift
  stage "$name" "$@" || failed+=("$name")
  for one in "${kept[@]}"; do
    # shellcheck disable=SC2086
    said=$("$roots/tools/bin/python" tests/tally.py --sentence "$roots"/${one#*=})
    echo "   ${one%%=*}: $said"
    echo "$said" >"$results/${one%%=*}"
  done
}

debian_11() {
  local version
  need_root debian-11 bullseye gcc libc6-dev make zlib1g-dev libssl-dev libffi-dev libbz2-dev liblzma-dev xz-utils
  need_python 3.11 bookworm
  need_python 3.13 trixie
  copy_checkout debian-11
  for version in 3.11 3.13; do
    run_tests "debian-11: wheel for Python $version" "wheel-11-$version=debian-11/dapple/build/python$version.xml" -- \
      test_wheel debian-11 "$version" "/opt/python$version/bin/python$version"
  done
}

debian_12() {
  need_root debian-12 bookworm python3-venv "${bpy_packages[@]}"
  copy_checkout debian-12
  run_tests 'debian-12: wheel for Python 3.11' 'wheel-12=debian-12/dapple/build/python3.11.xml' -- \
    test_wheel debian-12 3.11 python3
  run_tests 'debian-12: extension' 'blender-4.5=debian-12/dapple/build/reports/2-*.xml' -- test_extension debian-12
}

debian_13() {
  need_root debian-13 trixie python3-venv blender python3-numpy xvfb xauth "${bpy_packages[@]}"
  copy_checkout debian-13
  run_tests 'debian-13: wheel for Python 3.13' 'wheel-13=debian-13/dapple/build/python3.13.xml' -- \
    test_wheel debian-13 3.13 python3
  run_tests 'debian-13: extension' 'blender-5.2=debian-13/dapple/build/reports/2-*.xml' \
    'blender-4.3=debian-13/dapple/build/reports/3-*.xml' -- test_extension debian-13
}

# told NAME RESULT...: those that there are.
told() {
  local text=''
  while [ $# -gt 0 ]; do
    [ ! -f "$results/$2" ] || text+="${text:+, }$1: $(<"$results/$2")"
    shift 2
  done
  printf '%s' "$text"
}

need_wheels
for name in ${only:-debian-11 debian-12 debian-13}; do "${name/-/_}"; done
line() { "$roots/tools/bin/python" tests/platforms.py "$release/platforms.md" "$@"; }
line 'Linux x64, Python 3.11' yes "$(told 'Debian 11' wheel-11-3.11 'Debian 12' wheel-12)" "$(told 4.5 blender-4.5)"
line 'Linux x64, Python 3.13' yes "$(told 'Debian 11' wheel-11-3.13 'Debian 13' wheel-13)" \
  "$(told 4.3 blender-4.3 5.2 blender-5.2)"
cat "$release/platforms.md"
[ "${#failed[@]}" -eq 0 ] || fail "failed: $(printf '%s; ' "${failed[@]}")"
