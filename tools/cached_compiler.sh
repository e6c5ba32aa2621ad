#!/bin/sh
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# What CMake puts before the compiler (compiler_cache.sh): ccache. A precompiled header is a dump of the compiler's memory, and
# another one each time: what is compiled with one would not be found by who has compiled his own. So a checksum of the headers that
# it was made of goes beside it, and ccache looks at that in its place.
ccache "$@" || exit
case " $* " in
  *" -x c++-header "*) ;;
  *) exit 0 ;;
esac
while [ "$1" != -o ]; do
  shift
done
# The list of what was read, as make has it; of the first, the output itself, there is nothing to say. Paths do not count.
sed 's/^[^ ]*: *//; s/\\$//' "$2.d" | tr -s ' ' '\n' | xargs cat | sha256sum >"$2.sum"
