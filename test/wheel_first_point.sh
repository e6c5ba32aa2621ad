#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# What test/wheel.sh runs in a bare Debian, in a folder that has packages/ and samples/: from pip to points and a report.
set -eu
cd "$(dirname "$0")"
for program in cc gcc c++ g++ clang cmake make gnuplot; do
  ! command -v $program >/dev/null || { echo "this machine is not bare: it has $program" >&2; exit 1; }
done
mkdir -p out
data=samples/data/stereo
begun=$(date +%s.%N)
after() { echo "after $(awk "BEGIN { print $(date +%s.%N) - $begun }") s: $*"; }

python3 -m venv "an environment"       # whose name has a space
PATH="$PWD/an environment/bin:$PATH"
pip install -q --disable-pip-version-check --no-index --find-links packages opencv-refract
after "installed on $(python3 --version), Debian $(cat /etc/debian_version)"
refract_calib --pattern=chessboard --size=6x5 --square=39 --thickness=20 --index=1.5437 \
  --direct="$data/direct1/*" --glass="$data/glass1/*" --direct2="$data/direct2/*" --glass2="$data/glass2/*" \
  --out=out/calib.yml --report=out/report.html >out/calib.txt 2>out/calib.err
if grep "[.]cc:" out/calib.err; then echo "Ceres talks" >&2; exit 1; fi
grep -q "<svg" out/report.html
after "calibrated: $(grep -m 1 -i 'good\|usable' out/calib.txt)"
refract_measure out/calib.yml "$data/measure1/z600_*" "$data/measure2/z600_*" --pattern=chessboard --size=6x5 --square=39 \
  --out=out/points.csv >out/measure.txt
after "measured: $(sed -n 2p out/points.csv)"
seconds=$(awk "BEGIN { print int($(date +%s.%N) - $begun) }")

refract_board --pattern=chessboard --size=9x6 --square=25 --out=out/board.pdf >/dev/null
refract_undistort out/calib.yml "$data/glass1/pair1.jpg" --depth=600 --out-dir=out >/dev/null
pip install -q --disable-pip-version-check --no-index --find-links packages opencv-python-headless
python3 samples/python/measure_stereo_behind_glass.py
after "the drop-in sample beside cv2"
[ "$seconds" -le 60 ] || { echo "$seconds s from pip to the first point: above a minute" >&2; exit 1; }
