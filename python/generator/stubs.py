# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The package's enumerations, and its types for editors, mypy and pyright: __init__.pyi."""
import re
from pathlib import Path

import signatures

BASES = {"GlassCalibrationFlags": "StrictFlags", "TriangulateFlags": "IntFlag", "RectifyFlags": "IntFlag"}      # others: IntEnum
TYPES = {"ARRAY_OR_NUMBER": "Numbers | Number", "ARRAYS": "Arrays", "ARRAYS_OF_VIEWS": "Views", "OUTPUT": "Array",
         "OUTPUTS": "Sequence[Array]", "CAMERA": "RefractiveCamera", "CAMERAS": "Sequence[RefractiveCamera]",
         "WINDOW": "GlassWindow | None", "NUMBER": "Number", "NUMBER_OR_NONE": "Number | None", "INTEGER": "int",
         "INTEGER_64": "int", "BOOLEAN": "bool", "PAIR": "Integers", "VECTOR": "Numbers", "INTEGERS": "Integers", "TEXT": "str",
         "TEXTS": "Sequence[str]",
         "CRITERIA": "Sequence[float]", "NODE": "FileNode", "STORAGE": "FileStorage", "RIG_OPTIONS": "GlassRigOptions",
         "BUNDLE_OPTIONS": "BundleAdjustOptions",
         "GlassCalibrationFlags": "GlassCalibrationFlags | Literal[0]", "TriangulateFlags": "int", "RectifyFlags": "int"}
RESULTS = {"Mat": "Array", "vector_Mat": "tuple[Array, ...]", "GlassWindow": "GlassWindow", "Ptr<RefractiveCamera>":
           "RefractiveCamera", "vector_Ptr_RefractiveCamera": "tuple[RefractiveCamera, ...]", "Vec2d": "tuple[float, float]",
           "Rect*": "tuple[int, int, int, int]", "Rect": "tuple[int, int, int, int]", "Size": "tuple[int, int]",
           "vector_int": "tuple[int, ...] | Array", "FileNode": "FileNode", "GlassRigResult": "GlassRigResult",
           "BundleAdjustResult": "BundleAdjustResult"}      # others: what OpenCV takes them for
FIELDS = {"normal": ("tuple[float, float, float]", "Numbers"), "thickness": ("tuple[float, ...]", "Numbers"), "index":
          ("tuple[float, ...]", "Numbers"), "wedge": ("tuple[tuple[float, float], ...]", "Array | Sequence[Numbers]"),
          "materials": ("tuple[str, ...]", "Sequence[str]"), "center": ("tuple[float, float, float]", "Numbers"),
          "shape": ("int", "int"), "flags": ("GlassCalibrationFlags", "GlassCalibrationFlags | Literal[0]")}
# Others by their types; what is neither is a number.
FIELD_TYPES = {"Mat": ("Array | None", "Numbers | None"),
               "vector_Mat": ("tuple[Array | None, ...]", "Array | Sequence[Numbers | None] | None"),
               "vector_vector_Mat": ("tuple[tuple[Array | None, ...], ...]", "Views | None"), "int": ("int", "int"),
               "bool": ("bool", "bool"), "TermCriteria": ("tuple[int, int, float]", "Sequence[float]")}
POINTS = r"imag.*|objectPoints|points\d?|src|disparity|undistorted|cameraMatrix\d?|newCameraMatrix|P\d?|R1|R2|covariance|lengths"
MAY_BE_NONE = r"distCoeffs\d?|R|P|T|newCameraMatrix|depth|calibrationCovariance|covariance|imagePointsDirect\d?|points3D|lengths|" \
              r"cameraCovariances?|Rs|Ts|rvecs|tvecs"
