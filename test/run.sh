#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Installs what is missing, builds with warnings as errors, runs tests, and ends with a line that counts them.
#
# Usage: test/run.sh [--all | --release | --slices | --slice NAME [--record]]
#   without an option: the library, its tests and those of the tools that do not take a minute each. Ten minutes on two cores.
#   --all      the gate: these, what else a change may break (instruction sets, Python, OpenCV's own tree, packages, samples, the
#              commands of the documentation), and by turns, as much as an hour has time for: a third of the other tests, the module
#              under sanitizers, the fuzzers, one slice of what is rare or slow. What the hour cuts off counts as skipped
#   --release  the gate and all of the slices: hours
#   --slices   lists the slices (test/slices.sh): at which commit each was last green, and since when its inputs have changed
#   --slice NAME    runs one of them; --record writes into test/slices.txt that it was green
# A single test, once built: ctest --test-dir build/release -R 'part of its name'; by topic: -L pnp, see --print-labels.
set -eu
cd "$(dirname "$0")/.."
usage() { sed -n 's/^# \(Usage: \)/\1/p' "$0" >&2; exit 1; }
. test/slices.sh
begun=$(date +%s)
elapsed() { echo $(($(date +%s) - begun)); }
after() { echo "$(elapsed) s"; }                    # since the beginning: what takes long shows
deadline=""                                         # in seconds since the beginning: test/gate.sh sets it
left() { seconds=$((${deadline:-100000} - $(elapsed))); echo $((seconds > 1 ? seconds : 1)); }
in_the_hour() {         # in_the_hour COMMAND...: skipped where the hour ends before it does
  code=0
  timeout --kill-after=30 "$(left)" "$@" || code=$?
  case $code in 124 | 137) [ "$(left)" -gt 1 ] || code=77 ;; esac       # 137: what did not end by itself
  return $code
}
scope=${1:-quick}
case $scope in
  quick) kinds="test" ;;
  --all | --release) kinds="test lint in-tree fuzz" ;;
  --slices) list_slices; exit 0 ;;
  --slice) [ -n "$(of_slice "${2:-}" 1)" ] || usage
           [ "${3:---record}" = --record ] || usage
           slice_in_time "$2" "${3:-}"; exit ;;
  --untimed) kinds=$(of_slice "$2" 3 | tr , ' ') ;;         # what --slice starts
  *) usage ;;
esac
for kind in $kinds; do      # all at once, as what runs side by side must not wait for the other's apt
  tools/install_dependencies.sh "$kind"
done
. tools/compiler_cache.sh
mkdir -p build
installing=$(($(date +%s) - begun)); compiling=0
echo "installed after $(after)"

passed=0; failed=0; skipped=0; failures=""; failing_logs=""
logs=build/step${2:+-$2-}       # a slice beside the gate that has started it
build() {   # build DIRECTORY OPTIONS...; only the targets in $targets, if there are any
  directory=$1; shift
  since=$(date +%s)
  cmake -S . -B "$directory" -G Ninja -DREFRACT_WERROR=ON "$@" >"$directory.log" 2>&1 || { cat "$directory.log"; exit 1; }
  code=0
  # shellcheck disable=SC2086  # names without blanks
  timeout "$(left)" cmake --build "$directory" --target ${targets:-all} || code=$?
  [ $code = 0 ] || [ $code = 124 ] || exit 1      # 124: no time is left, so its suite does not begin
  compiling=$((compiling + $(date +%s) - since))
  echo "built after $(after): $directory"
}
run() {     # run NAME COMMAND...: counts one test; exit code 77 = skipped
  name=$1; shift
  code=0
  step=$logs$((passed + failed + skipped)).log
  "$@" >"$step" 2>&1 || code=$?
  cat "$step"
  case $code in
    0) passed=$((passed + 1)); echo "passed after $(after): $name" ;;
    77) skipped=$((skipped + 1)); echo "skipped after $(after): $name" ;;
    *) failed=$((failed + 1)); failures="$failures; $name"; failing_logs="$failing_logs $step"
       echo "FAILED after $(after): $name" ;;
  esac
}
suite() {   # suite NAME BUILD OPTIONS_OF_CTEST...: counts its tests one by one
  name=$1; directory=$2; shift 2
  log=build/$(echo "$name" | tr -c 'a-z0-9\n' _).log
  rm -f "$log.xml" "$directory"/Testing/Temporary/LastTest.log*
  [ "$(left)" -gt 1 ] || { skipped=$((skipped + 1)); echo "left for its turn, as the hour is over: $name"; return; }
  code=0
  timeout "$(left)" ctest --test-dir "$directory" -j "$(nproc)" --timeout 1500 --output-on-failure \
    --output-junit "$PWD/$log.xml" "$@" >"$log" 2>&1 || code=$?
  cat "$directory"/Testing/Temporary/LastTest.log* >"$log.all"      # with .tmp behind it where ctest was stopped
  grep '^\[numbers\]' "$log.all" || true
  count() { sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p" "$log.xml" | head -n 1; }
  total=0; f=1; s=0       # no tests, or a ctest that died, is a failure
  if [ $code = 124 ]; then  # those that ended before the hour did
    f=$(grep -c '[*][*][*]\(Failed\|Exception\|Timeout\)' "$log" || true)
    s=1; total=$(($(grep -c ' Passed  ' "$log" || true) + f + s))
    echo "stopped, as the hour is over: $name"
  elif [ -s "$log.xml" ] && [ "$(count tests)" -gt 0 ]; then
    total=$(count tests); f=$(count failures); s=$(($(count skipped) + $(count disabled)))
  fi
  failed=$((failed + f)); skipped=$((skipped + s))
  [ "$total" = 0 ] || passed=$((passed + total - f - s))
  [ "$s" = 0 ] || grep -h 'SKIPPED: ' "$log.all" | sort | uniq -c
  if [ "$f" != 0 ]; then
    cat "$log"
    failures="$failures; $f of $name"; failing_logs="$failing_logs $log"
  fi
  echo "$total tests after $(after), $f failed: $name"
}
finish() {  # what failed once more at the end, where one looks first
  for log in $failing_logs; do
    echo "From $log:"
    grep -B 12 -A 8 'FAILED:\|ERROR: AddressSanitizer\|runtime error' "$log" | head -200
    tail -20 "$log"
  done
  [ -z "$failures" ] || echo "FAILED: ${failures#; }"
  total=$(($(date +%s) - begun))
  echo "It took $total s: installing $installing, compiling $compiling, testing $((total - installing - compiling))."
  echo "$passed passed, $failed failed, $skipped skipped"
  [ $failed = 0 ] || exit 1
  [ $passed != 0 ] || exit 77
  exit 0
}

case $scope in
  quick) build build/release -DREFRACT_BUILD_BENCH=OFF -DREFRACT_BUILD_SAMPLES=OFF
         suite "tests" build/release -LE slow ;;
  --untimed) "slice_$(echo "$2" | tr - _)" ;;
  *) . test/gate.sh
     list_slices ;;
esac
finish
