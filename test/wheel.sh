#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Makes the self-contained wheel (packaging/wheel/build.sh) and installs it where users have it:
#   - beside OpenCV for Python 4.6, 4.14 and 5, with and without contrib, headless or not, Debian's, and none, with NumPy 1.24
#     and 2, on every Python from 3.9 on that is found (on PATH, or of pyenv): the package's tests, and the same hundred values
#   - in a bare Debian 12 and 13 (debootstrap, as root) without compiler: pip, refract_calib on the bundled images with its
#     report, refract_measure, and the drop-in sample; how long that takes is printed, and above a minute it fails
# Everything but the bare roots is kept in build/wheel. Downloads half a GB.
#
# Usage: test/wheel.sh [RELEASE...]      the Debian releases to try, by default bookworm and trixie
# Ends with 77 if pip reaches no package registry.
set -eu
cd "$(dirname "$0")/.."
[ $# != 0 ] || set -- bookworm trixie
packaging/wheel/build.sh
dpkg-query -W python3-opencv >/dev/null 2>&1 || apt-get install -y -qq --no-install-recommends python3-opencv >/dev/null
wheel=$(ls build/wheel/dist/*.whl)
try=$PWD/build/wheel/try
rm -rf "$try"
mkdir -p "$try/values"

# ---- nothing of OpenCV or Ceres can be seen from outside
mkdir "$try/unpacked"
python3 -m zipfile -e "$wheel" "$try/unpacked"
seen=$(nm --dynamic --defined-only "$try"/unpacked/opencv_refract/_native.abi3.so | sed 's/.* //')
[ "$seen" = PyInit__native ] || { echo "FAILED: the extension exports $seen" >&2; exit 1; }

# ---- beside every OpenCV
interpreter_of() {      # interpreter_of VERSION: prints a Python of that version, if there is one
  for candidate in "python$1" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$1".*/bin/python; do
    if "$candidate" -c 'import venv' 2>/dev/null; then echo "$candidate"; return; fi
  done
}
failed=0
beside() {              # beside NAME PYTHON PACKAGES...: with exactly these
  name=$1; python=$2; shift 2
  interpreter=$(interpreter_of "$python")
  [ "$name" != debian ] || interpreter=/usr/bin/python3
  [ -n "$interpreter" ] || { echo "left out, as there is no Python $python: $name"; return; }
  system=""
  [ "$name" != debian ] || system=--system-site-packages
  "$interpreter" -m venv $system "$try/$name"
  "$try/$name/bin/pip" install -q --disable-pip-version-check pytest "$wheel" "$@" >"$try/$name.log" 2>&1 ||
    { tail -3 "$try/$name.log"; echo "FAILED: $name does not install"; failed=1; return; }
  "$try/$name/bin/python" -c "import sys, numpy, opencv_refract as refract
try:
    import cv2
    beside = 'cv2 ' + cv2.__version__
except ImportError:
    beside = 'no cv2'
print('$name: Python', sys.version.split()[0], 'NumPy', numpy.__version__, beside)"
  "$try/$name/bin/python" -m pytest -q -p no:cacheprovider --ignore=python/tests/test_samples.py \
    --ignore=python/tests/test_paper_experiments.py python/tests >"$try/$name.tests" 2>&1 ||
    { tail -40 "$try/$name.tests"; echo "FAILED: the tests beside $name"; failed=1; }
  tail -1 "$try/$name.tests"
  "$try/$name/bin/python" -B test/agreement/values.py >"$try/values/$name.txt" 2>"$try/$name.err"
  [ ! -s "$try/$name.err" ] || { echo "FAILED: it is not quiet:"; head -3 "$try/$name.err"; failed=1; }
}
beside none 3.9 'numpy==1.24.*'
beside opencv-4.6 3.10 'numpy==1.24.*' 'opencv-python==4.6.*'
beside debian 3.11
beside opencv-4.14 3.11 'numpy>=2' 'opencv-python==4.14.*'
beside contrib-4.14 3.12 'numpy>=2' 'opencv-contrib-python==4.14.*'
beside headless-5.0 3.13 'numpy>=2' 'opencv-python-headless==5.*'
beside contrib-headless-5.0 3.9 'opencv-contrib-python-headless==5.*'
python3 -B test/agreement/compare.py "$try"/values/*.txt || failed=1

# ---- on bare machines
for python in 3.11 3.13; do
  "$try/none/bin/pip" download -q --disable-pip-version-check --only-binary :all: --python-version $python \
    --platform manylinux_2_28_x86_64 --platform manylinux2014_x86_64 --platform manylinux_2_17_x86_64 -d "$try/packages" \
    "$wheel" 'opencv-python-headless==4.14.*'
done
. test/bare_root.sh
for release in "$@"; do
  roots=$(mktemp -d)
  bare_root "$roots" "$release"
  in_root sh -ec "apt-get update -qq && apt-get install -y -qq --no-install-recommends python3-venv" >"$try/$release.log" 2>&1 ||
    { tail -5 "$try/$release.log"; exit 1; }
  cp -r "$try/packages" samples test/wheel_first_point.sh "$root/srv"
  code=0
  in_root sh /srv/wheel_first_point.sh || code=$?
  [ $code = 0 ] || { echo "FAILED: Debian $release"; failed=1; }
  cp "$root/srv/out/report.html" "$try/report-$release.html" 2>/dev/null || true
  clean_bare_root
done
[ $failed = 0 ] && echo "The wheel works everywhere that it was tried: $wheel"
exit $failed
