#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Compiles for Windows (mingw-w64) with warnings as errors. The kernels of every instruction set first, alone, and where wine is
# installed they are run: what they compute against what this machine does. Then the module and its own tests, to objects: Debian
# has no OpenCV for Windows to link them with, so that they are not run. Kept in build/windows: the first run takes a quarter of an
# hour on two cores.
#
# Usage: test/windows.sh [--short]     --short: the kernels only
set -eu
cd "$(dirname "$0")/.."
short=no
[ "${1:-}" = --short ] && short=yes

tools/install_dependencies.sh windows
work=$PWD/build/windows
toolchain=$PWD/test/windows/toolchain.cmake
mkdir -p "$work/kernels"
. tools/compiler_cache.sh
compile() {     # compile SOURCE BUILD CMAKE_OPTION...: what is said is shown only if it fails
  source=$1; directory=$2; shift 2
  { cmake -S "$source" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" &&
    cmake --build "$directory"; } >"$directory.log" 2>&1 || { cat "$directory.log"; exit 1; }
}

has() {         # has LEVEL: whether this processor runs it
  case $1 in
    Baseline) true ;;
    Avx2) grep -q -w avx2 /proc/cpuinfo ;;
    Avx512) grep -q -w avx512dq /proc/cpuinfo ;;
  esac
}
WINEPREFIX=$work/wine WINEDEBUG=-all; export WINEPREFIX WINEDEBUG
for level in Baseline Avx2 Avx512; do
  # On the compiler's vectors, and on OpenCV's universal intrinsics, as MSVC gets them.
  for universal in OFF ON; do
    build=$work/kernels/windows-$level-universal-$universal
    compile test/kernels "$build" -DLEVEL=$level -DREFRACT_UNIVERSAL_INTRINSICS=$universal -DCMAKE_TOOLCHAIN_FILE="$toolchain" \
      -DCMAKE_EXE_LINKER_FLAGS=-static
    if ! command -v wine >/dev/null; then
      echo "wine is not installed: the kernels of $level are compiled for Windows, but not run"
    elif has $level; then
      compile test/kernels "$work/kernels/here-$level" -DLEVEL=$level
      "$work/kernels/here-$level/kernels" >"$work/kernels/here-$level.txt"
      wine "$build/kernels.exe" 2>"$work/kernels/wine.log" | tr -d '\r' >"$build.txt"
      /usr/bin/python3 -B test/agreement/compare.py "$work/kernels/here-$level.txt" "$build.txt" | tail -n 2
    fi
  done
done
echo "passed: the kernels for Windows"
[ $short = no ] || exit 0

# Of this machine's headers only those that are the same on every system.
headers=$work/headers
mkdir -p "$headers"
ln -sfn /usr/include/opencv4/opencv2 "$headers/opencv2"
for name in Eigen unsupported; do
  ln -sfn /usr/include/eigen3/$name "$headers/$name"
done
for name in ceres glog gflags gtest; do
  ln -sfn /usr/include/$name "$headers/$name"
done
compile test/windows "$work/module" -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DHEADERS="$headers"
echo "passed: $(find "$work/module" -name '*.obj' | wc -l) objects of the module and its tests for Windows"
