# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# shellcheck shell=sh disable=SC2034,SC2154  # variables of test/run.sh

# What `test/run.sh --all` and `--release` do: sourced by it.

# Beside the suites, one after the other: what waits for networks and configures for most of its time.
beside() {  # beside NAME COMMAND...
  name=$1; shift
  code=0
  "$@" >build/"$name".log 2>&1 || code=$?
  echo "beside the rest, ended after $(after)" >>build/"$name".log
  echo $code >build/"$name".code
}
result_of() {   # result_of NAME: what the command of that name printed, and how it ended
  while [ ! -e build/"$1".code ] && kill -0 $lane 2>/dev/null; do sleep 1; done
  cat build/"$1".log
  return "$(cat build/"$1".code)"
}
rm -f build/*.code
{
  beside python test/python.sh
  # OpenCV itself is not compiled here: that takes the whole script, without --short. OpenCV 4 with Ceres, 5 without.
  beside opencv4 test/opencv_in_tree.sh 4.14.0.94 --short
  beside opencv5 test/opencv_in_tree.sh 5.0.0.93 --short
  beside bindings test/bindings.sh
  beside cache test/compiler_cache.sh
} &
lane=$!

run "style: shell, Python, white space, links" tools/lint.sh
build build/release
suite "all tests but the slow ones" build/release -LE slow
# A kernel's rounding, and what it accepts, differ from one instruction set to the next.
kernels='^(kernels|lens|camera|project|undistort(_map)?|plane|triangulate(_rig)?|epilines|epipolar|stereo_rectify|pnp|dome)$'
for disabled in AVX512-SKX AVX512-SKX,AVX2; do
  export OPENCV_CPU_DISABLE=$disabled
  suite "kernels without $disabled" build/release -L "$kernels" -LE 'slow|tools'
done
unset OPENCV_CPU_DISABLE
run "installed package: find_package and pkg-config" test/consumer/run.sh build/release
run "exported names: those of the committed list" test/exports.sh build/release
run "Debian packages: clean, unpacked, tools and header work" test/package.sh build/release
run "documentation: its commands run and print what it says; the quick ones" test/doc_blocks.py --short build/release/bin
# Answers only: times depend on the machine. A machine without AVX runs the same level more than once.
for isa in baseline avx2 avx512; do
  run "answers of the benchmark, $isa at most" build/release/bin/refract_bench --quick --isa=$isa
done
for sample in build/release/bin/sample_*; do
  run "$(basename "$sample")" "$sample"
done

# What takes long, by turns: the part whose turn it is, and the next ones as long as the hour lasts.
part_slow_tests() {     # a third of those that take a minute each
  thirds=$(turn_of 3 6)
  [ "$scope" = --all ] || thirds="1 2 3"
  for third in $thirds; do
    suite "slow tests, $third of 3" build/release -L slow -I "$third,,3"
  done
}
# The two that want clang share a build. What reads files is under sanitizers in the fuzzers; the tools' fits take ten times as long
# so: a slice.
part_sanitizers() {
  targets=refract_tests
  sanitize_build
  targets=""
  suite "the module under sanitizers" build/sanitize -L '^refract_tests$' -LE 'slow|real'
  unset ASAN_OPTIONS
}
part_fuzzers() { run "fuzzing: every parser and every public call, some seconds each" in_the_hour test/fuzz/run.sh; }
part_slice() {
  slices_now=$(slice_of_the_turn)
  [ "$scope" = --all ] || slices_now=$(names_of_slices)
  for slice in $slices_now; do
    run "the slice $slice" slice_in_time "$slice"
  done
}
parts="slow_tests sanitizers fuzzers"
case $(turn_of 3 2) in
  2) parts="sanitizers fuzzers slow_tests" ;;
  3) parts="fuzzers slow_tests sanitizers" ;;
esac
case $(turn_of 2 1) in      # every other time the slice comes first
  1) parts="slice $parts" ;;
  2) parts="$parts slice" ;;
esac
# Each takes up to 25 minutes where the rest takes 20. A machine twice as slow cuts off what it has begun, and a slower one begins
# none: a gate that never ends tells nothing.
[ "$scope" != --all ] || deadline=3200
latest=2400
for part in $parts; do
  if [ "$scope" != --all ] || [ "$(elapsed)" -lt $latest ]; then
    "part_$part"
  else
    echo "left for its turn, as the hour is nearly over: $part"
  fi
  latest=1500
done
deadline=""

run "Python package, its tests and samples" result_of python
run "in OpenCV 4.14's tree: configures, compiles the module, generates bindings" result_of opencv4
run "in OpenCV 5.0's tree, without Ceres: the same" result_of opencv5
run "Python bindings for the headers of OpenCV 4.6, 4.14 and 5.0" result_of bindings
run "what one clone has compiled another one finds in the compiler's cache" result_of cache
run "the same hundred values from every build" test/agreement/run.sh build/release
