#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Computes the same hundred values with every build of the module that is there (C++ and Python; standalone, and inside
# OpenCV's tree as test/opencv_in_tree.sh leaves it) and prints them as one table: equal to 1e-12, relative.
#
# Usage: test/agreement/run.sh [BUILD_DIRECTORY]     build/release by default; test/run.sh and test/python.sh make what
#                                                    is compared
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
build=${1:-build/release}
python=/usr/bin/python3                 # the one that in-tree builds belong to
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

columns=""
compute() {     # compute COLUMN COMMAND...
  column=$1; shift
  "$@" >"$work/$column.txt"
  columns="$columns $work/$column.txt"
}
compiled() {    # compiled COLUMN CMAKE_OPTION...
  column=$1; shift
  cmake -S "$here" -B "$work/$column" -DCMAKE_BUILD_TYPE=Release "$@" >"$work/$column.log" 2>&1 &&
    cmake --build "$work/$column" >>"$work/$column.log" 2>&1 || { cat "$work/$column.log"; exit 1; }
  compute "$column" "$work/$column/values"
}

cmake --install "$build" --prefix "$work/prefix" >/dev/null
compiled c++ -DCMAKE_PREFIX_PATH="$work/prefix"
for environment in debian opencv4 opencv5; do
  interpreter=build/python/$environment/bin/python
  if "$interpreter" -c "import opencv_refract" 2>/dev/null; then
    compute "python-$environment" "$interpreter" -B "$here/values.py"
  fi
done
for tree in build/opencv-*/build; do
  [ -e "$tree/lib/libopencv_refract.so" ] || continue
  version=$(basename "$(dirname "$tree")" | sed 's/^opencv-\([0-9]*\.[0-9]*\).*/\1/')
  compiled "c++-$version" -DOpenCV_DIR="$PWD/$tree"
  compute "python-$version" env PYTHONPATH="$tree/python_loader" "$python" -B "$here/values.py"
done
case $columns in
  *" "*" "*) ;;
  *) echo "skipped: only one build is there, nothing to compare with"; exit 77 ;;
esac
# shellcheck disable=SC2086  # a list of files
"$python" -B "$here/compare.py" $columns
