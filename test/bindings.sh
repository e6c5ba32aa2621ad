#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Writes the Python bindings for the header of every OpenCV that the package is built on: Debian's, 4.14 and 5.0, as their
# persistence.hpp differ. Nothing is compiled. Also: a type that nobody knows is named, with its file and line. Seconds, once the
# sources of OpenCV are there.
#
# Usage: test/bindings.sh
# Ends with 77 if pip cannot get the sources.
set -eu
cd "$(dirname "$0")/.."
tools/install_dependencies.sh in-tree
. test/opencv_source.sh
opencv_source 5.0.0.93
headers="/usr/include/opencv4 $source/modules/core/include"
opencv_source 4.14.0.94         # the one whose generator the package takes
headers="$headers $source/modules/core/include"
generator=$source/modules/python/src2
made=$PWD/build/bindings
rm -rf "$made"
mkdir -p "$made/opencv2/core"

generate() {    # generate PERSISTENCE_HEADER
  "$python" -B python/generator/generate_bindings.py "$generator" "$made/out" "$1" modules/refract/include/opencv2/refract.hpp \
    modules/refract/misc/python/pyopencv_*.hpp >"$made/log" 2>&1
}
for include in $headers; do
  generate "$include/opencv2/core/persistence.hpp" || { cat "$made/log"; echo "FAILED: $include"; exit 1; }
  "$python" -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' "$made/out/__init__.pyi"
  forms=$(sed -n 's/.*Call call = { "FileStorage.write", [a-z_]*, \([0-9]*\), .*/\1/pI' "$made/out/pyopencv_generated_types_content.h")
  echo "passed: $include, FileStorage.write in $forms forms"
done

# The last of the headers with one more form of write.
unknown=$made/opencv2/core/persistence.hpp
sed 's/^ *CV_WRAP void write(const String& name, double val);/&\n    CV_WRAP void write(const String\& name, Unheard val);/' \
  "$include/opencv2/core/persistence.hpp" >"$unknown"
line=$(grep -n Unheard "$unknown" | cut -d : -f 1)
expected="$unknown:$line: write: val has the type Unheard,"
if generate "$unknown" || ! grep -qF "$expected" "$made/log" || grep -q Traceback "$made/log"; then
  cat "$made/log"; echo "FAILED: a type that nobody knows: \"$expected\" is not said"; exit 1
fi
echo "passed: $(cat "$made/log")"
