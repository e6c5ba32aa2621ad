#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# The main job on the bundled images: calibrates a stereo pair behind two tilted windows, measures fresh boards with it, and
# compares with what one would do instead. Installs what is missing, builds, runs; ends with a table and a report to look at.
set -eu
cd "$(dirname "$0")/.."
begun=$(date +%s)
tools/install_dependencies.sh build
. tools/compiler_cache.sh

installed=$(date +%s)
mkdir -p build out
# Warnings are errors where it is known that there are none (g++ of Debian 12 and 13): so test/run.sh compiles, and each finds in the
# compiler's cache what the other has compiled.
case $(c++ -dumpversion) in
  12 | 14) werror=ON ;;
  *) werror=OFF ;;
esac
cmake -S . -B build/demo -G Ninja -DREFRACT_WERROR=$werror -DREFRACT_BUILD_TESTS=OFF -DREFRACT_BUILD_SAMPLES=OFF \
      -DREFRACT_BUILD_BENCH=OFF >build/demo.log || { cat build/demo.log; exit 1; }
# What is run below, and no more.
cmake --build build/demo --target refract_calib refract_measure refract_epilines refract_stereo
built=$(date +%s)

bin=build/demo/bin
data=samples/data/stereo
target="--pattern=chessboard --size=6x5 --square=39"

# shellcheck disable=SC2086  # the target is three options
$bin/refract_calib $target --thickness=20 --index=1.5437 \
  --direct="$data/direct1/*" --glass="$data/glass1/*" --direct="$data/direct2/*" --glass="$data/glass2/*" \
  --out=out/calib.yml --report=out/report.html --pinhole-out=out/pinhole_through_glass.yml

for range in z540 z600 z800 z1200; do
  echo
  echo "Fresh boards at about ${range#z} mm:"
  # shellcheck disable=SC2086
  $bin/refract_measure out/calib.yml "$data/measure1/${range}_*" "$data/measure2/${range}_*" $target \
    --compare --compare-with=out/pinhole_through_glass.yml --out="out/points_$range.csv"
done
$bin/refract_epilines out/calib.yml "$data/measure1/z600_1.jpg" "$data/measure2/z600_1.jpg" $target --out=out/epilines.png

echo
echo "A whole scene through two tilted windows of 25 mm:"
scene=samples/data/scene
$bin/refract_stereo $scene/truth.yml $scene/glass1/scene.jpg $scene/glass2/scene.jpg --depth=400,1300 \
  --out=out/scene.ply --picture=out/scene_depth.png

echo
echo "Look at out/report.html (the calibration), out/epilines.png (where partners lie), out/scene_depth.png and out/scene.ply (the"
echo "depth of the scene $scene/glass1/scene.jpg)."
now=$(date +%s)
echo "It took $((now - begun)) s: installing $((installed - begun)), compiling $((built - installed)), calibrating and measuring" \
     "$((now - built))."
