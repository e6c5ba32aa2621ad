#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Unpacks the libraries that refract links, and all they stand on, for another architecture of Debian. Nothing of it is run or
# registered: an apt with a state of its own resolves and fetches, from where this machine's apt does, and checks the signatures.
#
# Usage: test/emulated/make_root.sh DIRECTORY DEBIAN_ARCHITECTURE TRIPLE     for example root arm64 aarch64-linux-gnu
set -eu
libraries=$("$(dirname "$0")/../../tools/install_dependencies.sh" libraries)
root=$1
architecture=$2
lib=$root/usr/lib/$3
state=$root.apt

foreign_apt() {
  apt-get -qq -o APT::Architecture="$architecture" -o APT::Architectures="$architecture" -o APT::Sandbox::User= \
    -o Dir::State="$state" -o Dir::State::status="$state/status" -o Dir::Cache="$state" "$@"
}
rm -rf "$root" "$state"
mkdir -p "$root" "$state/lists/partial" "$state/archives/partial"
: >"$state/status"
foreign_apt update
# shellcheck disable=SC2086  # a list of package names
foreign_apt install --yes --download-only --no-install-recommends libc6-dev $libraries
for package in "$state"/archives/*.deb; do
  dpkg-deb -x "$package" "$root"
done
rm -rf "$state"

# What installing would have done: the links of the alternatives.
for name in libblas.so libblas.so.3 liblapack.so liblapack.so.3; do
  ln -sr "$(find "$lib" -mindepth 2 -name $name | sort | head -n 1)" "$lib/$name"
done
# What would lead out of the root.
find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
  ln -srfn "$root$target" "$link"
done
sed -i "s,;/usr/lib,;$root/usr/lib,g" "$lib/cmake/Ceres/CeresTargets.cmake"
