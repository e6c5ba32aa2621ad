#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Installs what is missing, builds with warnings as errors, runs tests, and ends with a line that counts them.
#
# Usage: test/run.sh [--all | --release]
#   without an option: the library, its tests and those of the tools that do not take a minute each. Ten minutes on two cores.
#   --all      all of them, and what else a change may break: instruction sets, sanitizers, fuzzers, Python, OpenCV's own tree,
#              packages, samples, the commands of the documentation
#   --release  also what is rare or slow: the wheel, bare machines, other processors, every build, long fuzzing, Monte Carlo, the
#              site. Hours.
# A single test, once built: ctest --test-dir build/release -R 'part of its name'; by topic: -L pnp, see --print-labels.
set -eu
cd "$(dirname "$0")/.."
scope=${1:-quick}
case $scope in
  quick) kinds="test" ;;
  --all) kinds="test lint in-tree fuzz" ;;
  --release) kinds="test lint in-tree fuzz aarch64 powerpc64le riscv64 windows wheel bare site" ;;
  *) echo "usage: $0 [--all | --release]" >&2; exit 1 ;;
esac
begun=$(date +%s)
after() { echo "$(($(date +%s) - begun)) s"; }      # since the beginning: what takes long shows
for kind in $kinds; do      # all at once, as what runs side by side must not wait for the other's apt
  tools/install_dependencies.sh "$kind"
done
. tools/compiler_cache.sh
mkdir -p build
echo "installed after $(after)"

passed=0; failed=0; skipped=0; failures=""; failing_logs=""
build() {   # build DIRECTORY OPTIONS...; only the targets in $targets, if there are any
  directory=$1; shift
  cmake -S . -B "$directory" -G Ninja -DREFRACT_WERROR=ON "$@" >"$directory.log" 2>&1 || { cat "$directory.log"; exit 1; }
  # shellcheck disable=SC2086  # names without blanks
  cmake --build "$directory" --target ${targets:-all}
  echo "built after $(after): $directory"
}
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
suite() {   # suite NAME BUILD OPTIONS_OF_CTEST...: counts its tests one by one
  name=$1; directory=$2; shift 2
  log=build/$(echo "$name" | tr -c 'a-z0-9\n' _).log
  rm -f "$log.xml"
  ctest --test-dir "$directory" -j "$(nproc)" --timeout 1500 --output-on-failure --output-junit "$PWD/$log.xml" "$@" >"$log" 2>&1 ||
    true
  cp "$directory/Testing/Temporary/LastTest.log" "$log.all"
  grep '^\[numbers\]' "$log.all" || true
  count() { sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p" "$log.xml" | head -n 1; }
  total=0; f=1; s=0       # no tests, or a ctest that died, is a failure
  if [ -s "$log.xml" ] && [ "$(count tests)" -gt 0 ]; then
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
  echo "It took $(after)."
  echo "$passed passed, $failed failed, $skipped skipped"
  [ $failed = 0 ]
  exit
}

if [ $scope = quick ]; then
  build build/release -DREFRACT_BUILD_BENCH=OFF -DREFRACT_BUILD_SAMPLES=OFF
  suite "tests" build/release -LE slow
  finish
fi

. test/gate.sh
[ $scope = --all ] || . test/release.sh
finish
