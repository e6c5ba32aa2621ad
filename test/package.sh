#!/bin/sh
# Makes the Debian package and runs the tools that it holds on the bundled images.
#
# Usage: test/package.sh [BUILD_DIRECTORY] [--bare]     build/release by default
#   --bare  installs the package with apt in a bare Debian 12 (debootstrap, root) and runs the tools there, which takes some
#           minutes; without, the package is only unpacked and its tools run on the libraries of this machine
set -eu
cd "$(dirname "$0")/.."
main_job=$PWD/test/main_job.sh completion=$PWD/test/completion.sh
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
package=$(ls "$work"/packages/*.deb)
dpkg-deb -f "$package" Package Version Depends

if [ $bare = no ]; then
  dpkg-deb -x "$package" "$root"
  cp -r samples/data/stereo "$root/data"
  cd "$root"
  LD_LIBRARY_PATH=$root/usr/lib PATH=$root/usr/bin:$PATH
  export LD_LIBRARY_PATH PATH
  "$main_job"
  refract_undistort --version
  for tool in usr/bin/refract_*; do
    page=usr/share/man/man1/${tool##*/}.1.gz
    gzip -dc "$page" | grep -q '^\.SH OPTIONS' || { echo "$page is not the man page of $tool" >&2; exit 1; }
  done
  "$completion" usr/bin usr/share/bash-completion/completions/refract_calib
else
  . test/bare_root.sh
  bare_root "$work"
  home=$root/srv
  cp "$package" "$home/package.deb"
  cp "$main_job" "$home/main_job.sh"
  cp -r samples/data/stereo "$home/data"
  in_root sh -ec 'export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq && apt-get install -y -qq --no-install-recommends /srv/package.deb' >"$work/install.log" 2>&1 ||
    { tail -20 "$work/install.log"; exit 1; }
  in_root sh -c 'cd /srv && exec ./main_job.sh'
  in_root refract_undistort --version
fi
ls -l "$home/calib.yml" "$home/points.csv" "$home/report.html"
