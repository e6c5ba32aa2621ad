# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# shellcheck shell=sh disable=SC2034  # variables of the script that sources it

# The source of OpenCV: sourced by test/opencv_in_tree.sh and test/bindings.sh, at the top of the tree.
#
#   opencv_source VERSION      4.14.0.94 or 5.0.0.93, of the package opencv-contrib-python-headless, whose source holds OpenCV's.
#                          It is fetched once, checked, and kept in $work, build/opencv-VERSION; $source is its path. Ends the script
#                          with 77 if pip cannot get it

package=opencv-contrib-python-headless
python=/usr/bin/python3                 # the one that Debian's NumPy belongs to

opencv_source() {
  version=$1
  case $version in
    4.14.0.94) hash=6cd98a20010c80bf9e6a9cff6189dd2c10bd111fb0aa4d5c6361389514a0ff6c ;;
    5.0.0.93) hash=6a8c34de905f59b038f6ab0475e73fb0a0f345c3582ec3aeaeb1c0912e80cddb ;;
    *) echo "the source of OpenCV $version is not known here" >&2; exit 1 ;;
  esac
  work=$PWD/build/opencv-$version
  source=$work/source/opencv
  [ ! -e "$work/source.complete" ] || return 0
  echo "Getting the source of OpenCV $version"
  mkdir -p "$work"
  echo "$package==$version --hash=sha256:$hash" >"$work/requirements.txt"
  "$python" -m pip download --quiet --no-deps --no-binary $package --require-hashes -r "$work/requirements.txt" -d "$work" ||
    { echo "skipped: pip cannot get the source of OpenCV $version"; exit 77; }
  rm -rf "$work/source"
  mkdir "$work/source"
  tar -xzf "$work"/opencv_contrib_python_headless-*.tar.gz -C "$work/source" --strip-components=1
  rm "$work"/opencv_contrib_python_headless-*.tar.gz
  touch "$work/source.complete"
}
