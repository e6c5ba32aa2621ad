#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Builds the module where neither Ceres nor Eigen is found, and runs the tests of all that does without them.
#
# Usage: test/without_ceres.sh [--short]
#   --short leaves out the suite over the inner parts (refract_tests)
set -eu
cd "$(dirname "$0")/.."
short=no
[ "${1:-}" = --short ] && short=yes

tools/install_dependencies.sh test
build=$PWD/build/without_ceres
. tools/compiler_cache.sh
configure() {   # configure DIRECTORY OPTIONS...
  directory=$1; shift
  cmake -S . -B "$directory" -G Ninja -DREFRACT_WERROR=ON -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON \
    "$@" >"$directory.log" 2>&1
}
mkdir -p build

# Whoever asks for Ceres is told that it is missing.
rm -rf "$build.asked"
if configure "$build.asked" -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DREFRACT_WITH_CERES=ON; then
  echo "FAILED: REFRACT_WITH_CERES=ON is satisfied without Ceres" >&2; exit 1
fi
grep -q "REFRACT_WITH_CERES is ON, but Ceres" "$build.asked.log" || { cat "$build.asked.log"; exit 1; }
rm -rf "$build.asked"

# Found to be missing, then refused: the same build.
for option in -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DREFRACT_WITH_CERES=OFF; do
  configure "$build" $option || { cat "$build.log"; exit 1; }
  grep -q "refract: without Ceres, so calibrateGlass" "$build.log" &&
    grep -q "neither the command line tools nor the benchmark are built" "$build.log" || { cat "$build.log"; exit 1; }
done

cmake --build "$build" --target opencv_test_refract
"$build/bin/opencv_test_refract" --gtest_brief=1
if ldd "$build/libopencv_refract.so" | grep -i ceres; then echo "FAILED: the library is linked to Ceres" >&2; exit 1; fi
if [ $short = no ]; then
  cmake --build "$build"
  "$build/bin/refract_tests" '~[slow]~[.]'
fi
if ninja -C "$build" -t deps | grep -i '/\(eigen3\|ceres\)/'; then
  echo "FAILED: headers of Eigen or Ceres are read" >&2; exit 1
fi
echo "passed: without Ceres and Eigen"
