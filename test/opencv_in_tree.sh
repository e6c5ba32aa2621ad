#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Builds modules/refract unchanged inside OpenCV's own tree and tests it there: warnings as errors in the module, its ts
# tests, one pass of its performance tests, its sample, its Python test, its documentation; its tests where Ceres and
# Eigen are missing, too. Everything is kept in build/opencv-VERSION: the first run
# compiles OpenCV (some 15 minutes on two cores), the next ones only what has changed.
#
# Usage: test/opencv_in_tree.sh 4.14.0.94|5.0.0.93 [--short | --with-ceres | --without-ceres]
#   the version is one of the package opencv-contrib-python-headless, whose source holds OpenCV's
#   --short reads the module, its tests and its sample in the tree (OpenCV 4 with Ceres, 5 without), and generates its Python
#           bindings, but neither compiles OpenCV nor runs anything
#   --with-ceres, --without-ceres: of the rest what is tested with Ceres and Eigen, or without
set -eu
cd "$(dirname "$0")/.."
version=${1:-}
part=${2:-all}
case "$version $part" in
  4.14.0.94\ all | 5.0.0.93\ all | 4.14.0.94\ --short | 5.0.0.93\ --short) ;;
  4.14.0.94\ --with*-ceres | 5.0.0.93\ --with*-ceres) ;;
  *) echo "usage: $0 4.14.0.94|5.0.0.93 [--short | --with-ceres | --without-ceres]" >&2; exit 1 ;;
esac

tools/install_dependencies.sh in-tree
. tools/compiler_cache.sh
. test/opencv_source.sh
opencv_source "$version"
build=$work/build

configure() {   # configure DIRECTORY OPTIONS...: the smallest OpenCV that holds refract, its tests and Python
  directory=$1; shift
  off=""
  for part in ADE AVIF FFMPEG FLATBUFFERS GSTREAMER GTK IPP ITT JASPER JPEG LAPACK OBSENSOR OPENCL OPENEXR OPENJPEG \
              PROTOBUF QUIRC TIFF UNIFONT V4L VULKAN WEBP; do
    off="$off -DWITH_$part=OFF"
  done
  # shellcheck disable=SC2086  # lists of options
  cmake -S "$source" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release $off \
    -DOPENCV_EXTRA_MODULES_PATH="$PWD/modules" -DBUILD_LIST=refract,ts,python3,python_tests \
    -DOPENCV_CMAKE_HOOKS_DIR="$PWD/test/opencv_hooks" \
    -DBUILD_TESTS=ON -DBUILD_PERF_TESTS=ON -DBUILD_EXAMPLES=ON -DBUILD_DOCS=ON -DBUILD_opencv_apps=OFF \
    -DBUILD_JAVA=OFF -DCPU_DISPATCH=AVX2,AVX512_SKX -DENABLE_PRECOMPILED_HEADERS=OFF -DPYTHON3_EXECUTABLE="$python" \
    "$@" >"$directory.log" 2>&1 || { cat "$directory.log"; exit 1; }
}

commands() {    # commands DIRECTORY: what compiles the module's files there, one a line
  # Ninja would build what these stand on first, so the compiler is called directly; it only looks, so without -O3.
  ninja -C "$1" -t compdb | "$python" -c 'import json, sys
for unit in json.load(sys.stdin):
    if "/modules/refract/" in unit["file"] and unit["output"].endswith(".o"): print(unit["command"].replace("-O3", "-O0"))'
}
compile() {     # compile DIRECTORY COMMANDS
  [ -s "$2" ] || { echo "FAILED: no file of the module is to be compiled" >&2; exit 1; }
  (cd "$1" && tr '\n' '\0' <"$2" | xargs -0 -n 1 -P "$(nproc)" sh -ec)
}
without_ceres() {   # without_ceres DIRECTORY COMMANDS: that it is built, without the calibrators; what compiles it, one a line
  grep -q "^-- *To be built:.* refract" "$1.log" && grep -q "refract: without Ceres, so calibrateGlass" "$1.log" ||
    { echo "FAILED: without Ceres OpenCV does not build refract: $1.log" >&2; exit 1; }
  commands "$1" >"$2"
  if grep "calibrate_rig\|/test_calibration" "$2"; then
    echo "FAILED: without Ceres calibrators are compiled" >&2; exit 1
  fi
}

