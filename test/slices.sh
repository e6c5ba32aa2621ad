# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# shellcheck shell=sh disable=SC2034  # variables of test/run.sh

# What is rare or slow, in slices of at most twenty-five minutes on two cores from nothing: sourced by test/run.sh. The gate takes one
# of them by turns, so that none goes without being run for long.
#
# Of each: its name, the minutes that it may take, the packages that it needs (tools/install_dependencies.sh), and its inputs: a
# change of these makes an earlier run of it old.
source_files="CMakeLists.txt cmake modules tools test samples"
slices="
plain             25  test              $source_files bench
instruction-sets  25  test              $source_files
universal         25  test,fuzz         $source_files
without-ceres     25  test              $source_files
sanitize-tools-1  25  test,fuzz         $source_files
sanitize-tools-2  25  test,fuzz         $source_files
sanitize-tools-3  25  test,fuzz         $source_files
fuzz-1            25  fuzz              $source_files
fuzz-2            25  fuzz              $source_files
fuzz-3            25  fuzz              $source_files
fuzz-4            25  fuzz              $source_files
monte-carlo-1     25  test              $source_files
monte-carlo-2     25  test              $source_files
monte-carlo-3     25  test              $source_files
monte-carlo-4     25  test              $source_files
monte-carlo-5     25  test              $source_files
monte-carlo-6     25  test              $source_files
honesty-1         25  test              $source_files
honesty-2         25  test              $source_files
honesty-3         25  test              $source_files
honesty-4         25  test              $source_files
honesty-5         25  test              $source_files
honesty-6         25  test              $source_files
honesty-7         25  test              $source_files
honesty-8         25  test              $source_files
honesty-9         25  test              $source_files
honesty-10        25  test              $source_files
pages             25  test              $source_files doc README.md
site              10  test,site         doc README.md test/site modules
opencv-4          25  test,in-tree      modules test/opencv_in_tree.sh test/opencv_source.sh test/opencv_hooks
opencv-4-plain    25  test,in-tree      modules test/opencv_in_tree.sh test/opencv_source.sh test/opencv_hooks
opencv-5          25  test,in-tree      modules test/opencv_in_tree.sh test/opencv_source.sh test/opencv_hooks
opencv-5-plain    25  test,in-tree      modules test/opencv_in_tree.sh test/opencv_source.sh test/opencv_hooks
wheel             25  wheel,bare        CMakeLists.txt cmake modules tools python packaging/wheel pyproject.toml test/wheel.sh
packages          25  test,bare         $source_files packaging/debian
demo-bare         25  bare              $source_files
tests-bare        25  bare              $source_files
debian13          25  bare              $source_files packaging/debian
aarch64-module    25  aarch64           $source_files
aarch64-tools     25  aarch64           $source_files
powerpc64le-module 25 powerpc64le       $source_files
powerpc64le-tools 25  powerpc64le       $source_files
riscv64           10  riscv64           modules test/kernels test/emulated test/emulated.sh
windows           25  windows           modules test/kernels test/windows test/windows.sh
"
names_of_slices() { echo "$slices" | awk 'NF { print $1 }'; }
of_slice() { echo "$slices" | awk -v name="$1" -v column="$2" '$1 == name { print $column }'; }             # of_slice NAME COLUMN
inputs_of_slice() {     # inputs_of_slice NAME: as git takes them
  echo "$slices" | awk -v name="$1" '$1 == name { $1 = $2 = $3 = ""; print }'
  echo ":(exclude)test/slices.txt"
}
turn_of() {             # turn_of COUNT EVERY: 1 to COUNT, the next one every so many commits; in a clone that does not have them: days
  turn=$(git rev-list --count HEAD)
  [ "$(git rev-parse --is-shallow-repository)" = false ] || turn=$(date +%j | sed 's/^0*//')
  echo $((turn / $2 % $1 + 1))
}
slice_of_the_turn() { names_of_slices | sed -n "$(turn_of "$(names_of_slices | wc -l)" 2)p"; }

