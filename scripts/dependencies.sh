#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes what the files of a release are built with, on Debian 12: compilers and tools from the Python package index, libraries
# as static ones from their authors' archives, headers from the distribution's packages. Versions are pinned in
# scripts/dependencies.txt and scripts/requirements-release.txt. Everything goes to build/ship and is made once.
#   scripts/dependencies.sh TARGET...
#     TARGET   linux-x64 linux-arm64 windows-x64 macos-arm64 macos-x64
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

ship=$root/build/ship
tools=$ship/tools
archives=$ship/archives
table=scripts/dependencies.txt
pythons=(3.11 3.13)
mkdir -p "$archives"

# once NAME HASH COMMAND...: a stage that is done again only when what it depends on has changed.
once() {
  local stamp=$ship/stamps/$1 hash=$2 name=$1
  shift 2
  mkdir -p "$ship/stamps"
  up_to_date "$stamp" "$hash" && return
  stage "$name" "$@"
  echo "$hash" >"$stamp"
}

# rows KIND: name, suite, version, license and SHA-256 of the table's lines of this kind.
rows() { awk -v kind="$1" '$1 == kind {print $2, $3, $4, $5, $6}' "$table"; }
value() { awk -v name="$1" -v column="$2" '$2 == name {print $column}' "$table"; }

# The distribution's own mirror, with lists of both suites that touch nothing of the machine's.
write_apt_configuration() {
  local mirror keys=/usr/share/keyrings/debian-archive-keyring.gpg suite kind
  mirror=$(debian_mirror)
  [ -n "$mirror" ] || { echo "apt knows no mirror of Debian"; return 1; }
  rm -rf "$ship/apt" && mkdir -p "$ship"/apt/{lists,cache/archives}/partial || return
  for suite in bookworm trixie; do
    for kind in deb deb-src; do echo "$kind [signed-by=$keys] $mirror $suite main"; done
  done >"$ship/apt/sources.list"
  cat >"$ship/apt/apt.conf" <<EOF
Dir::Etc::sourcelist "$ship/apt/sources.list";
Dir::Etc::sourceparts "-";
Dir::State::lists "$ship/apt/lists";
Dir::Cache "$ship/apt/cache";
Acquire::Languages "none";
APT::Sandbox::User "root";
EOF
  APT_CONFIG=$ship/apt/apt.conf apt-get -q update
}

# download ADDRESS FILE HASH: into the archives.
download() {
  [ -f "$archives/$2" ] || APT_CONFIG=$ship/apt/apt.conf /usr/lib/apt/apt-helper download-file "$1" "$archives/$2" "$3"
}

fetch_sources() {
  local name suite version hash address file
  while read -r name suite version _ hash; do
    read -r address file < <(APT_CONFIG=$ship/apt/apt.conf apt-get source --print-uris -qq --download-only "$name/$suite" |
      grep -E "${name}_[^ ]*orig\.tar\.[a-z]+ " | cut -d ' ' -f 1,2)
    [[ ${file:-} == "${name}_${version}.orig.tar."* ]] ||
      { echo "$suite has ${file:-no archive of $name}, $table asks for $version"; return 1; }
    download "${address//\'/}" "$file" "SHA256:$hash" || return
    rm -rf "${ship:?}/source/$name" && mkdir -p "$ship/source/$name" &&
      tar -C "$ship/source/$name" --strip-components=1 -xf "$archives/$file" || return
  done < <(rows source)
}

fetch_headers() {
  local name suite version address file hash
  rm -rf "$ship/headers" && mkdir "$ship/headers" || return
  while read -r name suite version _; do
    read -r address file _ hash < <(APT_CONFIG=$ship/apt/apt.conf apt-get download --print-uris -qq "$name/$suite")
    [[ ${file:-} == "${name}_${version}"[-+]* ]] ||
      { echo "$suite has ${file:-no package $name}, $table asks for $version"; return 1; }
    download "${address//\'/}" "$file" "$hash" && dpkg -x "$archives/$file" "$ship/headers/$name" || return
  done < <(rows headers)
}

install_tools() {
  rm -rf "$tools" && pip_install "$python" --target "$tools" -r scripts/requirements-release.txt
}

# A static library exports nothing: a module would show what is in it.
mend_onetbb() {
  sed -i '/tbb\.rc/d' src/tbb/CMakeLists.txt &&
    sed -i 's/\(#define __TBB_EXPORT\) .*/\1/' include/oneapi/tbb/detail/_export.h
}

# Two operators that print, which newer compilers look into; exports, of which a static library needs none; and flags for
# Microsoft's own compiler, which another one for Windows does not take.
mend_embree() {
  sed -i 's/<< a\.u\.lower << ", " << a\.u\.upper <</<</' kernels/subdiv/bezier_curve.h &&
    sed -i 's/<< line\.v0 <</<</' kernels/geometry/pointi.h &&
    sed -i 's/\(# *define dll_export\) .*/\1/' common/sys/platform.h &&
    sed -i 's/^IF (WIN32)/IF (MSVC)/' common/cmake/clang.cmake &&
    sed -i '/^ *embree\.rc$/d; /embree\.rc/d' kernels/CMakeLists.txt
}

