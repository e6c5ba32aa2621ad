#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Builds what is committed here in a bare Debian 13 (debootstrap, as root), which has OpenCV 4.10 and Ceres 2.2, makes the packages
# there and does with them what test/package.sh does. Debian 13 has Catch2 3: the suites are not built. Half an hour on two cores,
# some GB in TMPDIR; everything is removed but the packages, which go to build/debian13.
#
# Usage: test/debian13.sh
set -eu
cd "$(dirname "$0")/.."
. test/bare_root.sh

work=$(mktemp -d)
bare_root "$work" trixie
git clone -q "file://$PWD" "$root/srv/refract"
echo "Debian $(cat "$root/etc/debian_version"), commit $(git -C "$root/srv/refract" log -1 --format='%h %s')"
quietly() {     # quietly COMMAND: in the clone; what it says is shown only if it fails
  in_root sh -ec "cd /srv/refract && $1" >"$work/command.log" 2>&1 || { tail -50 "$work/command.log"; exit 1; }
}
quietly "export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq && tools/install_dependencies.sh build
  apt-get install -y -qq --no-install-recommends file dpkg-dev"
in_root sh -ec 'pkg-config --modversion opencv4'
quietly "cmake -S . -B build/release -G Ninja -DREFRACT_WERROR=ON -DREFRACT_BUILD_TESTS=OFF -DREFRACT_BUILD_BENCH=OFF
  nice -n 19 cmake --build build/release"
in_root sh -ec 'cd /srv/refract && test/exports.sh && test/package.sh && cd build/release && cpack -G DEB -B /srv/packages >/dev/null'
mkdir -p build/debian13
cp "$root"/srv/packages/*.deb build/debian13
# In a root without devices lintian's dependencies cannot be configured.
! command -v lintian >/dev/null || lintian --allow-root --tag-display-limit 0 --fail-on error,warning build/debian13/*.deb
ls -l build/debian13
