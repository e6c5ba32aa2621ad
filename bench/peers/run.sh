#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Beside COLMAP (bent_floor.py, strip.py), which pip installs into an environment that is thrown away with the folder.
#
# Usage: bench/peers/run.sh [FOLDER]     what is built in build/release; FOLDER (default: build/peers) is made, and kept
set -eu
cd "$(dirname "$0")/../.."
folder=${1:-build/peers}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
[ -x "$folder/venv/bin/python3" ] || python3 -m venv "$folder/venv"
"$folder/venv/bin/python3" -c 'import pycolmap' 2>/dev/null || "$folder/venv/bin/pip" --quiet install pycolmap numpy
for script in bent_floor strip; do
    "$folder/venv/bin/python3" "bench/peers/$script.py" "$PWD/build/release/bin" "$folder/work"
done
