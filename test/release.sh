# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# shellcheck shell=sh

# What `test/run.sh --release` does after test/gate.sh: sourced by it.

# Without precompiled headers: every file includes what it uses.
build build/plain -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
for disabled in AVX512-SKX AVX512-SKX,AVX2; do
  export OPENCV_CPU_DISABLE=$disabled
  suite "the module without $disabled" build/release -L '^refract_tests$' -LE slow
done
unset OPENCV_CPU_DISABLE
cmake --build build/sanitize        # all of it
export ASAN_OPTIONS=detect_leaks=0 OPENCV_FOR_THREADS_NUM=1
suite "the tools under sanitizers" build/sanitize -L '^refract_tools_tests$' -LE slow
pair=samples/data/stereo
run "a calibration from images with its report, under sanitizers" build/sanitize/bin/refract_calib --size=6x5 --square=39 \
  --thickness=20 --index=1.5437 --direct="$pair/direct1/*" --glass="$pair/glass1/*" --direct2="$pair/direct2/*" \
  --glass2="$pair/glass2/*" --out=build/sanitize/calib.yml --report=build/sanitize/report.html
unset ASAN_OPTIONS OPENCV_FOR_THREADS_NUM
run "documentation: all of its commands" test/doc_blocks.py build/release/bin
run "documentation: the site builds, its links lead somewhere, its figure computes as the library" test/site.sh build/release
run "the kernels on OpenCV's universal intrinsics" test/universal.sh build/release
run "in OpenCV 4.14: its tests, performance tests, Python, with and without Ceres" test/opencv_in_tree.sh 4.14.0.94
run "in OpenCV 5.0: the same" test/opencv_in_tree.sh 5.0.0.93
run "without Ceres and Eigen: the library and all tests" test/without_ceres.sh
for arch in aarch64 powerpc64le riscv64; do
  run "everything for $arch, in an emulator" test/emulated.sh $arch
done
run "Windows: the kernels, the module and its tests compile" test/windows.sh
run "the wheel, on bare machines" test/wheel.sh
run "the Debian packages on a bare machine" test/package.sh --bare build/release
run "both commands on a bare Debian 12" test/bare.sh
run "a bare Debian 13" test/debian13.sh
run "the same hundred values from all of these builds" test/agreement/run.sh build/release
run "fuzzing: ten minutes of each" test/fuzz/run.sh 600
for program in refract_tests refract_program_tests refract_tools_tests; do
  run "$program: Monte Carlo, crude starts, honesty, scaling" "build/release/bin/$program" "[.]"
done
