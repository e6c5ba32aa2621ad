#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Builds the Python package as a wheel and tests it beside Debian's OpenCV and NumPy, and beside pip's OpenCV 4 and 5
# with their NumPy 2. Everything is kept in build/python: a second run takes a minute or two.
#
# Usage: test/python.sh [--fast]      --fast leaves out pip's OpenCV 5, the samples and the paper's experiments
# Ends with 77 if pip reaches no package registry, or trusts none. REFRACT_OPENCV_SOURCE: see doc/howto_python.md.
set -eu
cd "$(dirname "$0")/.."
fast=no
[ "${1:-}" = --fast ] && fast=yes
python=/usr/bin/python3     # Debian's own: Debian's cv2 is for it
work=$PWD/build/python
mkdir -p "$work"

tools/install_dependencies.sh build
missing=""
for package in python3-venv python3-dev python3-opencv; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $package"
done
if [ -n "$missing" ]; then
  [ "$(id -u)" = 0 ] || { echo "skipped: install these packages as root: apt-get install$missing"; exit 77; }
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086  # a list of package names
  { apt-get update -qq && apt-get install -y -qq --no-install-recommends $missing; } >"$work/apt.log" 2>&1 ||
    { tail -5 "$work/apt.log"; echo "skipped: apt-get could not install$missing"; exit 77; }
fi

environment() {     # environment NAME VENV_OPTION... : makes build/python/NAME once, with pip that is not Debian's old one
  name=$1; shift
  [ -x "$work/$name/bin/pip" ] || "$python" -m venv "$@" "$work/$name"
}
environment build
if ! "$work/build/bin/pip" download -q --no-deps -d "$work/reach" pytest >"$work/pip.log" 2>&1; then
  tail -3 "$work/pip.log"
  why="pip reaches no package registry"
  grep -q CERTIFICATE_VERIFY_FAILED "$work/pip.log" &&
    why="pip does not trust the registry's certificate; set PIP_CERT to a file with the certificate of its authority"
  echo "skipped: $why"; exit 77
fi

# A build directory of its own makes the next build an incremental one. The compiler by the name that other builds have: what the
# cache keeps of them serves here, too.
. tools/compiler_cache.sh
CC=$(command -v cc) CXX=$(command -v c++)
export CC CXX
rm -rf "$work/wheel"
"$work/build/bin/pip" wheel --no-deps -w "$work/wheel" --config-settings=build-dir="$work/cmake" . >"$work/wheel.log" 2>&1 ||
  { tail -40 "$work/wheel.log"; exit 1; }
ls "$work"/wheel/*.whl

check() {           # check NAME PYTEST_OPTION... : installs the wheel and runs the tests
  name=$1; shift
  "$work/$name/bin/pip" install -q --no-deps --force-reinstall "$work"/wheel/*.whl
  "$work/$name/bin/python" -c "import cv2, numpy, sys, opencv_refract as refract
print('Python', sys.version.split()[0], 'NumPy', numpy.__version__, 'cv2', cv2.__version__, 'opencv_refract',
      refract.__version__, 'cv2.refract' if cv2.refract is refract else '')"
  "$work/$name/bin/python" -m pytest -q -p no:cacheprovider "$@" python/tests
}

samples="--ignore=python/tests/test_samples.py --ignore=python/tests/test_paper_experiments.py"
environment debian --system-site-packages
"$work/debian/bin/pip" install -q pytest
# shellcheck disable=SC2086  # two options
check debian $samples
environment opencv4
"$work/opencv4/bin/pip" install -q 'opencv-python-headless<5' matplotlib pytest
if [ $fast = yes ]; then
  check opencv4 $samples
else
  check opencv4
  environment opencv5
  "$work/opencv5/bin/pip" install -q 'opencv-python-headless>=5,<6' pytest
  # shellcheck disable=SC2086  # two options
  check opencv5 $samples
  # The types, in the eyes of the checkers that this was written with: a later one may want something else.
  environment types
  "$work/types/bin/pip" install -q mypy==2.4.1 'pyright[nodejs]==1.1.414' opencv-python-headless==5.0.0.93 numpy==2.4.6 matplotlib==3.11.2
  "$work/types/bin/pip" install -q --no-deps --force-reinstall "$work"/wheel/*.whl
  "$work/types/bin/python" python/tests/check_types.py
fi
