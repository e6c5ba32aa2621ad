# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What GlassWindow, RefractiveCamera and options have in Python and not in C++: repr, equality, copies, fields that cannot be
misread."""
import copyreg
import inspect

import numpy as np

from . import _native
from ._enumerations import GlassCalibrationFlags
from ._values import Values

WINDOW_FIELDS = ("normal", "thickness", "index", "distance", "outerIndex", "innerIndex", "wedge", "wavelength", "materials",
                 "shape", "center", "radius", "axis", "curvature")
SEQUENCES = ("normal", "center", "axis", "thickness", "index", "wedge", "materials")
PANES = (0, 3)      # shapes that have a normal: WINDOW_FLAT, WINDOW_BENT


def as_values(read):
    """A list of numbers, of pairs or of texts, that cannot be changed in place: to change it in the window, set the field."""
    def values(window):
        return Values(item if isinstance(item, (str, tuple)) else tuple(map(float, item)) if hasattr(item, "__len__") else float(item)
                      for item in read(window))
    return values


def none_if_empty(read):
    def value(owner):
        array = read(owner)
        return None if array is None or array.size == 0 else array
    return value


def field(made, name, nothing=None):
    """@param nothing what None stands for; None: it is refused"""
    of_c = getattr(made, name)

    def write(owner, value):
        if value is None and nothing is None:
            raise _native.error(f"{made.__name__}.{name} cannot be None")
        if name == "flags" and value != 0 and isinstance(value, int) and not isinstance(value, GlassCalibrationFlags):
            raise _native.error(f"{made.__name__}.flags is the plain number {value!r}. Take the GLASS_... of opencv_refract: a flag of "
                                f"cv2 means something else here (a number of your own: GlassCalibrationFlags({value!r}))")
        try:
            of_c.__set__(owner, nothing if value is None else value)
        except (TypeError, ValueError) as why:
            raise _native.error(f"{made.__name__}.{name}: {str(why).replace('value ', 'the value ', 1)}") from None

    read = of_c.__get__
    if made is _native.GlassWindow and name in SEQUENCES:
        read = as_values(read)
    elif isinstance(nothing, np.ndarray):
        read = none_if_empty(read)
    elif name == "flags":
        def read(owner):
            return GlassCalibrationFlags(of_c.__get__(owner))
    setattr(made, name, property(read, write, doc=of_c.__doc__))


def made_with(made, fields):
    return made(**fields)


def copies_of(made):
    """They can be pickled and copied."""
    names = [name for name, thing in vars(made).items() if inspect.isgetsetdescriptor(thing)]
    copyreg.pickle(made, lambda thing: (made_with, (made, {name: getattr(thing, name) for name in names})))
    return names


def options(made):
    """Arrays may be None, and lists of them."""
    names = copies_of(made)
    for name in names:
        default = getattr(made(), name)
        nothing = np.empty((0, 0)) if default is None else default if default == () else None
        field(made, name, nothing)
    keyword = inspect.Parameter.KEYWORD_ONLY
    made.__signature__ = inspect.Signature([
        inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD if name == "flags" else keyword, default=getattr(made(), name))
        for name in sorted(names, key=lambda name: name != "flags")])


def window_values(window):
    return tuple(getattr(window, name) for name in WINDOW_FIELDS)


def window_of(*values):
    window = _native.GlassWindow()
    for name, value in zip(WINDOW_FIELDS, values):
        setattr(window, name, value)
    return window


def window_text(window):
    """As it is made; fields with the values of no window are left out."""
    none = _native.GlassWindow()
    given = [(name, getattr(window, name)) for name in WINDOW_FIELDS]
    always = ("normal", "thickness", "index") if window.shape in PANES else ("thickness", "index")
    parts = [f"{name}={tuple(value) if name in ('normal', 'center', 'axis') else value!r}" for name, value in given
             if value != getattr(none, name) or (name in always and window != none)]
    return f"GlassWindow({', '.join(parts)})"


def camera_values(camera):
    coefficients = camera.distCoeffs()
    return (camera.lensModel(), camera.cameraMatrix().tolist(), coefficients.ravel().tolist(), camera.imageSize(), camera.window())


def camera_text(camera):
    size = "x".join(map(str, camera.imageSize()))
    names, numbers = camera.parameterNames(), camera.lensParameters().ravel()
    lens = ", ".join(f"{name}={number:.10g}" for name, number in zip(names, numbers))
    points = "" if len(numbers) >= 4 + camera.distCoeffs().size else f", {camera.distCoeffs().size} control points"
    image = f", image {size}" if size != "0x0" else ""
    return f"<RefractiveCamera {camera.lensModel()}: {lens}{points}{image}, {camera.window()!r}>"


def camera_of(text):
    file = _native.FileStorage(text, _native.FileStorage_READ | _native.FileStorage_MEMORY)
    return _native.RefractiveCamera.read(file.getNode("camera"))


def camera_file(camera):
    file = _native.FileStorage(".yml", _native.FileStorage_WRITE | _native.FileStorage_MEMORY)
    camera.write(file, "camera")
    return file.releaseAndGetString()


def equality(made, values):
    def equal(self, other):
        return values(self) == values(other) if isinstance(other, made) else NotImplemented
    made.__eq__ = equal
    made.__hash__ = None        # they can change


def signature_of_window():
    """Of GlassWindow(...): older Pythons lose what an extension says of a type."""
    none = _native.GlassWindow()
    keyword = inspect.Parameter.KEYWORD_ONLY
    return inspect.Signature([inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD if i < 5 else keyword,
                                                default=getattr(none, name)) for i, name in enumerate(WINDOW_FIELDS)])


for name in WINDOW_FIELDS:
    field(_native.GlassWindow, name)
options(_native.GlassRigOptions)
options(_native.BundleAdjustOptions)
copies_of(_native.GlassRigResult)
copies_of(_native.BundleAdjustResult)
equality(_native.GlassWindow, window_values)
equality(_native.RefractiveCamera, camera_values)
_native.GlassWindow.__signature__ = signature_of_window()
_native.GlassWindow.__repr__ = window_text
_native.RefractiveCamera.__repr__ = camera_text
copyreg.pickle(_native.GlassWindow, lambda window: (window_of, window_values(window)))
copyreg.pickle(_native.RefractiveCamera, lambda camera: (camera_of, (camera_file(camera),)))
