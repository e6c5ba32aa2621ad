# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What fields of windows read as, and flags that do not mix with those of cv2."""
from enum import IntFlag

from . import _native


class Values(tuple):
    """A tuple that equals a list of the same values, as which the field may have been set."""
    __slots__ = ()

    def __eq__(self, other):
        return tuple.__eq__(self, tuple(other) if isinstance(other, list) else other)

    def __ne__(self, other):
        return not self == other

    __hash__ = tuple.__hash__

    def __repr__(self):
        return repr(list(self))

    def __reduce__(self):       # to anyone else it is a tuple
        return tuple, (tuple(self),)


class StrictFlags(IntFlag):
    """Flags that take no number of unknown origin: a flag of cv2 with the same value means something else."""


def strict(enumeration):
    """Decorates such flags: `enum` gives each class operators of its own, whatever it inherits."""
    def ours(other):
        if other == 0 or isinstance(other, enumeration):
            return True
        if isinstance(other, int):
            raise _native.error(f"{other!r} is no {enumeration.__name__}: a flag of cv2 means something else here. "
                                f"A number of your own: {enumeration.__name__}({int(other)})")
        return False

    def union(self, other):
        return enumeration(int(self) | int(other)) if ours(other) else NotImplemented

    def difference(self, other):
        return enumeration(int(self) ^ int(other)) if ours(other) else NotImplemented

    enumeration.__or__ = enumeration.__ror__ = union
    enumeration.__add__ = enumeration.__radd__ = union      # GLASS_A + GLASS_B, as some write it
    enumeration.__xor__ = enumeration.__rxor__ = difference
    return enumeration