looks_only() {  # looks_only COMMANDS OPTIONS...: the same commands, that the compiler only reads
  file=$1; shift
  sed "s/ -o / $* -fsyntax-only&/" "$file" >"$file.looks"
  compile "$build" "$file.looks"
}
universal() {   # OpenCV's universal intrinsics, of every level, as compilers without vector types get them
  commands "$build" | grep dispatch/kernels_ >"$work/commands_universal.txt"
  looks_only "$work/commands_universal.txt" -DREFRACT_UNIVERSAL_INTRINSICS -Wno-uninitialized -Wno-maybe-uninitialized
  echo "passed: kernels on OpenCV $version's universal intrinsics"
}

if [ $part = --short ]; then   # of the four combinations the diagonal: OpenCV 4 with Ceres, 5 without
  case $version in
    4.*) configure "$build" -DREFRACT_WITH_CERES=AUTO
         commands "$build" >"$work/commands.txt" ;;
    *) configure "$build" -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON
       without_ceres "$build" "$work/commands.txt" ;;
  esac
  looks_only "$work/commands.txt"
  universal
  # OpenCV warns, at length, that a tree without its other modules has no typing stubs.
  ninja -C "$build" gen_opencv_python_source >"$work/python.log" 2>&1 || { cat "$work/python.log"; exit 1; }
  grep -q triangulateRefractive "$build/modules/python_bindings_generator/pyopencv_generated_funcs.h"
  echo "passed: OpenCV $version's build reads $(wc -l <"$work/commands.txt") files of the module and generates its Python bindings"
  exit 0
fi

tests() {       # the module's own, in C++ and Python
  "$build/bin/opencv_test_refract"
  PYTHONPATH=$build/python_loader:$source/modules/python/test \
    "$python" -B modules/refract/misc/python/test/test_refract.py
}
if [ $part != --with-ceres ]; then
  # Where one of the two is missing the module is built all the same: in OpenCV 4 as C++14, as it is Ceres that asks for C++17.
  for missing in -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DWITH_EIGEN=OFF; do
    configure "$work/without" $missing
    without_ceres "$work/without" "$work/commands_without.txt"
    echo "passed: left the calibrators out with $missing"
  done
  compile "$work/without" "$work/commands_without.txt"
  rm -rf "$work/without"
  echo "passed: compiled so"

  configure "$build" -DREFRACT_WITH_CERES=OFF
  without_ceres "$build" "$work/commands_without.txt"
  ninja -C "$build" opencv_test_refract opencv_python3
  tests
  rm "$build"/lib/libopencv_refract.so*      # test/agreement/run.sh compares those with Ceres
  echo "passed: OpenCV $version, without Ceres"
fi
[ $part != --without-ceres ] || exit 0

configure "$build" -DREFRACT_WITH_CERES=AUTO
universal
ninja -C "$build" opencv_test_refract opencv_perf_refract opencv_python3 example_refract_measure_behind_glass
tests
"$build/bin/opencv_perf_refract" --perf_min_samples=1 --perf_force_samples=1
"$build/bin/example_refract_measure_behind_glass"

# Typing stubs: OpenCV writes them only where all of its own modules are wrapped, too. That takes their headers alone.
rm -rf "$work/stubs"
configure "$work/stubs" -DBUILD_LIST=
ninja -C "$work/stubs" gen_opencv_python_source
stubs=$work/stubs/modules/python_bindings_generator/cv2/refract/__init__.pyi
grep -q "^def triangulateRefractive" "$stubs" || { echo "FAILED: no typing stubs for Python: $stubs" >&2; exit 1; }
echo "passed: typing stubs"

# OpenCV's documentation, of this module and of what its text refers to (calib3d is geometry since OpenCV 5).
if command -v doxygen >/dev/null && command -v bibtex >/dev/null; then
  mkdir -p "$work/doc"
  { cat "$build/doc/Doxyfile"
    echo "INPUT = $build/doc/contrib_tutorials.markdown modules/refract/include modules/refract/tutorials"
    for module in core calib3d geometry; do echo "INPUT += $source/modules/$module/include"; done
    echo "OUTPUT_DIRECTORY = $work/doc"
    echo "HAVE_DOT = NO"
  } | doxygen - >"$work/doc.log" 2>&1
  if grep "modules/refract" "$work/doc.log"; then echo "FAILED: documentation" >&2; exit 1; fi
  echo "passed: documentation"
else
  echo "skipped: documentation (needs doxygen, and bibtex of texlive-base)"
fi
echo "passed: OpenCV $version"