mend_sources() {
  (cd "$ship/source/embree" && mend_embree) &&
    (cd "$ship/source/onetbb" && mend_onetbb)
}

fetch() {
  write_apt_configuration && fetch_sources && fetch_headers && mend_sources
}

# What a target is to the compiler: the oldest system that its files run on, and the plainest processor.
zig_flags() {
  case $1 in
    linux-x64) echo "-target x86_64-linux-gnu.2.28 -mcpu=x86_64 -I$ship/shim" ;;
    linux-arm64) echo "-target aarch64-linux-gnu.2.28 -mcpu=generic -I$ship/shim" ;;
    windows-x64) echo '-target x86_64-windows-gnu -mcpu=x86_64 -D_USE_MATH_DEFINES' ;;
    macos-arm64) echo '-target aarch64-macos.11.0 -include float.h' ;;
    macos-x64) echo '-target x86_64-macos.11.0 -mcpu=x86_64 -include float.h' ;;
    *) return 1 ;;
  esac
}

# wrapper NAME COMMAND: a program of the compiler under the name that others look for. One that is as it was keeps its
# date, by which ccache knows a compiler.
wrapper() {
  local text
  text=$(printf '#!/bin/sh\n# %s\nexport ZIG_GLOBAL_CACHE_DIR=%q ZIG_LOCAL_CACHE_DIR=%q\nexec %q %s "$@"' \
    "$(tail -n 1 scripts/requirements-release.txt)" "$ship/zig-cache" "$ship/zig-cache" \
    "$tools/ziglang/zig" "$2")
  up_to_date "$bin/$1" "$text" || { echo "$text" >"$bin/$1" && chmod +x "$bin/$1"; }
}

make_wrappers() {
  local target=$1 bin=$ship/$1/bin flags
  flags=$(zig_flags "$target") && mkdir -p "$bin" "$ship/shim/sys" || return
  # The function is glibc 2.32's: for older ones there may always be other threads.
  echo 'static const char __libc_single_threaded = 0;' >"$ship/shim/sys/single_threaded.h"
  wrapper clang "cc $flags" && wrapper clang++ "c++ $flags" && wrapper ar ar && wrapper ranlib ranlib &&
    wrapper rc rc && wrapper dlltool dlltool
}

link_headers() {
  local prefix=$ship/$1/prefix name
  rm -rf "$prefix" && mkdir -p "$prefix" || return
  while read -r name _; do
    [[ $name == libpython* ]] || cp -a "$ship/headers/$name/." "$prefix" || return
  done < <(rows headers)
}

# The names of Python's functions and data for Windows, from the static library of the same version.
make_python_library() {
  local version=$1 folder=$2 digits=${1/./} archive
  archive=$(find "$ship/headers/libpython$version-dev" -name "libpython$version.a" -print -quit)
  {
    printf 'LIBRARY python%s.dll\nEXPORTS\n' "$digits"
    nm --defined-only --extern-only "$archive" 2>/dev/null |
      awk '$3 ~ /^_?Py/ {print "  " $3 ($2 ~ /[BDRVG]/ ? " DATA" : "")}' | sort -u
  } >"$folder/python$digits.def" &&
    "$ship/windows-x64/bin/dlltool" -m i386:x86-64 -d "$folder/python$digits.def" -l "$folder/python$digits.lib"
}

# macOS is given Linux's configuration: what the headers ask of it is the same on both, 64 bits and 4-byte wide characters.
make_python() {
  local target=$1 version folder package source
  for version in "${pythons[@]}"; do
    folder=$ship/$target/python$version source=$ship/source/python$version
    package=$ship/headers/libpython$version-dev/usr/include
    rm -rf "$folder" && mkdir -p "$folder" && cp -r "$source/Include" "$folder/include" || return
    case $target in
      windows-*)
        cp "$source"/PC/pyconfig.h* "$folder/include/pyconfig.h" && make_python_library "$version" "$folder" || return
        ;;
      *) cp "$package/x86_64-linux-gnu/python$version/pyconfig.h" "$folder/include" || return ;;
    esac
  done
}

# build TARGET NAME SOURCE OPTION...: with the target's compiler, into its prefix; of a project that says so one component.
build() {
  local target=$1 name=$2 source=$3 folder=$ship/$1/build-$2
  shift 3
  rm -rf "$folder"
  cmake -S "$source" -B "$folder" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
    -DCMAKE_TOOLCHAIN_FILE="$root/cmake/toolchains/zig.cmake" -DDAPPLE_TARGET="$target" \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_POLICY_VERSION_MINIMUM=3.5 \
    -DCMAKE_C_COMPILER_LAUNCHER="$launcher" -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" "$@" &&
    cmake --build "$folder" -j "$(build_jobs)" &&
    DESTDIR=$ship/$target/prefix cmake --install "$folder" --prefix /usr ${component:+--component "$component"} &&
    rm -rf "$folder"
}

