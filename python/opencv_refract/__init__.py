# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Cameras that look through a flat window (glass, a vessel's port, a water surface): cv::refract for Python.

Every call of the C++ module refract is a function here, with NumPy arrays for matrices, as in cv2. Where cv2 is
installed the same functions are cv2.refract.* after `import opencv_refract`, and errors are cv2.error.

A window is a GlassWindow; a lens behind it is a RefractiveCamera. RefractiveStatus says why a point has no solution;
GlassCalibrationFlags say what a calibration estimates.
"""
import sys as _sys

from . import _native
from ._native import *      # noqa: F401,F403  the calls, the classes, error
from ._native import __version__    # noqa: F401
from . import _enumerations
from ._enumerations import *        # noqa: F401,F403  in place of plain numbers
from . import _classes      # noqa: F401  which gives the classes what C++ has no word for

_native._use_flags(_enumerations.GlassCalibrationFlags)
for _enumeration in _enumerations.ALL:
    for _member in _enumeration:
        _enumeration.__doc__ += f"\n\n{_member.name} = {int(_member)}: {_member.__doc__}"
    _enumeration.__module__ = __name__

# Static methods are there as functions too, RefractiveCamera_create, for programs of old.
_others = ("_", "RefractiveCamera_", "GlassWindow_")
__all__ = ["__version__"] + [_name for _name, _thing in globals().items() if not _name.startswith(_others)
                             and not isinstance(_thing, type(_sys))]

_cv2 = _sys.modules.get("cv2")      # _native has imported it, if it is installed
if _cv2 is not None and not hasattr(_cv2, "refract"):   # an OpenCV that was built with the module has its own
    _cv2.refract = _sys.modules["cv2.refract"] = _sys.modules[__name__]
