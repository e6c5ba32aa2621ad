# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# shellcheck shell=sh

# A bare Debian to try things in: sourced by test/bare.sh, test/package.sh and test/debian13.sh.
#
#   bare_root WORK [RELEASE]   makes WORK/root of a release, bookworm by default, from where this machine's apt gets Debian
#                          (debootstrap, as root); $root is its path. WORK is removed when the script that sources this ends, also
#                          if it is interrupted
#   in_root COMMAND...     runs it in there: network, names, certificates and package registries as on this machine
#
# What is mounted (/proc) is so in a namespace of COMMAND's own and goes with it; nothing is left to unmount.

# What a command in there inherits: which proxy, certificates and package registry to use.
inherited='PIP_[A-Z_]*|[A-Za-z]*_(proxy|PROXY)|SSL_CERT_(FILE|DIR)|(REQUESTS_CA|CURL_CA)_BUNDLE'

bare_root() {
  work=$1; release=${2:-bookworm}
  root=$work/root
  command_in_root=""
  trap 'clean_bare_root' EXIT
  trap 'exit 130' HUP INT TERM
  [ "$(id -u)" = 0 ] || { echo "a bare Debian is made by root only (debootstrap, chroot)" >&2; return 1; }
  tools/install_dependencies.sh bare

  apt-get update -qq
  sources=$(apt-get indextargets --format 'deb $(SITE) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' 'Architecture: '"$(dpkg --print-architecture)" | sort -u)
  mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Origin: Debian' 'Release: bookworm' | head -n 1)
  [ -n "$mirror" ] || { echo "this machine's apt knows no source of Debian 12 (bookworm)" >&2; return 1; }
  debootstrap --variant=minbase --include=ca-certificates "$release" "$root" "$mirror" >"$work/root.log" 2>&1 ||
    { tail -5 "$work/root.log"; return 1; }
  echo "$sources" | sed "s/bookworm/$release/" >"$root/etc/apt/sources.list"
  for settings in /etc/resolv.conf /etc/hosts /etc/pip.conf /etc/apt/apt.conf /etc/apt/apt.conf.d /usr/local/share/ca-certificates; do
    [ ! -e "$settings" ] || cp -rL "$settings" "$root$(dirname "$settings")/"
  done
  in_root update-ca-certificates >"$work/certificates.log" 2>&1 || { cat "$work/certificates.log"; return 1; }
}

in_root() {
  for name in $(env | sed -En "s/^($inherited)=.*/\1/p"); do
    eval "set -- \"$name=\$$name\" \"\$@\""
  done
  # In the background, so that a signal to the script is not kept waiting; "kill-child" ends whatever was started.
  unshare --pid --fork --kill-child --mount-proc="$root/proc" chroot "$root" \
    env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@" &
  command_in_root=$!
  code=0
  wait "$command_in_root" || code=$?
  command_in_root=""
  return $code
}

clean_bare_root() {
  [ -z "$command_in_root" ] || { kill "$command_in_root" && wait "$command_in_root"; } 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
