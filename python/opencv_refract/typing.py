# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Types of the arguments and results of opencv_refract."""
from typing import Any, Sequence, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
"""What calls return; points and images that they take."""

Number = Union[float, "np.integer[Any]", "np.floating[Any]"]

Numbers = Union[Array, Sequence[Number]]
"""A vector, or a matrix as an array: a list or a tuple of numbers is a vector."""

Integers = Union[Array, Sequence[int], "Sequence[np.integer[Any]]"]

Arrays = Union[Array, Sequence[Numbers]]
"""One array a view (or a camera)."""

Views = Union[Array, Sequence[Arrays]]
"""A list of arrays a camera."""
