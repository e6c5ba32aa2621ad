#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Prints what a call of the module costs from Python, beside the same call from C++ in the same process.
#
# Usage: bench/python_overhead/run.sh [BUILD_DIRECTORY [POINTS]]    build/release by default; test/run.sh makes it and
#                                                                   the Python environment that is measured
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
python=build/python/debian/bin/python
"$python" -c "import opencv_refract" || { echo "test/python.sh makes the environment that is measured" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "${1:-build/release}" --prefix "$work" >/dev/null
libdir=$(dirname "$(find "$work" -name libopencv_refract.so)")
# shellcheck disable=SC2046  # flags are words
c++ -std=c++11 -O2 -shared -fPIC "$here/calls.cpp" -o "$work/libcalls.so" \
  $(PKG_CONFIG_PATH="$libdir/pkgconfig" pkg-config --cflags --libs opencv_refract)
LD_LIBRARY_PATH=$libdir exec "$python" -B "$here/overhead.py" "$work/libcalls.so" ${2:+"$2"}
