#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# The documentation: its site is built without a warning, every link in it leads somewhere, and the figure of doc/pane.html has
# the library's numbers in a browser: 200 random configurations of each shape of window to 1e-9 px.
#
# Usage: test/site.sh [BUILD_DIRECTORY]      build/release if not said; its program pane_values is built if it is not there
# Ends with 77 if there is no chromium.
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/release}
tools/install_dependencies.sh site >/dev/null || true
command -v chromium >/dev/null || { echo "skipped: no chromium; tools/install_dependencies.sh site"; exit 77; }
[ -x "$build/bin/pane_values" ] || cmake --build "$build" --target pane_values
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

doc/site.sh
python3 test/site/links.py build/site

# The page with two scripts more; a browser of its own, that asks nobody anything.
"$build/bin/pane_values" >"$work/expected.js"
cp test/site/pane_test.js "$work"
{ cat doc/pane.html; echo '<script src="expected.js"></script><script src="pane_test.js"></script>'; } >"$work/page.html"
timeout 300 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --disable-background-networking --no-first-run \
  --disable-sync \
  --user-data-dir="$work/profile" --dump-dom "file://$work/page.html" >"$work/dom.html" 2>"$work/chromium.log" ||
  { tail -5 "$work/chromium.log"; echo "FAILED: chromium did not show the page"; exit 1; }
sed -n '/<pre id="result">/,/<\/pre>/p' "$work/dom.html" | sed 's/<[^>]*>//g' >"$work/result"
echo "doc/pane.html, largest differences from the library (px, mm):"
cat "$work/result"
[ "$(tail -1 "$work/result")" = passed ] || { echo "FAILED: doc/pane.html"; exit 1; }