HEAD = '''# Written by generator/stubs.py: do not edit.
from collections.abc import Sequence
from enum import IntEnum, IntFlag
from os import PathLike
from typing import Any, Final, Literal, overload

from opencv_refract.typing import Array, Arrays, Integers, Number, Numbers, Views

__version__: Final[str]

class error(Exception):
    """A wrong argument, or data without an answer. Where cv2 is installed it is cv2.error."""
    code: int
    err: str
    msg: str
    func: str
    file: str
    line: int
    # Of data without an answer, as CalibrationError in C++:
    cause: str
    reason: str
    view: int
    camera: int
    point: int

'''
WINDOW = '''    def __init__(self, normal: Numbers = ..., thickness: Number | Numbers = ..., index: Number | Numbers = ...,
                 distance: Number = ..., outerIndex: Number = ..., *, innerIndex: Number = ...,
                 wedge: Array | Sequence[Numbers] = ..., wavelength: Number = ..., materials: Sequence[str] = ...,
                 shape: int = ..., center: Numbers = ..., radius: Number = ...,
                 axis: Numbers = ..., curvature: Number = ...) -> None: ...
    def __eq__(self, other: object) -> bool: ...
'''
CAMERA = '''    def __eq__(self, other: object) -> bool: ...
'''
STORAGE = '''    def __init__(self, filename: str | PathLike[str] = ..., flags: int = ..., encoding: str = ...) -> None: ...
'''


def enumerators(header):
    """{enumeration: {constant: value}}"""
    source = re.sub(r"#ifndef OPENCV_BINDINGS_PARSER.*?#endif", "", Path(header).read_text(), flags=re.DOTALL)
    return {name: {constant: int(value) for constant, value in re.findall(r"^\s*([A-Z]\w+) = (\d+)", body, re.MULTILINE)}
            for name, body in re.findall(r"^enum (\w+) \{(.*?)^\};", source, re.MULTILINE | re.DOTALL)}


def block(text, indent):
    """As a docstring."""
    text = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    if text.endswith('"'):
        text += " "
    lines = (f'"""{text}"""').split("\n")
    return "\n".join((indent + line).rstrip() for line in lines) + "\n"


def enumerations(header, texts):
    """A module: each enumeration, and the text of each of its members."""
    found = enumerators(header)
    code = '"""Flags and statuses. Written by generator/stubs.py: do not edit."""\n'
    code += "from enum import IntEnum, IntFlag\n\nfrom ._values import StrictFlags, strict\n"
    for name, constants in found.items():
        base = BASES.get(name, "IntEnum")
        code += "\n\n" + "@strict\n"*(base == "StrictFlags") + f"class {name}({base}):\n" + block(texts[name][0], "    ")
        code += "".join(f"    {constant} = {value}\n" for constant, value in constants.items())
        code += "\n\n" + "".join(f"{name}.{constant}.__doc__ = {texts[f'{name}.{constant}'][0]!r}\n" for constant in constants)
    exported = [*found, *(constant for constants in found.values() for constant in constants)]
    code += "\n\n" + "".join(f"{constant} = {name}.{constant}\n" for name, constants in found.items() for constant in constants)
    return code + f"\nALL = ({', '.join(found)})\n__all__ = {exported!r}\n"


def type_of(argument):
    kind, name = argument.kind, argument.name
    if kind == "TEXT" and name in ("filename", "source"):
        text = "str | PathLike[str]"
    elif kind == "ARRAY":
        text = "Array" if re.fullmatch(POINTS, name) else "Numbers"
    else:
        text = TYPES[kind]
    if argument.default == "None" or (kind.startswith("ARRAY") and re.fullmatch(MAY_BE_NONE, name)):
        text += "" if text.endswith("None") else " | None"
    return text


def result_type(variant, cpp):
    if cpp in RESULTS:
        return RESULTS[cpp]
    text = signatures.python_type(cpp)
    if text not in signatures.KINDS_OF_PYTHON:
        raise signatures.Unknown(f"{variant.place}: {variant.name} returns the type {cpp}, which neither RESULTS of stubs.py nor "
                                 "OpenCV's generator knows")
    return re.sub(r"Sequence\[(\w+)\]", r"tuple[\1, ...]", text)


def result_of(variant):
    results = [result_type(variant, cpp) for _, cpp in signatures.results_of(variant)]
    return "None" if not results else results[0] if len(results) == 1 else f"tuple[{', '.join(results)}]"


