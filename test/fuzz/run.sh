#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Feeds every parser and every public call with made-up input (libFuzzer, address and undefined-behaviour sanitizers): first the
# inputs that once were findings, each once, then the corpus and what is mutated from it. A crash, a sanitizer's report, an
# exception that no caller expects, an answer that breaks a promise of refract.hpp, or more than ten seconds for one input (a
# minute without options: a gate may run beside anything) is a finding; its input is left in build/sanitize/findings. Prints
# what was run of each harness, and ends non-zero on any finding.
#
# Usage: test/fuzz/run.sh [SECONDS | --runs=N] [HARNESS...]     3000 inputs or ten seconds each of all harnesses; --runs=N: N inputs
set -eu
cd "$(dirname "$0")/../.."
limit="-max_total_time=10 -runs=3000 -seed=1 -timeout=60"      # the same inputs on every machine: a gate is no place for news
case ${1:-} in
  --runs=*) limit="-runs=${1#--runs=} -timeout=10"; shift ;;
  [0-9]*) limit="-max_total_time=$1 -timeout=10"; shift ;;
esac

tools/install_dependencies.sh fuzz
. tools/compiler_cache.sh
build=build/sanitize        # as test/run.sh has it
mkdir -p build
cmake -S . -B $build -G Ninja -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG="-O1 -gline-tables-only" -DREFRACT_SANITIZE=address,undefined -DREFRACT_BUILD_FUZZ=ON \
  -DREFRACT_BUILD_BENCH=OFF >$build.log 2>&1 || { cat $build.log; exit 1; }
cmake --build $build --target fuzzers
# shellcheck disable=SC2046  # names without blanks
[ $# != 0 ] || set -- $(ls test/fuzz/fuzz_*.cpp | sed 's,.*/fuzz_\(.*\)\.cpp,\1,')

# Ceres and OpenCV keep their thread pools until the process ends: leaks are not what this looks for.
ASAN_OPTIONS=detect_leaks=0:malloc_context_size=6:quarantine_size_mb=16
export ASAN_OPTIONS limit
mkdir -p $build/findings $build/logs
# Corpora grow in the build directory; what is committed is only read. Whole paths, as a harness may change its folder.
printf '%s\n' "$@" | xargs -P "$(nproc)" -I NAME sh -c '
  mkdir -p "$0/build/sanitize/corpus/NAME"
  exec >build/sanitize/logs/NAME.log 2>&1
  options="-rss_limit_mb=3072 -artifact_prefix=$0/build/sanitize/findings/NAME-"
  set -- "$0"/test/fuzz/regressions/NAME/*
  [ ! -e "$1" ] || build/sanitize/bin/fuzz_NAME $options ${limit##* } "$@" || exit 0
  build/sanitize/bin/fuzz_NAME $options -max_len=4096 -print_final_stats=1 $limit \
    "$0/build/sanitize/corpus/NAME" "$0/test/fuzz/corpus/NAME" && echo "no finding"
  exit 0' "$PWD"

failed=0
printf '%-18s %12s %10s %10s   %s\n' harness inputs edges features ''
for name in "$@"; do
  log=$build/logs/$name.log
  last=$(grep -E '^#[0-9]+.* cov: ' "$log" | tail -n 1)
  inputs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -n 1)
  result="no finding"
  if ! grep -q '^no finding$' "$log"; then
    result="FAILED: $log"; failed=$((failed + 1))
  fi
  printf '%-18s %12s %10s %10s   %s\n' "$name" "${inputs:-0}" "$(echo "$last" | sed -n 's/.* cov: \([0-9]*\).*/\1/p')" \
    "$(echo "$last" | sed -n 's/.* ft: \([0-9]*\).*/\1/p')" "$result"
done
[ $failed = 0 ]