list_slices() {         # at which commit each was last green, and since when its inputs have changed
  echo
  printf '%-20s %-9s %-10s %7s  %s\n' slice green at minutes 'inputs changed'
  for slice in $(names_of_slices); do
    green=$(grep "^$slice " test/slices.txt) || { printf '%-20s never\n' "$slice"; continue; }
    # shellcheck disable=SC2086  # four words
    set -- $green
    since="$2..HEAD"
    git cat-file -e "$2^{commit}" 2>/dev/null || since="--since=$3 HEAD"      # a clone without that commit
    # shellcheck disable=SC2046,SC2086  # lists of words
    changed=$(git log --reverse --format=%cs $since -- $(inputs_of_slice "$slice") | head -n 1)
    printf '%-20s %-9s %-10s %7s  %s\n' "$slice" "$2" "$3" "$4" "${changed:-no}"
  done
}
slice_in_time() (       # slice_in_time NAME [--record]: in a process of its own, which has to end within its minutes
  name=$1; limit=$(of_slice "$1" 2); begin=$(date +%s); code=0
  [ "$(left)" -ge $((60*limit)) ] || { in_the_hour test/run.sh --untimed "$name"; return; }
  timeout --kill-after=30 "${limit}m" test/run.sh --untimed "$name" || code=$?
  minutes=$((($(date +%s) - begin + 59)/60))
  case $code in
    0) [ "${2:-}" != --record ] || record_slice "$name" $minutes ;;
    124 | 137) echo "FAILED: the slice $name has not ended within its $limit minutes: find what has become slow, or cut it" \
                    "(test/slices.sh)" ;;
  esac
  return $code
)
record_slice() {        # record_slice NAME MINUTES
  # shellcheck disable=SC2046  # a list of words
  if [ -n "$(git status --porcelain -- $(inputs_of_slice "$1"))" ]; then
    echo "not recorded: what $1 depends on is not committed"; return
  fi
  { grep '^#' test/slices.txt
    { grep -v "^#\|^$1 " test/slices.txt || true; echo "$1 $(git log -1 --format='%h %cs') $2"; } | sort
  } >build/slices.txt
  mv build/slices.txt test/slices.txt
  grep "^$1 " test/slices.txt
}

# ---- builds
# Every file includes what it uses. Nothing of it runs: without optimisation.
slice_plain() {
  build build/plain -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
  run "all compiles without precompiled headers" test -x build/plain/bin/refract_tests
}
slice_instruction_sets() {
  targets=refract_tests
  build build/release
  for disabled in AVX512-SKX AVX512-SKX,AVX2; do
    export OPENCV_CPU_DISABLE=$disabled
    suite "the module without $disabled" build/release -L '^refract_tests$' -LE slow
  done
}
slice_universal() {
  targets=refract_tests
  build build/release
  run "the kernels on OpenCV's universal intrinsics" test/universal.sh build/release
}
slice_without_ceres() { run "without Ceres and Eigen: the library and all tests" test/without_ceres.sh; }

# ---- sanitizers and fuzzers: one build, that of the gate
sanitize_build() {
  build build/sanitize -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_CXX_FLAGS_DEBUG="-O1 -gline-tables-only" -DREFRACT_SANITIZE=address,undefined -DREFRACT_BUILD_FUZZ=ON \
    -DREFRACT_BUILD_BENCH=OFF -DREFRACT_BUILD_SAMPLES=OFF
  # Ceres and OpenCV keep their thread pools and plugins until the process ends: leaks are not what this looks for.
  export ASAN_OPTIONS=detect_leaks=0
}
sanitize_tools() {      # sanitize_tools FIRST: of the tools' tests every third
  targets=refract_tools_tests
  sanitize_build
  suite "the tools under sanitizers, $1 of 3" build/sanitize -L '^refract_tools_tests$' -LE slow -I "$1,,3"
}
slice_sanitize_tools_1() {
  sanitize_tools 1
  cmake --build build/sanitize --target refract_calib
  pair=samples/data/stereo
  run "a calibration from images with its report, under sanitizers" build/sanitize/bin/refract_calib --size=6x5 --square=39 \
    --thickness=20 --index=1.5437 --direct="$pair/direct1/*" --glass="$pair/glass1/*" --direct2="$pair/direct2/*" \
    --glass2="$pair/glass2/*" --out=build/sanitize/calib.yml --report=build/sanitize/report.html
}
slice_sanitize_tools_2() { sanitize_tools 2; }
slice_sanitize_tools_3() { sanitize_tools 3; }
long_fuzzing() {        # long_fuzzing FIRST: eight minutes of every fourth harness
  harnesses=$(find test/fuzz -name 'fuzz_*.cpp' | sort | sed "s,.*/fuzz_\(.*\)\.cpp,\1,; $1~4!d")
  # shellcheck disable=SC2086  # names without blanks
  run "fuzzing, eight minutes each: $(echo $harnesses)" test/fuzz/run.sh 480 $harnesses
}
slice_fuzz_1() { long_fuzzing 1; }
slice_fuzz_2() { long_fuzzing 2; }
slice_fuzz_3() { long_fuzzing 3; }
slice_fuzz_4() { long_fuzzing 4; }

