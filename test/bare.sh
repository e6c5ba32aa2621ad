#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Both README commands on a bare Debian 12 (debootstrap minbase, as root): a clean clone of what is committed here, and
# nothing else of this machine but network, certificates and package registries. Prints the last line of each and how long it
# took; ends non-zero if one failed. Some GB in TMPDIR and the better part of an hour on two cores; everything is removed.
#
# Usage: test/bare.sh [COMMAND...]      each COMMAND in quotes; by default 'tools/demo.sh' and 'test/run.sh'
set -eu
cd "$(dirname "$0")/.."
[ $# != 0 ] || set -- tools/demo.sh test/run.sh
. test/bare_root.sh

work=$(mktemp -d)
bare_root "$work"
git clone -q "file://$PWD" "$root/srv/refract"
echo "Debian $(cat "$root/etc/debian_version"), commit $(git -C "$root/srv/refract" log -1 --format='%h %s')"

failed=0
report=$work/report
for command in "$@"; do
  log=$work/command.log
  code=0
  begin=$(date +%s)
  echo "== $command"
  mkfifo "$work/output"
  tee "$log" <"$work/output" & shown=$!
  in_root sh -c "cd /srv/refract && exec $command" >"$work/output" 2>&1 || { code=$?; failed=$((failed + 1)); }
  wait $shown
  rm "$work/output"
  echo "$command: exit code $code after $(($(date +%s) - begin)) s: $(tail -n 1 "$log")" >>"$report"
done
echo
cat "$report"
[ $failed = 0 ]
