#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Calibrates and measures on a copy of the bundled images in ./data, by the tools as they are reached.
#
# Usage: test/main_job.sh [RUN...]     RUN is put before every tool: chroot DIRECTORY, say
set -eu
"$@" refract_calib --pattern=chessboard --size=6x5 --square=39 --thickness=20 --index=1.5437 --quiet \
  --direct='data/direct1/*' --glass='data/glass1/*' --direct2='data/direct2/*' --glass2='data/glass2/*' \
  --out=calib.yml --report=report.html
"$@" refract_measure calib.yml 'data/measure1/z600_*' 'data/measure2/z600_*' --pattern=chessboard --size=6x5 \
  --square=39 --compare --out=points.csv