# ---- Monte Carlo, crude starts, honesty, scaling: what the suites do not run
# They are ctest's of build/hidden, so that as many run at a time as there are processors.
begin_hidden() {
  mkdir -p build/hidden
  rm -rf build/hidden/*
}
add_hidden() {          # add_hidden NAME PROGRAM TEST [VARIABLE=VALUE;... [PROPERTIES]]
  pattern=$(echo "$3" | sed 's/[],[\\]/\\&/g')      # Catch2 parts names at commas
  { echo "add_test([==[$1]==] [==[$PWD/build/release/bin/$2]==] [==[$pattern]==] -w NoTests)"
    echo "set_tests_properties([==[$1]==] PROPERTIES SKIP_RETURN_CODE 77 ENVIRONMENT [==[${4:-}]==] ${5:-})"
  } >>build/hidden/CTestTestfile.cmake
}
monte_carlo() {         # monte_carlo FIRST: of the hidden tests every sixth, without those that make the samples' data
  build build/release       # all of it: tests run the tools
  begin_hidden
  for program in refract_tests refract_program_tests refract_tools_tests; do
    build/release/bin/"$program" "[.]~[wand-data]~[flows]" --list-test-names-only | sed "s/^/$program /"
  done | sed -n "$1~6p" >build/hidden.txt
  while read -r program name; do add_hidden "$name" "$program" "$name"; done <build/hidden.txt
  suite "hidden tests, $1 of 6" build/hidden
}
slice_monte_carlo_1() { monte_carlo 1; }
slice_monte_carlo_2() { monte_carlo 2; }
slice_monte_carlo_3() { monte_carlo 3; }
slice_monte_carlo_4() { monte_carlo 4; }
slice_monte_carlo_5() { monte_carlo 5; }
slice_monte_carlo_6() { monte_carlo 6; }
# The four of [flows], a part of their trials: whole, each takes an hour or more.
honesty() {             # honesty TEST RIGS...; a quarter of the trials, or $share
  test=$1; shift
  targets=refract_tools_tests
  build build/release
  begin_hidden
  for rigs in "$@"; do
    add_hidden "$rigs" refract_tools_tests "$test" "ONLY=$rigs;TRIALS=${share:-25%}" 'FAIL_REGULAR_EXPRESSION "assertions: - none -"'
  done
  suite "$test" build/hidden
}
sealed_and_others() {
  honesty "$1" "sealed, air" "sealed, bare surface, 1" "sealed, laminate" "shared wall" robust
}
sealed_in_water() {     # the longest searches: half a minute a trial
  share=10%
  honesty "$1" "sealed, housing in water, 2" "sealed, bare surface, 2" "sealed, housing in water, 1"
}
true_flows="Every flow states a true +-: two hundred trials"
drawn_flows="Every flow, with given values drawn from what is known of them: two hundred trials"
chosen_lenses="Sealed rigs of which the lens is chosen: points and lengths"
slice_honesty_1() { honesty "$true_flows" pairs hand-held "known poses"; }
slice_honesty_2() { sealed_and_others "$true_flows"; }
slice_honesty_3() { honesty "$drawn_flows" pairs hand-held; }
slice_honesty_4() { sealed_and_others "$drawn_flows"; }
lenses_behind() { honesty "$chosen_lenses" "sealed, $1, 2 camera(s), lens chosen of 4" "sealed, $1, 2 camera(s), lens chosen of 5"; }
slice_honesty_5() { lenses_behind air; }
slice_honesty_6() { lenses_behind "bare surface"; }
slice_honesty_7() { lenses_behind "housing in water"; }
slice_honesty_8() { honesty "Five hundred sealed rigs from afar, few views, wrong corners*" all; }
slice_honesty_9() { sealed_in_water "$true_flows"; }
slice_honesty_10() { sealed_in_water "$drawn_flows"; }

# ---- documentation
slice_pages() {
  build build/release
  run "documentation: all of its commands" test/doc_blocks.py build/release/bin
}
slice_site() {
  targets=pane_values
  build build/release
  run "documentation: the site builds, its links lead somewhere, its figure computes as the library" test/site.sh build/release
}

# ---- other OpenCVs and Pythons
opencv_tests="its tests, performance tests, Python, documentation"
slice_opencv_4() { run "in OpenCV 4.14: $opencv_tests" test/opencv_in_tree.sh 4.14.0.94 --with-ceres; }
slice_opencv_4_plain() { run "in OpenCV 4.14, without Ceres" test/opencv_in_tree.sh 4.14.0.94 --without-ceres; }
slice_opencv_5() { run "in OpenCV 5.0: $opencv_tests" test/opencv_in_tree.sh 5.0.0.93 --with-ceres; }
slice_opencv_5_plain() { run "in OpenCV 5.0, without Ceres" test/opencv_in_tree.sh 5.0.0.93 --without-ceres; }
slice_wheel() { run "the wheel, on bare machines" test/wheel.sh; }

# ---- bare machines
slice_packages() {
  build build/release
  run "the Debian packages on a bare machine" test/package.sh --bare build/release
}
slice_demo_bare() { run "tools/demo.sh on a bare Debian 12" test/bare.sh tools/demo.sh; }
slice_tests_bare() { run "test/run.sh on a bare Debian 12" test/bare.sh test/run.sh; }
slice_debian13() { run "a bare Debian 13" test/debian13.sh; }

# ---- other processors and systems
slice_aarch64_module() { run "the module for aarch64, in an emulator" test/emulated.sh aarch64 --module; }
slice_aarch64_tools() { run "the tools for aarch64, in an emulator" test/emulated.sh aarch64 --tools; }
slice_powerpc64le_module() { run "the module for powerpc64le, in an emulator" test/emulated.sh powerpc64le --module; }
slice_powerpc64le_tools() { run "the tools for powerpc64le, in an emulator" test/emulated.sh powerpc64le --tools; }
slice_riscv64() { run "the kernels for riscv64, in an emulator" test/emulated.sh riscv64; }
slice_windows() { run "Windows: the kernels, the module and its tests compile" test/windows.sh; }