def returns(name, variant):
    return "GlassCalibrationFlags" if name.startswith("selectLensCoefficients") else result_of(variant)


def functions(name, function, texts, indent=""):
    """One def, or an overload for each form. Forms that look the same are one; so are two of which depth is a number or an array."""
    forms = {}
    texts = texts + [""]*len(function.variants)
    for variant, text in zip(function.variants, texts):
        arguments = signatures.arguments_of(name, variant)
        names = tuple(argument.name for argument in arguments)
        key = names if "depth" in names else (names, tuple(type_of(argument) for argument in arguments))
        parts = [f"{argument.name}: {type_of(argument)}" + (f" = {argument.default}" if argument.default else "")
                 for argument in arguments]
        result = returns(name, variant) if len(signatures.results_of(variant)) == 1 else \
            result_of(variant).replace("tuple[int", "tuple[GlassCalibrationFlags", name.startswith("selectLensCoefficients"))
        if key in forms:         # the later one says more
            _, result, earlier = forms[key]
            text = earlier + "\n\n" + text if text else earlier
        forms[key] = (parts, result, text)
    code = ""
    for parts, result, text in forms.values():
        if len(forms) > 1:
            code += f"{indent}@overload\n"
        static = function.is_static
        if static:
            code += f"{indent}@staticmethod\n"
        parts = (["self"] if indent and not static else []) + parts
        code += f"{indent}def {name}({', '.join(parts)}) -> {result}:" + ("\n" if text else " ...\n")
        code += block(text, indent + "    ") if text else ""
    return code


def class_of(info, texts):
    name = info.original_name
    code = f"class {name}:\n" + (block(texts[name][0], "    ") if name in texts else "")
    writes = {}
    for prop in info.props:
        read, write = FIELDS.get(prop.name) or FIELD_TYPES.get(prop.tp, ("float", "Number"))
        read = read.replace(" | None", "") if name.endswith("Result") else read
        code += f"    @property\n    def {prop.name}(self) -> {read}:\n" + block(texts[f"{name}.{prop.name}"][0], "        ")
        code += f"    @{prop.name}.setter\n    def {prop.name}(self, value: {write}) -> None: ...\n"
        writes[prop.name] = f"{prop.name}: {write} = ..."
    if name.endswith("Options"):
        flags = writes.pop("flags")
        code += f"    def __init__(self, {flags}, *, {', '.join(writes.values())}) -> None: ...\n"
    code += {"GlassWindow": WINDOW, "RefractiveCamera": CAMERA, "FileStorage": STORAGE}.get(name, "")
    for method, function in sorted(info.methods.items()):
        code += functions(method, function, texts.get(f"{name}.{method}", []), "    ")
    return code + "\n"


def package(generator, header, texts):
    names, code = [], HEAD
    for name, constants in enumerators(header).items():
        base = BASES.get(name, "IntEnum").replace("StrictFlags", "IntFlag")
        code += f"class {name}({base}):\n" + block(texts[name][0], "    ")
        code += "".join(f"    {constant} = {value}\n" + block(texts[f"{name}.{constant}"][0], "    ")
                        for constant, value in constants.items()) + "\n"
        code += "".join(f"{constant}: Final = {name}.{constant}\n" for constant in constants) + "\n"
        names += [name, *constants]
    for info in sorted(generator.classes.values(), key=lambda info: info.decl_idx):
        code += class_of(info, texts)
        names.append(info.original_name)
    for namespace in generator.namespaces.values():
        for name, function in sorted(namespace.funcs.items()):
            if not function.isconstructor and "_" not in name:          # static methods are there as functions, too
                code += functions(name, function, texts.get(name, []))
                names.append(name)
        for constant in sorted(namespace.consts):
            if constant not in names:
                code += f"{constant}: Final[int]\n"
                names.append(constant)
                upper = re.sub(r"([a-z])([A-Z])", r"\1_\2", constant).upper()
                if upper != constant:
                    code += f"{upper}: Final[int]\n"
                    names.append(upper)
    return code + "\n__all__ = " + repr(sorted(names + ["error", "__version__"])) + "\n"
