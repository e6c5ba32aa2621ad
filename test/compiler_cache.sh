#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# What one clone has compiled another one, at another path, finds in the compiler's cache: a handful of objects of the module and
# of the tools, each clone with precompiled headers of its own making, in a cache that is empty at first. A minute.
#
# Usage: test/compiler_cache.sh
# Ends with 77 if there is no ccache.
set -eu
cd "$(dirname "$0")/.."
command -v ccache >/dev/null || { echo "skipped: no ccache"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
CCACHE_DIR=$work/cache; export CCACHE_DIR

compile() {     # compile CLONE: prints how much of it was in the cache, "hits misses"
  git clone -q --no-hardlinks . "$1"
  cd "$1"
  . tools/compiler_cache.sh
  cmake -S . -B build -G Ninja -DREFRACT_BUILD_TESTS=OFF >build.log || { cat build.log >&2; exit 1; }
  all=$(ninja -C build -t targets all)
  headers=$(echo "$all" | sed -n 's,^\(\(.*/refract_objects\|.*/refract_tools_console\)\.dir/.*\.gch\): .*,\1,p')
  objects=$(echo "$all" | sed -n 's,^\(.*/\(math\|console\)/[a-m][a-z0-9_]*\.cpp\.o\): .*,\1,p')
  [ "$(echo "$headers" | wc -l)" = 2 ] || { echo "FAILED: which headers are precompiled? $headers" >&2; exit 1; }
  # shellcheck disable=SC2086  # names without blanks
  CCACHE_RECACHE=1 ninja -C build $headers >build.log || { cat build.log >&2; exit 1; }
  ccache -z >/dev/null
  # shellcheck disable=SC2086
  ninja -C build $objects >build.log || { cat build.log >&2; exit 1; }
  ccache --print-stats | awk '{ count[$1] = $2 } END { print count["direct_cache_hit"] + count["preprocessed_cache_hit"],
                                                             count["cache_miss"] }'
}
first=$(compile "$work/first")
second=$(compile "$work/at another place/second")
echo "hits and misses of a clone: $first; of another one: $second"
hits=${second% *} misses=${second#* }
[ "${first#* }" -gt 4 ] && [ $((hits*5)) -gt $((misses*95)) ] ||
  { echo "FAILED: the compiler's cache does not serve another clone"; exit 1; }
