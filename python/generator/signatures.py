# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What the forms of a call take and return, as Python sees it: from the generator's `FuncVariant`, with the rules that C++ types
do not tell. The checks of calls.hpp, the docstrings and the stubs are all made of these."""
import re
from dataclasses import dataclass

# Arrays that a call reads and returns changed are copied: the caller's stay as they were. An image is drawn into, as in cv2.
DRAWN_INTO = "image"
# Initial values that C++ declares as outputs.
ALSO_READ = [(r"refractiveSolvePnP(Extended|Ransac|RansacExtended)?", r"rvec|tvec")]
# InputArrays that one number may stand for.
NUMBER_TOO = "depth[12]?|disparitySigma"
# Names that C++ has as int and that are members of an enumeration.
FLAGS = [(r"(c|stereoC)alibrateGlass\w*|selectLensCoefficients\w*|refractiveBundleAdjust\w*", "GlassCalibrationFlags"),
         (r"triangulateRefractive\w*", "TriangulateFlags"), (r"refractiveStereoRectify", "RectifyFlags")]
# Outputs without an element: the shape after the first 0, and the type. Others are empty matrices of float64.
EMPTY = {"imagePoints|dst|distorted|lines": (2, "CV_64F"), "points3D|origins|directions|_3dImage": (3, "CV_64F"),
         "status|mask": (1, "CV_8U"), "inliers": (1, "CV_32S"),
         "distances|depths|rvec|tvec|T|reprojectionError": (1, "CV_64F")}
REQUIRED_BUT_NONE = "depth"     # and arrays and windows: None is an empty array, and no window

# Kinds of calls.hpp. Types that are not here have that of what OpenCV takes for them in Python.
KINDS = {"Mat": "ARRAY", "vector_Mat": "ARRAYS", "vector_vector_Mat": "ARRAYS_OF_VIEWS", "GlassWindow": "WINDOW",
         "Ptr<RefractiveCamera>": "CAMERA", "vector_Ptr_RefractiveCamera": "CAMERAS", "int": "INTEGER", "Size": "PAIR",
         "TermCriteria": "CRITERIA", "FileNode": "NODE", "Ptr<FileStorage>": "STORAGE",
         "GlassRigOptions": "RIG_OPTIONS", "BundleAdjustOptions": "BUNDLE_OPTIONS"}
KINDS_OF_PYTHON = {"int": "INTEGER_64", "float": "NUMBER", "bool": "BOOLEAN", "str": "TEXT", "Sequence[int]": "INTEGERS",
                   "Sequence[float]": "VECTOR", "Sequence[str]": "TEXTS"}
DEFAULTS = {"noArray()": "None", "GlassWindow()": "None", "GlassRigOptions()": "None", "String()": "''",
            "Size()": "(0, 0)", "true": "True", "false": "False",
            "std::vector<int>()": "()", "std::vector<Mat>()": "()", "std::vector<std::vector<Mat> >()": "()",
            "Vec2d(0, DBL_MAX)": "(0.0, 1.7976931348623157e+308)", "Mat()": "None",
            "vector_Mat()": "None", "vector_int()": "()",
            "RECTIFY_ZERO_DISPARITY": "1024"}


@dataclass
class Argument:
    name: str
    kind: str           # of calls.hpp
    type: str           # C++'s
    default: str        # as Python writes it; empty: it has to be given

    @property
    def text(self):
        return f"{self.name}={self.default}" if self.default else self.name


def matches(rules, *names):
    return any(all(re.fullmatch(pattern, name) for pattern, name in zip(rule, names)) for rule in rules)


def is_in_out(function, argument):
    if argument.inputarg:
        return argument.outputarg and argument.tp in ("Mat", "vector_Mat") and argument.name != DRAWN_INTO
    return matches(ALSO_READ, function, argument.name)


def enumeration_of(function):
    return next((enumeration for pattern, enumeration in FLAGS if re.fullmatch(pattern, function)), None)


class Unknown(Exception):
    """What the tables here lack: a type, or a default."""


def python_type(cpp):
    """What OpenCV takes a C++ type for, as its own stubs say: int, Sequence[float]; a name of C++ if they do not."""
    from typing_stubs_generation.types_conversion import create_type_node       # its path is known once gen2 has been loaded
    node = create_type_node(cpp)
    return getattr(node, "value", node).typename.replace("_typing.", "")        # a Vec2d by what it is


def kind_of(function, argument):
    kind = KINDS.get(argument.tp) or KINDS_OF_PYTHON.get(python_type(argument.tp))
    if not kind:
        raise Unknown(f"the type {argument.tp}, which neither KINDS of signatures.py nor OpenCV's generator knows")
    if argument.outputarg and kind in ("ARRAY", "ARRAYS"):
        if is_in_out(function, argument):
            return kind
        return "OUTPUT" if kind == "ARRAY" else "OUTPUTS"
    if kind == "ARRAY" and re.fullmatch(NUMBER_TOO, argument.name):
        return "ARRAY_OR_NUMBER"
    if argument.name == "flags" and enumeration_of(function):
        return enumeration_of(function)
    if kind == "NUMBER" and argument.name == REQUIRED_BUT_NONE:
        return "NUMBER_OR_NONE"
    return kind


def default_of(value):
    value = value.strip()
    if value.startswith("TermCriteria("):
        count, epsilon = re.search(r",\s*(\d+),\s*([\d.e-]+)\)$", value).groups()
        return f"(3, {count}, {epsilon})"
    if value in DEFAULTS:
        return DEFAULTS[value]
    number = value.rstrip("f") if re.fullmatch(r"-?[\d.]+f", value) else value
    try:
        float(number)
    except ValueError:
        raise Unknown(f"the default {value}, which DEFAULTS of signatures.py lacks") from None
    return number + "0" if number.endswith(".") else number


def arguments_of(function, variant):
    """In the order of Python's: what must be given, then outputs and what has a default, as C++ has them."""
    found = []
    for position, (_, number) in enumerate(variant.py_arglist):
        argument = variant.args[number]
        default = ""
        try:
            if variant.is_arg_optional(position):
                default = default_of(argument.defval) if argument.inputarg and argument.defval else "None"
            found.append(Argument(argument.export_name, kind_of(function, argument), argument.tp, default))
        except Unknown as what:
            raise Unknown(f"{variant.place}: {function}: {argument.name} has {what}") from None
    return found


