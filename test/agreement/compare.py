# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Prints one table of the values that several builds of the module gave, and how far each is off the first.

Usage: compare.py FILE...       files of "name value" lines; the columns are called as the files' stems
Exit code 1 if any value differs by more than TOLERANCE, relative, or the names differ."""
import sys
from pathlib import Path

TOLERANCE = 1e-12


def read(path):
    return {name: float(value) for name, value in (line.split() for line in Path(path).read_text().splitlines())}


def main(paths):
    columns = {Path(path).stem: read(path) for path in paths}
    first, *others = columns
    reference = columns[first]
    print('%-32s %24s' % ('', first), *('%16s' % name for name in others))
    worst = dict.fromkeys(others, 0.)
    for name, value in reference.items():
        off = {other: abs(columns[other].get(name, float('nan'))/value - 1) for other in others}
        print('%-32s %24.17g' % (name, value), *('%16.1e' % off[other] for other in others))
        for other in others:
            worst[other] = max(worst[other], off[other]) if off[other] == off[other] else float('inf')
    print('%-32s %24s' % ('largest relative difference', ''), *('%16.1e' % worst[other] for other in others))
    good = all(columns[other].keys() == reference.keys() and worst[other] <= TOLERANCE for other in others)
    print('%d values from %d builds: %s within %g' % (len(reference), len(columns), 'all' if good else 'NOT all',
                                                      TOLERANCE))
    return 0 if good else 1


sys.exit(main(sys.argv[1:]))
