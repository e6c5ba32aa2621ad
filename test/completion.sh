#!/bin/bash
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Completes command lines of the tools as bash would. Usage: test/completion.sh [FOLDER_OF_TOOLS [COMPLETION_FILE]]
set -eu
root=$(realpath "$(dirname "$0")/..")
tools=$(realpath "${1:-$root/build/release/bin}")
# shellcheck source=/dev/null
. "${2:-$root/tools/completion/refract.bash}"
cd "$root"

# expect WORD... = WORD...: what the last word of a command line may become
expect()
{
    COMP_WORDS=()
    while [ "$1" != is ]; do COMP_WORDS+=("$1"); shift; done
    shift
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    _refract "$tools/${COMP_WORDS[0]}"
    if [ "${COMPREPLY[*]}" != "$*" ]; then
        echo "completion of '${COMP_WORDS[*]}': '${COMPREPLY[*]}', not '$*'" >&2
        exit 1
    fi
}

expect refract_board --patt is --pattern
expect refract_board --o is --out
expect refract_board --pattern = ch is chessboard charuco
expect refract_board --pattern = is chessboard circles acircles charuco aprilgrid
expect refract_calib --max- is --max-rms --max-normal-std --max-error-at
expect refract_calib --lens = fish is fisheye
expect refract_undistort samples/data/stereo/tru is samples/data/stereo/truth.yml
expect refract_undistort --config = samples/data/stereo/tru is samples/data/stereo/truth.yml
for tool in "$tools"/refract_*; do
    name=$(basename "$tool")
    case $name in *_tests | refract_bench | refract_tools) continue ;; esac
    complete -p "$name" >/dev/null || { echo "$name has no completion" >&2; exit 1; }
done
echo "completion: as expected"
