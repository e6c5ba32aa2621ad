#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Compiles for 64-bit ARM with warnings as errors, and runs what it has compiled in an emulator (qemu-user), on the
# libraries of a Debian of that architecture that is unpacked into build/aarch64 and never started. The kernels first,
# alone: what NEON computes against what this machine does. Then everything: the tests, the samples, and the tools on the
# bundled images. Kept in build/aarch64: the first run takes most of an hour on two cores, the next ones some ten minutes.
#
# Usage: test/aarch64.sh [--short]     --short compiles and runs the kernels only: half a minute
set -eu
cd "$(dirname "$0")/.."
short=no
[ "${1:-}" = --short ] && short=yes

tools/install_dependencies.sh aarch64
work=$PWD/build/aarch64
root=$work/root
toolchain=$PWD/test/aarch64/toolchain.cmake
mkdir -p "$work"
logged() {      # logged LOG COMMAND...: what it says is shown only if it fails
  log=$1; shift
  "$@" >"$log" 2>&1 || { cat "$log"; exit 1; }
}

# The kernels of the baseline: for NEON, for this processor, and without vectors.
columns=""
compute() {     # compute COLUMN CMAKE_OPTION...
  column=$1; shift
  directory=$work/kernels/$column
  logged "$directory.log" cmake -S test/aarch64 -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@"
  logged "$directory.log" cmake --build "$directory"
  columns="$columns $directory.txt"
}
mkdir -p "$work/kernels"
compute host
"$work/kernels/host/kernels" >"$work/kernels/host.txt"
compute one-lane -DCMAKE_CXX_FLAGS="-U__SSE2__ -U__aarch64__"
"$work/kernels/one-lane/kernels" >"$work/kernels/one-lane.txt"
for compiler in clang++ clang++-14; do
  command -v $compiler >/dev/null || continue
  compute $compiler -DCMAKE_CXX_COMPILER=$compiler
  "$work/kernels/$compiler/kernels" >"$work/kernels/$compiler.txt"
done
compute neon -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_EXE_LINKER_FLAGS=-static
qemu-aarch64 "$work/kernels/neon/kernels.aarch64" >"$work/kernels/neon.txt"
# shellcheck disable=SC2086  # a list of files
logged "$work/kernels.txt" /usr/bin/python3 -B test/agreement/compare.py $columns
tail -n 2 "$work/kernels.txt"
# Two doubles an instruction, or the compiler has fallen back to one.
object=$(find "$work/kernels/neon" -name 'kernels_baseline.*.o')
aarch64-linux-gnu-objdump -d --no-show-raw-insn "$object" >"$work/kernels/neon.s"
roots=$(grep -c 'fsqrt[[:space:]]*v[0-9]*\.2d' "$work/kernels/neon.s") || true
single=$(grep -c 'fsqrt[[:space:]]*d' "$work/kernels/neon.s") || true
if [ "$roots" = 0 ] || [ "$single" != 0 ]; then
  echo "FAILED: $roots square roots of two lanes, $single of one: see modules/refract/src/simd/lanes.hpp" >&2
  exit 1
fi
echo "passed: the kernels on NEON"
[ $short = no ] || exit 0

if [ ! -e "$root.complete" ]; then
  echo "Unpacking the libraries of the other architecture"
  logged "$root.log" test/aarch64/make_root.sh "$root"
  touch "$root.complete"
fi

launcher=""
command -v ccache >/dev/null && launcher="-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
# shellcheck disable=SC2086  # an option or none
logged "$work/build.log" cmake -S . -B "$work/build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DREFRACT_ROOT="$root" \
  -DREFRACT_WERROR=ON $launcher
cmake --build "$work/build"

# Whoever runs a tool, the tests too, gets a script that starts the emulator, whatever his PATH.
bin=$work/build/bin
for program in "$bin"/*.aarch64; do
  printf '#!/bin/sh\nexec %s -L "%s" -0 "$0" "$0.aarch64" "$@"\n' "$(command -v qemu-aarch64)" "$root" >"${program%.aarch64}"
  chmod +x "${program%.aarch64}"
done

failed=0
run() {         # run NAME COMMAND...: its output, kept for the counts
  name=$1; shift
  echo "$name:"
  { "$@" 2>&1 || echo "FAILED: $name"; } | tee "$work/$name.txt"
  ! grep -q "^FAILED: $name" "$work/$name.txt" || failed=$((failed + 1))
}
# As with the sanitizers: what is slow by design is left out; and the tests that make thousands of threads, as the emulator
# (qemu-user 7.2) keeps the memory of each that has ended.
run refract_tests "$bin/refract_tests" '~[slow]~[.]~[threads]'
run refract_tools_tests "$bin/refract_tools_tests" '~[.]'
run opencv_test_refract "$bin/opencv_test_refract" --gtest_brief=1
for sample in "$bin"/sample_*.aarch64; do
  run "$(basename "$sample" .aarch64)" "${sample%.aarch64}"
done
rm -rf "$work/main_job"
mkdir "$work/main_job"
cp -r samples/data/stereo "$work/main_job/data"
run main_job env -C "$work/main_job" PATH="$bin:$PATH" "$PWD/test/main_job.sh"

echo
tail -n 2 "$work/kernels.txt"
for name in refract_tests refract_tools_tests opencv_test_refract; do
  echo "$name: $(grep -E '^(All tests passed|test cases:|\[  PASSED|\[  FAILED)' "$work/$name.txt")"
done
echo "$failed programs failed on aarch64"
[ $failed = 0 ]