build_onetbb() {
  build "$1" onetbb "$ship/source/onetbb" -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF \
    -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON -DTBB_ENABLE_IPO=OFF
}

build_openmesh() { build "$1" openmesh "$root/cmake/openmesh" -DOPENMESH_SOURCE="$ship/source/openmesh"; }
build_googletest() { build "$1" googletest "$ship/source/googletest" -DBUILD_GMOCK=OFF -DCMAKE_CXX_FLAGS=-w; }

# Triangles and point queries for one instruction set: a fifteenth of the whole. Curves are compiled even if they are off,
# for minutes. Configuring writes into the sources, and finds out that a processor is an Arm after it has chosen flags.
build_embree() {
  local target=$1 copy=$ship/$1/source-embree options=() name component=devel
  for name in QUAD CURVE SUBDIVISION USER INSTANCE GRID POINT; do options+=("-DEMBREE_GEOMETRY_$name=OFF"); done
  for name in SSE42 AVX AVX2 AVX512 NEON2X; do options+=("-DEMBREE_ISA_$name=OFF"); done
  case $target in
    *arm64) options+=(-DEMBREE_ARM=ON -DEMBREE_ISA_NEON=ON) ;;
    *) options+=(-DEMBREE_ISA_SSE2=ON) ;;
  esac
  rm -rf "$copy" && cp -r "$ship/source/embree" "$copy" &&
    sed -i '/curve_intersector_virtual/d' "$copy/kernels/CMakeLists.txt" &&
    build "$target" embree "$copy" -DEMBREE_STATIC_LIB=ON -DEMBREE_TUTORIALS=OFF -DEMBREE_ISPC_SUPPORT=OFF \
      -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_RAY_PACKETS=OFF -DEMBREE_FILTER_FUNCTION=OFF -DEMBREE_MAX_ISA=NONE \
      -DEMBREE_IGNORE_CMAKE_CXX_FLAGS=OFF -DEMBREE_TESTING_INTENSITY=0 -DBUILD_TESTING=OFF "${options[@]}" &&
    rm -rf "$copy"
}

# The texts of the licenses of what is linked, one file each.
collect_licenses() {
  local folder=$ship/licenses name
  rm -rf "$folder" && mkdir "$folder" || return
  for name in onetbb/LICENSE.txt embree/LICENSE.txt openmesh/LICENSE; do
    cp "$ship/source/$name" "$folder/${name%%/*}.txt" || return
  done
  for name in libcgal-dev libboost1.83-dev libeigen3-dev libnanoflann-dev pybind11-dev; do
    cp "$ship/headers/$name/usr/share/doc/$name/copyright" "$folder/$name.txt" || return
  done
  cp "$tools/ziglang/lib/libcxx/LICENSE.TXT" "$folder/libcxx.txt"
  cp "$tools/ziglang/lib/libc/mingw/COPYING" "$folder/mingw-w64.txt"
}

targets=("$@")
[ "${#targets[@]}" -gt 0 ] || fail 'scripts/dependencies.sh needs targets; see its head'
for target in "${targets[@]}"; do
  zig_flags "$target" >/dev/null || fail "there is no target $target; see the head of scripts/dependencies.sh"
done
[ "$(system_name)" = debian-12 ] || fail "this system is $(system_name); releases are built on Debian 12 (bookworm)"
scripts/setup.sh --tools
need_packages ccache cmake ninja-build binutils
mkdir -p build/ccache
launcher="$(command -v cmake);-E;env;CCACHE_DIR=$root/build/ccache;CCACHE_MAXSIZE=2G;$(command -v ccache)"

once release-tools "$(<scripts/requirements-release.txt)" install_tools
once fetch "$(hash_of "$(<$table)" "$(declare -f fetch_sources mend_sources mend_embree mend_onetbb)")" fetch
once licenses "$(<$table)" collect_licenses
for target in "${targets[@]}"; do
  base=$(hash_of "$root" "$(<$table)" "$(<scripts/requirements-release.txt)" "$(zig_flags "$target")" \
    "$(<cmake/toolchains/zig.cmake)" "$(declare -f wrapper build)")
  once "$target-compiler" "$base" make_wrappers "$target"
  once "$target-headers" "$base" link_headers "$target"
  once "$target-python" "$(hash_of "$base" "$(declare -f make_python make_python_library)")" make_python "$target"
  for name in onetbb openmesh googletest embree; do
    once "$target-$name" "$(hash_of "$base" "$(declare -f "build_$name" mend_embree mend_onetbb)" "$(<cmake/openmesh/CMakeLists.txt)")" "build_$name" "$target"
  done
done
