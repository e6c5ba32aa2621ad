#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Builds the documentation as one static site in build/site: the guides of doc/, the API, search, the interactive figure.
# Nothing of it needs a server. Open build/site/index.html.
#
# Usage: doc/site.sh      Debian packages: tools/install_dependencies.sh site
set -eu
cd "$(dirname "$0")/.."
for program in doxygen python3; do
  command -v "$program" >/dev/null ||
    { echo "doc/site.sh: $program is missing: tools/install_dependencies.sh site" >&2; exit 1; }
done
mathjax=/usr/share/javascript/mathjax
[ -d "$mathjax" ] || { echo "doc/site.sh: libjs-mathjax is missing: tools/install_dependencies.sh site" >&2; exit 1; }

rm -rf build/site build/site-guides
mkdir -p build
python3 doc/site/prepare.py guides build/site-guides
# Doxygen's own order of a page, under names that say what a reader finds.
doxygen -l build/site-guides/layout.xml
sed -i '/<navindex>/,/<\/navindex>/{
  s/type="modules" visible="yes" title=""/type="modules" visible="yes" title="API by topic"/
  s/type="classlist" visible="yes" title=""/type="classlist" visible="yes" title="Classes"/
}' build/site-guides/layout.xml
doxygen doc/Doxyfile
python3 doc/site/prepare.py finish build/site

# What draws the formulas, without its other languages, fonts and ways.
for part in MathJax.js extensions jax/element jax/input/TeX jax/output/HTML-CSS fonts/HTML-CSS/TeX/woff; do
  mkdir -p "build/site/mathjax/$(dirname "$part")"
  cp -RL "$mathjax/$part" "build/site/mathjax/$part"
done
rm -rf build/site/mathjax/jax/output/HTML-CSS/fonts/[A-SU-Z]*
echo "build/site/index.html"
