# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Cameras that look through a flat window (glass, a vessel's port, a water surface): cv::refract for Python.

Every call of the C++ module refract is a function here, with NumPy arrays for matrices, as in cv2. Where cv2 is
installed the same functions are cv2.refract.* after `import opencv_refract`, and errors are cv2.error.
"""
import copyreg as _copyreg
import sys as _sys

from . import _native
from ._native import *      # noqa: F401,F403  the calls, the two classes, the constants, error
from ._native import __version__    # noqa: F401

_cv2 = _sys.modules.get("cv2")      # _native has imported it, if it is installed
if _cv2 is not None and not hasattr(_cv2, "refract"):   # an OpenCV that was built with the module has its own
    _cv2.refract = _sys.modules["cv2.refract"] = _sys.modules[__name__]

# For pickle, copy and multiprocessing.
_WINDOW_FIELDS = ("normal", "distance", "thickness", "index", "innerIndex", "outerIndex", "wedge", "wavelength",
                  "materials")


def _window_of(*values):
    window = _native.GlassWindow()
    for field, value in zip(_WINDOW_FIELDS, values):
        setattr(window, field, value)
    return window


def _camera_of(text):
    file = _native.FileStorage(text, _native.FileStorage_READ | _native.FileStorage_MEMORY)
    return _native.RefractiveCamera.read(file.getNode("camera"))


def _text_of(camera):
    file = _native.FileStorage(".yml", _native.FileStorage_WRITE | _native.FileStorage_MEMORY)
    camera.write(file, "camera")
    return file.releaseAndGetString()


_copyreg.pickle(_native.GlassWindow, lambda window: (_window_of, tuple(getattr(window, name) for name in _WINDOW_FIELDS)))
_copyreg.pickle(_native.RefractiveCamera, lambda camera: (_camera_of, (_text_of(camera),)))
