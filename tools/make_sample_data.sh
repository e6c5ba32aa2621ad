#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Remakes the bundled images and their truth from samples/data/*/rig.yml:  tools/make_sample_data.sh [BUILD_DIR]
# Leaves the depth of the scene beside its images, too large to be bundled.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "${1:-$root/build}" && pwd)
if [ ! -x "$build/bin/refract_simulate" ]; then
    echo "$0: there is no $build/bin/refract_simulate: build the tools first, or name the build folder" >&2
    exit 1
fi
PATH="$build/bin:$PATH"
cd "$root/samples/data/stereo"
refract_simulate rig.yml --out-dir=. --format=jpg --quality=88
cd "$root/samples/data/scene"
refract_simulate rig.yml --out-dir=. --format=jpg --quality=92
cd "$root/samples/data/projector"
refract_simulate rig.yml --out-dir=. --format=jpg --quality=92
rm truth.yml        # rig.yml says all of it
