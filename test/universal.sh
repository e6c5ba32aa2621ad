#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# The kernels on OpenCV's universal intrinsics, as compilers without vector types of their own (MSVC) get them, here forced: that
# they ask nothing of a compiler that MSVC has not, leave no function behind that a linker could take for another level's, and pass
# the tests at every instruction set of this machine.
#
# Usage: test/universal.sh [--short] [BUILD_DIRECTORY]     build/release
#   --short runs the tests of what calls the kernels directly, not all of the module
set -eu
cd "$(dirname "$0")/.."
suites='~[slow]~[.]~[tools]~[calib_tool]~[calib_rig]'
if [ "${1:-}" = --short ]; then
  shift
  suites=""
  for tag in kernels lens project undistort triangulate epilines; do
    suites="$suites,[$tag]~[tools]~[slow]"
  done
  suites=${suites#,}
fi
build=${1:-build/release}

cmake --build "$build" --target refract_tests_universal
for object in "$build"/test/CMakeFiles/refract_universal.dir/*/modules/refract/src/dispatch/kernels_*.o; do
  others=$(nm -C --defined-only --extern-only "$object" | grep -v ' T cv::refract::kernels[A-Za-z0-9]*()$') || true
  [ -z "$others" ] || { echo "FAILED: functions that may serve other levels, in $object: $others" >&2; exit 1; }
done
program=$build/bin/refract_tests_universal
nm -C "$program" | grep -q '(anonymous namespace)::Lanes' ||
  { echo "FAILED: the linker has taken the kernels of the library, not those on universal intrinsics" >&2; exit 1; }

if command -v clang++-14 >/dev/null; then
  for options in "baseline -msse2" "avx2 -mavx2 -mfma" "avx512 -mavx512f -mavx512cd -mavx512vl -mavx512bw -mavx512dq -mfma"; do
    # shellcheck disable=SC2086  # a list of options
    clang++-14 -std=c++17 -fsyntax-only -Wall -Wextra -Werror -Wgnu -pedantic-errors -DREFRACT_UNIVERSAL_INTRINSICS ${options#* } \
      -Imodules/refract/src -isystem /usr/include/opencv4 "modules/refract/src/dispatch/kernels_${options%% *}.cpp"
  done
  echo "passed: no extension of GNU's in the kernels"
fi

for disabled in "" AVX512-SKX AVX512-SKX,AVX2; do
  log=$build/universal.log
  OPENCV_CPU_DISABLE=$disabled "$program" "$suites" >"$log" 2>&1 || { cat "$log"; exit 1; }
  echo "$(grep '^All tests passed' "$log"), without ${disabled:-nothing}"
done
echo "passed: the kernels on universal intrinsics"
