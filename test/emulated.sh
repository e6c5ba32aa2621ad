#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Compiles for another processor with warnings as errors, and runs what it has compiled in an emulator (qemu-user), on the
# libraries of a Debian of that architecture that is unpacked into build/ARCH and never started. The kernels first, alone: what the
# vectors of that processor compute against what this machine does. Then everything: the tests, the samples, and the tools on the
# bundled images. Kept in build/ARCH: the first run takes most of an hour on two cores, the next ones some ten minutes.
#
# Usage: test/emulated.sh aarch64|powerpc64le|riscv64 [--short | --module | --tools]
#   --short compiles and runs the kernels only: half a minute; --module of the rest the library, its tests and the samples;
#   --tools the tools, their tests and the images
#   aarch64: 64-bit ARM, NEON; powerpc64le: POWER8, VSX; riscv64: RISC-V, vectors of 128 bits, the kernels only, as Debian 12 has no
#   libraries for it
set -eu
cd "$(dirname "$0")/.."
arch=${1:-}
part=${2:-all}
# How roots of two lanes and of one look there.
case $arch in
  aarch64) debian=arm64 qemu=qemu-aarch64 two='fsqrt[[:space:]]*v[0-9]*\.2d' one='fsqrt[[:space:]]*d' ;;
  powerpc64le) debian=ppc64el qemu=qemu-ppc64le two=xvsqrtdp one='xssqrtdp\|fsqrt[[:space:]]' ;;
  riscv64) debian="" qemu="qemu-riscv64 -cpu rv64,v=true,vext_spec=v1.0,vlen=128" two='vfsqrt\.v' one='fsqrt\.d' part=--short ;;
  *) part=unknown ;;
esac
case $part in
  all | --short | --module | --tools) ;;
  *) echo "usage: $0 aarch64|powerpc64le|riscv64 [--short | --module | --tools]" >&2; exit 1 ;;
esac

tools/install_dependencies.sh "$arch"
work=$PWD/build/$arch
kernels=$PWD/build/kernels      # of all architectures: what they are compared with is the same
root=$work/root
toolchain="-DCMAKE_TOOLCHAIN_FILE=$PWD/test/emulated/toolchain.cmake -DREFRACT_ARCH=$arch"
mkdir -p "$work" "$kernels"
. tools/compiler_cache.sh
logged() {      # logged LOG COMMAND...: what it says is shown only if it fails
  log=$1; shift
  "$@" >"$log" 2>&1 || { cat "$log"; exit 1; }
}

# The kernels of the baseline: for this processor, without vectors, and for the other.
columns=""
compute() {     # compute COLUMN CMAKE_OPTION...
  column=$1; shift
  directory=$kernels/$column
  # shellcheck disable=SC2086  # an option or none
  logged "$directory.log" cmake -S test/kernels -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@"
  logged "$directory.log" cmake --build "$directory"
  columns="$columns $directory.txt"
}
compute host
"$kernels/host/kernels" >"$kernels/host.txt"
compute one-lane -DCMAKE_CXX_FLAGS="-U__SSE2__ -U__aarch64__"
"$kernels/one-lane/kernels" >"$kernels/one-lane.txt"
for compiler in clang++ clang++-14; do
  command -v $compiler >/dev/null || continue
  compute $compiler -DCMAKE_CXX_COMPILER=$compiler
  "$kernels/$compiler/kernels" >"$kernels/$compiler.txt"
done
emulate() {     # emulate COLUMN CMAKE_OPTION...
  # shellcheck disable=SC2086  # lists of options
  compute "$@" $toolchain -DCMAKE_EXE_LINKER_FLAGS=-static
  $qemu "$kernels/$1/kernels.$arch" >"$kernels/$1.txt"
}
emulate "$arch"
# OpenCV's headers are the same for all of Debian's architectures. Its vectors of RISC-V have no fixed size.
[ "$arch" = riscv64 ] || emulate "$arch-universal" -DREFRACT_UNIVERSAL_INTRINSICS=ON
# shellcheck disable=SC2086  # a list of files
logged "$work/kernels.txt" /usr/bin/python3 -B test/agreement/compare.py $columns
tail -n 2 "$work/kernels.txt"
# Two doubles an instruction, or the compiler has fallen back to one.
object=$(find "$kernels/$arch" -name 'kernels_baseline.*.o')
"$arch-linux-gnu-objdump" -d --no-show-raw-insn "$object" >"$kernels/$arch.s"
roots=$(grep -c "$two" "$kernels/$arch.s") || true
single=$(grep -v "$two" "$kernels/$arch.s" | grep -c "$one") || true
if [ "$roots" = 0 ] || [ "$single" != 0 ]; then
  echo "FAILED: $roots square roots of two lanes, $single of one: see modules/refract/src/simd/lanes_compiler.hpp" >&2
  exit 1
fi
echo "passed: the kernels on $arch"
[ $part != --short ] || exit 0

if [ ! -e "$root.complete" ]; then
  echo "Unpacking the libraries of the other architecture"
  logged "$root.log" test/emulated/make_root.sh "$root" "$debian" "$arch-linux-gnu"
  touch "$root.complete"
fi

of_module="refract_tests opencv_test_refract samples/all" of_tools="refract_program_tests refract_tools_tests tools/all"
case $part in
  --module) targets=$of_module ;;
  --tools) targets=$of_tools ;;
  all) targets="$of_module $of_tools" ;;
esac
# shellcheck disable=SC2086  # lists of options
logged "$work/build.log" cmake -S . -B "$work/build" -G Ninja $toolchain -DREFRACT_ROOT="$root" -DREFRACT_WERROR=ON
# shellcheck disable=SC2086  # names without blanks
cmake --build "$work/build" --target $targets

# Whoever runs a tool, the tests too, gets a script that starts the emulator, whatever his PATH.
bin=$work/build/bin
for program in "$bin"/*."$arch"; do
  printf '#!/bin/sh\nexec %s -L "%s" -0 "$0" "$0.%s" "$@"\n' "$(command -v "$qemu")" "$root" "$arch" \
    >"${program%."$arch"}"
  chmod +x "${program%."$arch"}"
done

failed=0; counted=""
run() {         # run NAME COMMAND...: its output, kept for the counts
  name=$1; shift
  echo "$name:"
  { "$@" 2>&1 || echo "FAILED: $name"; } | tee "$work/$name.txt"
  ! grep -q "^FAILED: $name" "$work/$name.txt" || failed=$((failed + 1))
  counted="$counted $name"
}
if [ $part != --tools ]; then
  run refract_tests "$bin/refract_tests" '~[slow]~[.]'      # as with the sanitizers: what is slow by design is left out
  run opencv_test_refract "$bin/opencv_test_refract" --gtest_brief=1
  for sample in "$bin"/sample_*."$arch"; do
    run "$(basename "$sample" ".$arch")" "${sample%."$arch"}"
  done
fi
if [ $part != --module ]; then
  run refract_program_tests "$bin/refract_program_tests" '~[slow]~[.]'
  run refract_tools_tests "$bin/refract_tools_tests" '~[.]'
  rm -rf "$work/main_job"
  mkdir "$work/main_job"
  cp -r samples/data/stereo "$work/main_job/data"
  run main_job env -C "$work/main_job" PATH="$bin:$PATH" "$PWD/test/main_job.sh"
fi

echo
tail -n 2 "$work/kernels.txt"
for name in $counted; do
  counts=$(grep -E '^(All tests passed|test cases:|\[  PASSED|\[  FAILED)' "$work/$name.txt") || continue
  echo "$name: $counts"
done
echo "$failed programs failed on $arch"
[ $failed = 0 ]
