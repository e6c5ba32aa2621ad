#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Installs what refract builds and runs with on Debian (root needed only if something is missing).
# Usage: tools/install_dependencies.sh
#            [build|test|lint|in-tree|wheel|aarch64|powerpc64le|riscv64|windows|fuzz|bare|site|libraries]
#   build has a compiler cache and a fast linker, too; test adds what only the tests use, lint what tools/lint.sh does, in-tree
#   what OpenCV's own build needs, wheel what the self-contained Python package does, aarch64 (and so on) what compiles for
#   that processor and runs it, windows what compiles for that system, fuzz the compiler that the fuzzers want, site what makes
#   and tests the documentation's site; bare: what makes a bare Debian to try things in; libraries installs nothing, but names
#   what a root of another architecture must hold
set -eu

libraries="libopencv-dev libopencv-contrib-dev libeigen3-dev libceres-dev
  libcli11-dev nlohmann-json3-dev libkainjow-mustache-dev libcairo2-dev libmbedtls-dev zlib1g-dev"
test_libraries="catch2 libgtest-dev libmrcal-dev"
test_programs="file libxml2-utils locales poppler-utils lintian"      # cpack makes the packages with file, lintian checks them;
                                                      # tests make a locale, see PDFs, validate XML
build="build-essential ccache cmake gnuplot-nox mold ninja-build pkg-config $libraries"
in_tree="python3-pip python3-dev python3-numpy"

case "${1:-build}" in
  build) wanted=$build ;;
  test) wanted="$build $test_libraries $test_programs" ;;
  lint) wanted="python3-venv shellcheck" ;;
  in-tree) wanted="$build $in_tree" ;;
  wheel) wanted="$build python3-venv python3-dev dpkg-dev libutfcpp-dev libstb-dev" ;;
  aarch64 | powerpc64le) wanted="$build g++-$1-linux-gnu qemu-user" ;;
  riscv64) wanted="$build g++-$1-linux-gnu clang-14 qemu-user" ;;     # g++ for its libraries
  windows) wanted="$build libgtest-dev g++-mingw-w64-x86-64-posix" ;;
  fuzz) wanted="$build clang-14 libclang-rt-14-dev" ;;
  bare) wanted="debootstrap git ca-certificates util-linux" ;;
  site) wanted="doxygen libjs-mathjax python3 chromium" ;;
  libraries) echo "$libraries $test_libraries"; exit 0 ;;
  *) echo "usage: $0 [build|test|lint|in-tree|wheel|aarch64|powerpc64le|riscv64|windows|fuzz|bare|site|libraries]" >&2; exit 1 ;;
esac

missing=""
for package in $wanted; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" != 0 ]; then
  echo "These packages are missing; install them as root: apt-get install$missing" >&2
  exit 1
fi
echo "Installing:$missing"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
# shellcheck disable=SC2086  # a list of package names
apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=300 $missing
