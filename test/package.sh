#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Makes the Debian packages (library, development files, tools), checks them with lintian where that is installed, runs the tools
# on the bundled images and builds a program on the development files.
#
# Usage: test/package.sh [BUILD_DIRECTORY] [--bare]     build/release by default
#   --bare  installs the packages with apt in a bare Debian 12 (debootstrap, root) and does all that there, which takes some
#           minutes; without, the packages are only unpacked, and what is in them runs on the libraries of this machine
set -eu
cd "$(dirname "$0")/.."
main_job=$PWD/test/main_job.sh
consumer=$PWD/test/consumer
completion=$PWD/test/completion.sh
bare=no; build=build/release
for argument in "$@"; do
  case $argument in
    --bare) bare=yes ;;
    *) build=$argument ;;
  esac
done
work=$(mktemp -d)
root=$work/root; home=$root
trap 'rm -rf "$work"' EXIT

(cd "$build" && cpack -G DEB -B "$work/packages") >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
for package in "$work"/packages/*.deb; do
  dpkg-deb -f "$package" Package Version Depends
done
if command -v lintian >/dev/null; then
  lintian --allow-root --tag-display-limit 0 --fail-on error,warning "$work"/packages/*.deb
  echo "lintian: no errors, no warnings"
else
  echo "lintian is not installed: the packages' form is not checked"
fi

if [ $bare = no ]; then
  for package in "$work"/packages/*.deb; do
    dpkg-deb -x "$package" "$root"
  done
  cp -r samples/data/stereo "$root/data"
  cd "$root"
  libdir=$(dirname "$(find "$root/usr" -name libopencv_refract.so)")
  LD_LIBRARY_PATH=$libdir PATH=$root/usr/bin:$PATH PKG_CONFIG_PATH=$libdir/pkgconfig
  export LD_LIBRARY_PATH PATH PKG_CONFIG_PATH
  "$main_job"
  refract_undistort --version
  { cmake -S "$consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$root/usr" && cmake --build "$work/consumer"; } \
    >"$work/consumer.log" 2>&1 || { cat "$work/consumer.log"; exit 1; }
  "$work/consumer/consumer"
  pkg-config --print-errors --modversion opencv_refract
  for tool in usr/bin/refract_*; do
    page=usr/share/man/man1/${tool##*/}.1.gz
    heading=OPTIONS
    if [ "$tool" = usr/bin/refract_tools ]; then
      heading="SEE ALSO"        # the others, which are links to it
    elif [ "$(readlink "$tool")" != refract_tools ]; then
      echo "$tool is not a link to refract_tools" >&2; exit 1
    fi
    gzip -dc "$page" | grep -q "^\.SH $heading" || { echo "$page is not the man page of $tool" >&2; exit 1; }
  done
  "$completion" usr/bin usr/share/bash-completion/completions/refract_calib
else
  . test/bare_root.sh
  bare_root "$work"
  home=$root/srv
  mkdir "$home/packages"
  cp "$work"/packages/*.deb "$home/packages"
  cp "$main_job" "$home/main_job.sh"
  cp -r samples/data/stereo "$home/data"
  cp -r "$consumer" "$home/consumer"
  install() {   # install PACKAGE...
    in_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >"$work/install.log" 2>&1 ||
      { tail -20 "$work/install.log"; exit 1; }
  }
  in_root apt-get update -qq
  install /srv/packages/"$(cd "$home/packages" && ls libopencv-refract0*.deb)" \
    /srv/packages/"$(cd "$home/packages" && ls opencv-refract_*.deb)"
  in_root sh -c 'cd /srv && exec ./main_job.sh'
  in_root refract_undistort --version
  install /srv/packages/"$(cd "$home/packages" && ls libopencv-refract-dev_*.deb)" g++ cmake make pkg-config
  in_root sh -ec 'cmake -S /srv/consumer -B /srv/build >/dev/null && cmake --build /srv/build >/dev/null && /srv/build/consumer
    pkg-config --print-errors --modversion opencv_refract'
fi
ls -l "$home/calib.yml" "$home/points.csv" "$home/report.html"