def results_of(variant):
    """(name, C++ type) of what is returned."""
    return [("retval", variant.rettype) if number < 0 else (name, variant.args[number].tp) for name, number in variant.py_outlist]


def prototype(function, variant):
    arguments = ", ".join(argument.text for argument in arguments_of(function, variant))
    results = ", ".join(name for name, _ in results_of(variant))
    return f"{function}({arguments}) -> {results or None}"


def text_signature(function, variants):
    """The line that `inspect` reads: of several forms what they begin with."""
    forms = [arguments_of(function, variant) for variant in variants]
    if len(forms) == 1:
        return f"{function}({', '.join(argument.text for argument in forms[0])})"
    common = []
    for same in zip(*forms):
        if len({argument.text for argument in same}) > 1 or same[0].default:
            break
        common.append(same[0].name)
    return f"{function}({', '.join([*common, '*args', '**kwargs'])})"


def docstring(function, variants, texts):
    """Each form, and under it what the header says of it."""
    parts = []
    for variant, text in zip(variants, texts):
        parts.append(prototype(function, variant) + ("\n" if text else ""))
        if text:
            parts.append(text + "\n")
    return f"{text_signature(function, variants)}\n--\n\n" + "\n".join(parts).strip()


def empty_of(name):
    return next((empty for pattern, empty in EMPTY.items() if re.fullmatch(pattern, name)), (0, "CV_64F"))
