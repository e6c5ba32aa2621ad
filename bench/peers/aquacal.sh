#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# refract_calib beside aquacal 2.1.0 (of the Python registry, in an environment that is thrown away): cameras in air over one surface of
# water, aquacal's own two scenarios, the same detections for both, the lens and the index of water known to both. Prints the largest
# errors of the cameras' places against the truth, processor times and their ratio.
#
# Usage: bench/peers/aquacal.sh [SEED [LIMIT_OF_REALISTIC]]
#   seed 42; aquacal's realistic scenario (12 cameras) is ended after LIMIT_OF_REALISTIC seconds on the clock, 1500
set -eu
cd "$(dirname "$0")/../.."
seed=${1:-42}
limit=${2:-1500}
calib=$PWD/build/release/bin/refract_calib
[ -x "$calib" ] || { echo "there is no $calib: build the tools first" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q --disable-pip-version-check 'aquacal==2.1.0' >"$folder/pip.log" 2>&1 ||
  { tail -n 3 "$folder/pip.log" >&2; echo "skipped: pip gets no aquacal 2.1.0" >&2; exit 1; }
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
peer() { "$folder/venv/bin/python" bench/peers/aquacal_scenarios.py "$@"; }

echo "| scenario | who | rotation, degrees | centre, mm | surface, mm | processor time, s |"
echo "|---|---|---|---|---|---|"
for scenario in minimal realistic; do
  work=$folder/$scenario
  peer write $scenario "$seed" "$work"
  # The options are in a file, a word a line: each camera has two.
  # shellcheck disable=SC2046  # words without blanks
  peer time "$work/refract.time" "$calib" $(cat "$work/options") --out="$work/calib.yml" --quiet --no-cross-validation || true
  peer compare $scenario "$seed" "$work" refract
  [ $scenario = minimal ] && seconds=1500 || seconds=$limit
  timeout "$seconds" "$folder/venv/bin/python" bench/peers/aquacal_scenarios.py solve $scenario "$seed" "$work" >"$work/log" 2>&1 || {
    [ $? = 124 ] && why="no answer within $seconds s on the clock" || why="failed: $(tail -n 1 "$work/log")"
    echo "| $scenario | aquacal | $why | | | |"; continue
  }
  peer compare $scenario "$seed" "$work" aquacal
done
