#!/bin/bash -eu
# SPDX-License-Identifier: GPL-3.0-or-later
# What OSS-Fuzz runs in its container, and what runs anywhere else with the variables set that it sets: SRC, WORK, OUT, CXX,
# CXXFLAGS, LIB_FUZZING_ENGINE. Leaves in OUT a program for each target, its inputs, its words and the libraries it loads.

source=$SRC/dapple
build=$WORK/dapple

# The distribution's libraries were compiled with the GNU C++ library; the engine brings its own and minds neither.
flags=${CXXFLAGS//-stdlib=libc++/}

cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_CXX_FLAGS="$flags" \
  -DDAPPLE_FUZZ=ON -DDAPPLE_FUZZ_ENGINE="$LIB_FUZZING_ENGINE" -DDAPPLE_PYTHON=OFF -DDAPPLE_BENCHMARKS=OFF \
  -DDAPPLE_WERROR=OFF -DDAPPLE_INSTALL=OFF -DCMAKE_BUILD_RPATH_USE_ORIGIN=ON -DCMAKE_BUILD_RPATH='$ORIGIN/lib' \
  -DCMAKE_EXE_LINKER_FLAGS=-Wl,--disable-new-dtags
cmake --build "$build" --target dapple_fuzzers

# Programs run in a container without these packages: what they load lies beside them.
mkdir -p "$OUT/lib"
for program in "$build"/tests/fuzz/fuzz_*; do
  [ -x "$program" ] && [ -f "$program" ] || continue
  cp "$program" "$OUT"
  ldd "$program" | awk '$3 ~ /^\// {print $3}' |
    grep -vE '/(libc|libm|libdl|libpthread|librt|libresolv)\.so' | xargs -r cp -Lu -t "$OUT/lib"
done

# The kept inputs and words of each.
python3 "$source/tests/fuzz/corpus.py" unpack "$WORK/kept"
for target in "$WORK"/kept/*; do
  (cd "$target" && zip -q -r "$OUT/fuzz_$(basename "$target")_seed_corpus.zip" .)
done
for words in "$source"/tests/fuzz/*.dict; do
  cp "$words" "$OUT/fuzz_$(basename "$words")"
done
