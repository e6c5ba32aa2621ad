#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Installs a build into an empty prefix and builds a program on it, by find_package and by pkg-config.
# Usage: test/consumer/run.sh BUILD_DIRECTORY
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$here" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/cmake" >/dev/null
"$work/cmake/consumer"
libdir=$(dirname "$(find "$work/prefix" -name libopencv_refract.so)")
PKG_CONFIG_PATH=$libdir/pkgconfig
export PKG_CONFIG_PATH
# shellcheck disable=SC2046  # flags are words
c++ -std=c++11 "$here/consumer.cpp" -o "$work/consumer" $(pkg-config --cflags --libs opencv_refract)
LD_LIBRARY_PATH=$libdir "$work/consumer"

# The kinds of camera are the library's own.
cat >"$work/outsider.cpp" <<'EOF'
#include <opencv2/refract.hpp>
struct Outsider : cv::refract::RefractiveCamera { Outsider() : cv::refract::RefractiveCamera() {} };
EOF
# shellcheck disable=SC2046
if c++ -std=c++11 -fsyntax-only "$work/outsider.cpp" $(pkg-config --cflags opencv_refract) 2>"$work/outsider.log" ||
   ! grep -q "is private" "$work/outsider.log"; then
  echo "FAILED: others can derive from RefractiveCamera" >&2; exit 1
fi
