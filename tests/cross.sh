#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests what can be run here of programs for other systems, compiled as scripts/release.sh compiles for them, on Debian 12.
#   tests/cross.sh [PLATFORM]...     none: all of them
#     linux-x64     the tests of equal bytes, also on processors that have SSE2 (QEMU), AVX2 (QEMU) and AVX-512 (Bochs) at most
#     linux-arm64   the same, on that processor (QEMU)
#     windows-x64   all native tests, and a program of a user of the library (Wine)
# What ran is written into build/ship/release/platforms.md, where that folder is; what others have written there stays.
. "$(dirname "${BASH_SOURCE[0]}")/../scripts/common.sh"

platforms=("$@")
[ "${#platforms[@]}" -gt 0 ] || platforms=(linux-x64 linux-arm64 windows-x64)
ship=$root/build/ship
table=$ship/release/platforms.md
export WINEPREFIX=$ship/wine WINEDEBUG=-all

# configure SOURCE BUILD PLATFORM OPTION...
configure() {
  local source=$1 build=$2 platform=$3
  shift 3
  cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DDAPPLE_TARGET="$platform" \
    -DCMAKE_TOOLCHAIN_FILE="$root/cmake/toolchains/zig.cmake" "$@"
}

# build_tests PLATFORM TARGET...
build_tests() {
  local build=$ship/$1/tests
  configure . "$build" "$1" -DDAPPLE_PYTHON=OFF -DDAPPLE_BENCHMARKS=OFF -DDAPPLE_WERROR=OFF &&
    cmake --build "$build" -j "$(build_jobs)" --target "${@:2}"
}

# A project of ten lines that finds the installed library.
build_consumer() {
  local build=$ship/$1/consumer
  cmake --install "$ship/$1/tests" --component library --prefix "$build/prefix" &&
    configure tests/consumer "$build/build" "$1" -Ddapple_DIR="$build/prefix/lib/cmake/dapple" &&
    cmake --build "$build/build"
}

# run_programs NAME PLATFORM COMMAND...: the test programs of a platform that were built, each under the command. They write
# their reports where they are: to a Windows program a path from the root is none.
run_programs() {
  local name=$1 folder=$ship/$2/tests/tests/native rc=0 program
  shift 2
  rm -f "$ship/reports/$name"-*.xml
  cd "$ship/reports"
  for program in "$folder"/dapple_{,referee_,same_bytes_}tests{,.exe}; do
    [ ! -f "$program" ] || "$@" "$program" --gtest_brief=1 --gtest_output="xml:$name-${program##*/}.xml" || rc=$?
  done
  cd "$root"
  return "$rc"
}

# The program writes the points that it scatters over a cube.
run_consumer() {
  local folder=$ship/$1/consumer
  printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' >"$folder/mesh.off" &&
    wine "$folder/build/consumer.exe" "$folder/mesh.off" "$folder/points.obj" &&
    [ "$(grep -c '^v ' "$folder/points.obj")" -eq 500 ]
}

# counted NAME: "12 passed", of reports.
counted() { "$python" tests/tally.py --sentence "$ship/reports/$1"-*.xml; }

# run_tests NAME PLATFORM COMMAND...
run_tests() {
  local name=$1
  stage "$name" run_programs "${name// /-}" "${@:2}"
  echo "   $(counted "${name// /-}")"
}

run_avx512() {
  stage "$1" tests/avx512.sh "$ship/linux-x64/tests/tests/native/dapple_same_bytes_tests" \
    "$ship/reports/${1// /-}-.xml" "$root/tests/native/same_bytes.txt"
  echo "   $(counted "${1// /-}")"
}

linux_x64() {
  stage 'linux-x64 tests' build_tests linux-x64 dapple_same_bytes_tests
  run_tests 'linux-x64 bytes' linux-x64 env
  run_tests 'linux-x64 bytes with SSE2' linux-x64 qemu-x86_64 -cpu qemu64
  run_tests 'linux-x64 bytes with AVX2' linux-x64 qemu-x86_64 -cpu max
  run_avx512 'linux-x64 bytes with AVX-512'
}

linux_arm64() {
  stage 'linux-arm64 tests' build_tests linux-arm64 dapple_same_bytes_tests
  run_tests 'linux-arm64 bytes' linux-arm64 qemu-aarch64 -L /usr/aarch64-linux-gnu
}

windows_x64() {
  stage 'windows-x64 tests' build_tests windows-x64 dapple_tests dapple_referee_tests dapple_same_bytes_tests
  stage 'windows-x64 program of a user' build_consumer windows-x64
  run_tests 'windows-x64 native tests' windows-x64 wine
  stage 'windows-x64 program of a user runs' run_consumer windows-x64
  [ ! -d "${table%/*}" ] || "$python" tests/platforms.py "$table" 'Windows x64' yes \
    "Wine: $(counted windows-x64-native-tests), without Python" no
}

for platform in "${platforms[@]}"; do
  declare -F "${platform/-/_}" >/dev/null || fail "there is no platform $platform; see the head of tests/cross.sh"
done
scripts/dependencies.sh "${platforms[@]}"
need_packages wine wine64 qemu-user libc6-arm64-cross
mkdir -p "$ship/reports"
for platform in "${platforms[@]}"; do "${platform/-/_}"; done
