#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Compares what the shared library exports with test/exports.txt, the committed list: one demangled name a line, sorted. Fails,
# too, on a name that is not in cv::refract or that refract.hpp does not have.
#
# Usage: test/exports.sh [BUILD_DIRECTORY] [--write]     build/release by default; --write makes the list anew
set -eu
cd "$(dirname "$0")/.."
list=test/exports.txt
write=no; build=build/release
for argument in "$@"; do
  case $argument in
    --write) write=yes ;;
    -*) echo "usage: $0 [BUILD_DIRECTORY] [--write]" >&2; exit 1 ;;
    *) build=$argument ;;
  esac
done
library=$build/libopencv_refract.so
[ -e "$library" ] || { echo "$library is missing: build the target opencv_refract first" >&2; exit 1; }
LC_ALL=C; export LC_ALL

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
nm --dynamic --demangle --defined-only "$library" | cut -d ' ' -f 3- | sort -u >"$work/exports"

# A name as a caller writes it: "cv::refract::GlassWindow::read(cv::FileNode const&)" is read; [abi:...] is the compiler's.
foreign=$(grep -v -E '^((vtable|typeinfo|typeinfo name) for )?cv::refract::' "$work/exports") || true
names=$(sed -E 's/^(vtable|typeinfo|typeinfo name) for //; s/\(.*//; s/\[abi:.*\]//; s/.*:://; s/^~//' "$work/exports" | sort -u)
private=$(for name in $names; do
  grep -q -w -F "$name" modules/refract/include/opencv2/refract.hpp || echo "$name"
done)
if [ -n "$foreign$private" ]; then
  echo "exported, but not of cv::refract as refract.hpp has it (CV_EXPORTS where it should not be?):"
  printf '%s\n' $private "$foreign"
  exit 1
fi >&2

if [ $write = yes ]; then
  cp "$work/exports" "$list"
elif ! diff -u "$list" "$work/exports" >"$work/difference"; then
  sed -n '3,$s/^[-+]/&/p' "$work/difference"
  echo "the library exports something else than $list says. Where a line is gone (-), programs built before no longer start:"
  echo "give the project another minor version, which is the library's SONAME. Then, or where lines were only added (+):"
  echo "$0 $build --write"
  exit 1
fi >&2
echo "$(wc -l <"$work/exports") exported names, all of them of cv::refract"
