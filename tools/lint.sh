#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Looks at what is committed or to be: shell scripts (shellcheck), Python (ruff), white space, length of lines, links of the pages.
# Half a minute; a part of the gate. Usage: tools/lint.sh
set -eu
cd "$(dirname "$0")/.."
tools/install_dependencies.sh lint
failed=0

echo "shellcheck"
# shellcheck disable=SC2046  # names without blanks
shellcheck --severity=warning $(git ls-files '*.sh' .ci/run) || failed=1

echo "ruff"
ruff=build/lint/bin/ruff
if [ ! -x $ruff ]; then
  python3 -m venv build/lint && build/lint/bin/pip install -q --disable-pip-version-check 'ruff==0.14.*' >build/lint.log 2>&1 ||
    { rm -rf build/lint; tail -n 1 build/lint.log; echo "skipped: pip gets no ruff"; }
fi
[ ! -x $ruff ] || $ruff check --quiet --cache-dir build/lint/cache --line-length 140 --select E,F,W . || failed=1

echo "white space, lengths, links"
git ls-files -z --cached --others --exclude-standard | xargs -0 python3 tools/lint_text.py || failed=1
[ $failed = 0 ] && echo "no finding"
