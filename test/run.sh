#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Installs what is missing, builds everything with warnings as errors, runs all tests: once as released, once with the
# address and undefined-behaviour sanitizers; then the fuzzers, a little. Ends with a line that counts the tests.
#
# Usage: test/run.sh [--fast]      --fast leaves the sanitizers and the fuzzers out
set -eu
cd "$(dirname "$0")/.."
fast=no
[ "${1:-}" = --fast ] && fast=yes

# All at once, as what runs side by side must not wait for the other's apt.
wanted="test in-tree aarch64 powerpc64le riscv64 site"
[ $fast = yes ] || wanted="$wanted fuzz"
for kind in $wanted; do
  tools/install_dependencies.sh $kind
done

launcher=""
command -v ccache >/dev/null && launcher="-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
begun=$(date +%s)
after() { echo "$(($(date +%s) - begun)) s"; }      # since the beginning: what takes long shows
build() {   # build DIRECTORY OPTIONS...
  directory=$1; shift
  cmake -S . -B "$directory" -G Ninja -DREFRACT_WERROR=ON $launcher "$@" >"$directory.log" 2>&1 ||
    { cat "$directory.log"; exit 1; }
  cmake --build "$directory"
  echo "built after $(after): $directory"
}

passed=0; failed=0; skipped=0; failures=""; failing_logs=""
run() {     # run NAME COMMAND...: counts one test; exit code 77 = skipped
  name=$1; shift
  code=0
  step=build/step$((passed + failed + skipped)).log
  "$@" >"$step" 2>&1 || code=$?
  cat "$step"
  case $code in
    0) passed=$((passed + 1)); echo "passed after $(after): $name" ;;
    77) skipped=$((skipped + 1)); echo "skipped after $(after): $name" ;;
    *) failed=$((failed + 1)); failures="$failures; $name"; failing_logs="$failing_logs $step"
       echo "FAILED after $(after): $name" ;;
  esac
}
parts=""
suite() {   # suite NAME EXECUTABLE [FILTER]: a Catch2 program, which takes one thread only, in parts of every eighth case
  name=build/$1; program=$2; shift 2
  rm -f "$name".cases.* "$name".part.*
  # It ends with how many there are. A comma in a name would end it where names are read.
  { "$program" "$@" --list-test-names-only || true; } | sed 's/,/\\,/g' >"$name.cases"
  split -n r/8 --numeric-suffixes "$name.cases" "$name.cases."
  for cases in "$name".cases.*; do
    parts="$parts$program $cases $name.part.${cases##*.} OPENCV_CPU_DISABLE=${OPENCV_CPU_DISABLE:-}
"
  done
}
count_suites() {    # runs all parts, shows what they printed, counts their cases one by one
  printf %s "$parts" | xargs -n 4 -P "$(nproc)" sh -c '{ echo "$3 $0 $1"; env "$3" "$0" --input-file "$1" || true; } >"$2" 2>&1'
  for log in $(printf %s "$parts" | cut -d " " -f 3); do
    cat "$log"
    # "All tests passed (1234 assertions in 56 test cases)" or "test cases: 56 | 55 passed | 1 failed"
    p=$(sed -n 's/^All tests passed .* in \([0-9]*\) test case.*/\1/p; s/^test cases:.*| *\([0-9]*\) passed.*/\1/p' "$log")
    f=$(sed -n 's/^test cases:.*| *\([0-9]*\) failed.*/\1/p' "$log")
    p=${p:-0}; f=${f:-0}
    passed=$((passed + p)); failed=$((failed + f))
    [ "$f" = 0 ] || failures="$failures; $f of $log"
    if [ $((p + f)) != "$(wc -l <"${log%.part.*}.cases.${log##*.}")" ]; then      # a crash prints no counts
      failed=$((failed + 1)); failures="$failures; $log ends before its last test"; f=1
    fi
    [ "$f" = 0 ] || failing_logs="$failing_logs $log"
  done
  echo "suites done after $(after)"
  parts=""
}

mkdir -p build
build build/release
# Beside the suites, one after the other: what waits for networks and configures for most of its time.
beside() {  # beside NAME COMMAND...
  name=$1; shift
  code=0
  "$@" >build/"$name".log 2>&1 || code=$?
  echo "beside the rest, ended after $(after)" >>build/"$name".log
  echo $code >build/"$name".code
}
rm -f build/*.code
{
  beside python test/python.sh "$@"
  # OpenCV itself is not compiled here: that takes the whole script, without --short.
  beside opencv4 test/opencv_in_tree.sh 4.14.0.94 --short
  beside opencv5 test/opencv_in_tree.sh 5.0.0.93 --short
  beside without_ceres test/without_ceres.sh --short
  for arch in aarch64 powerpc64le riscv64; do
    beside $arch test/emulated.sh $arch --short     # everything: without --short
  done
} &
lane=$!
result_of() {   # result_of NAME: what the command of that name printed, and how it ended
  while [ ! -e build/"$1".code ] && kill -0 $lane 2>/dev/null; do sleep 1; done
  cat build/"$1".log
  return "$(cat build/"$1".code)"
}
suite tests build/release/bin/refract_tests
suite tools_tests build/release/bin/refract_tools_tests
count_suites
# A kernel's rounding, and what it accepts, differ from one instruction set to the next: all that calls the module itself.
module_only='~[slow]~[.]~[tools]~[calib_tool]~[calib_rig]'
OPENCV_CPU_DISABLE=AVX512-SKX suite tests_avx2 build/release/bin/refract_tests "$module_only"
OPENCV_CPU_DISABLE=AVX512-SKX,AVX2 suite tests_baseline build/release/bin/refract_tests "$module_only"
count_suites
run "the module's own tests over googletest" build/release/bin/opencv_test_refract --gtest_brief=1
run "installed package: find_package and pkg-config" test/consumer/run.sh build/release
run "exported names: those of the committed list" test/exports.sh build/release
run "Debian packages: clean, unpacked, tools and header work" test/package.sh build/release
run "documentation: the site builds, its links lead somewhere, its figure computes as the library" test/site.sh build/release
run "documentation: its commands run and print what it says; the quick ones" test/doc_blocks.py --short build/release/bin
run "the kernels on OpenCV's universal intrinsics" test/universal.sh --short build/release
# Answers only: times depend on the machine. A machine without AVX runs the same level more than once.
for isa in baseline avx2 avx512; do
  run "answers of the benchmark, $isa at most" build/release/bin/refract_bench --quick --isa=$isa
done
for sample in build/release/bin/sample_*; do
  run "$(basename "$sample")" "$sample"
done
run "Python package, its tests and samples" result_of python
run "in OpenCV 4.14's tree: configures, compiles the module, generates bindings" result_of opencv4
run "in OpenCV 5.0's tree: the same" result_of opencv5
run "without Ceres and Eigen: the library and its own tests" result_of without_ceres
for arch in aarch64 powerpc64le riscv64; do
  run "the kernels compiled for $arch, run in an emulator" result_of $arch
done
run "the same hundred values from every build" test/agreement/run.sh build/release
if [ $fast = no ]; then
  # One build for the suites and the fuzzers, which want clang.
  build build/sanitize -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_CXX_FLAGS_DEBUG="-O1 -gline-tables-only" -DREFRACT_SANITIZE=address,undefined -DREFRACT_BUILD_FUZZ=ON \
    -DREFRACT_BUILD_BENCH=OFF -DREFRACT_BUILD_SAMPLES=OFF
  # Ceres and OpenCV keep their thread pools and plugins until the process ends: leaks are not what this looks for.
  # One thread: the sanitizer's allocator, forked beside other threads (target/limited_search), may stay locked for ever.
  ASAN_OPTIONS=detect_leaks=0; OPENCV_FOR_THREADS_NUM=1; export ASAN_OPTIONS OPENCV_FOR_THREADS_NUM
  # A calibration from images takes ten times as long under sanitizers: one, whole, instead of the tools' many.
  suite tests_sanitize build/sanitize/bin/refract_tests '~[slow]~[.]~[calib_tool]~[calib_rig]'
  suite tools_tests_sanitize build/sanitize/bin/refract_tools_tests '~[slow]~[.]'
  count_suites
  pair=samples/data/stereo
  run "a calibration from images with its report, under sanitizers" build/sanitize/bin/refract_calib --size=6x5 --square=39 \
    --thickness=20 --index=1.5437 --direct="$pair/direct1/*" --glass="$pair/glass1/*" --direct2="$pair/direct2/*" \
    --glass2="$pair/glass2/*" --out=build/sanitize/calib.yml --report=build/sanitize/report.html
  unset OPENCV_FOR_THREADS_NUM
  run "fuzzing: every parser and every public call, ten seconds each" test/fuzz/run.sh
fi

# Once more at the end, where one looks first.
for log in $failing_logs; do
  echo "From $log:"
  grep -B 12 -A 8 'FAILED:\|ERROR: AddressSanitizer\|runtime error' "$log" | head -200
  tail -20 "$log"
done
[ -z "$failures" ] || echo "FAILED: ${failures#; }"
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed = 0 ]
