#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# refract_bench of this checkout beside that of another commit: built apart, run in turns, each row's least time of all turns
# and their ratio. On a shared machine the least is what the machine can do; a few turns more make it so.
#
# Usage: bench/beside.sh COMMIT|universal [TURNS] [REFRACT_BENCH_OPTIONS...]
#   5 turns; for example bench/beside.sh HEAD~1 9 --points=100000
#   universal: this checkout itself with its kernels on OpenCV's universal intrinsics, not on the compiler's vectors
set -eu
cd "$(dirname "$0")/.."
[ $# != 0 ] || { echo "usage: $0 COMMIT|universal [TURNS] [REFRACT_BENCH_OPTIONS...]" >&2; exit 1; }
commit=$1; shift
turns=5
case ${1:-} in [0-9]*) turns=$1; shift ;; esac

. tools/compiler_cache.sh
build() {   # build SOURCE DIRECTORY CMAKE_OPTION...
  source=$1; directory=$2; shift 2
  # shellcheck disable=SC2086  # an option or none
  cmake -S "$source" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" >"$directory.log" 2>&1 ||
    { cat "$directory.log"; exit 1; }
  cmake --build "$directory" --target refract_bench
}
mkdir -p build
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
build . build/release
if [ "$commit" = universal ]; then
  other_bench=build/universal/bin/refract_bench
  build . build/universal -DREFRACT_UNIVERSAL_INTRINSICS=ON
else
  other=$PWD/build/beside
  git worktree remove --force "$other" 2>/dev/null || rm -rf "$other"
  git worktree prune
  git worktree add --quiet --detach "$other" "$commit"
  trap 'git worktree remove --force "$other"; rm -rf "$results"' EXIT
  other_bench=$other/build/release/bin/refract_bench
  mkdir -p "$other/build"
  build "$other" "$other/build/release"
fi

for turn in $(seq "$turns"); do
  build/release/bin/refract_bench "$@" >"$results/this.$turn" || true
  "$other_bench" "$@" >"$results/other.$turn" || true
done
awk -v commit="$commit" '
  match($0, /  +[0-9]+\.[0-9]+ /) {      # the first number of a row is our time
    here = FILENAME ~ /this\.[0-9]*$/
    ours = substr($0, RSTART, RLENGTH) + 0
    key = substr($0, 1, 40); sub(/ +$/, "", key)
    if (!(key in order)) { order[key] = ++rows; name[rows] = key }
    if (!((key, here) in least) || ours < least[key, here]) least[key, here] = ours
  }
  END {
    printf "%-40s %12s %12s %8s\n", "work, ns", "here", commit, "ratio"
    for (i = 1; i <= rows; i++) {
      k = name[i]
      if (least[k, 0] > 0) printf "%-40s %12.2f %12.2f %8.3f\n", k, least[k, 1], least[k, 0], least[k, 1]/least[k, 0]
    }
  }' "$results"/this.* "$results"/other.*
