# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Runs OpenCV's bindings generator on refract.hpp, and on core's persistence.hpp for the files that cameras are written to.

    generate_bindings.py GENERATOR OUTPUT PERSISTENCE_HEADER HEADER [CUSTOM_HEADER...]

Writes the C++ that native.cpp includes, and the typed stubs of the package. Of OpenCV only the array, vector and
criteria types are wanted, so what the generator does for other modules is switched off here: overloads for UMat and
GpuMat, and the type aliases of classes that refract.hpp does not know.
"""
import re
import sys
from pathlib import Path

# What these arguments may be besides arrays, which their C++ types do not say: function, arguments, type.
LOOSER_TYPES = [
    (r"\w+", "distCoeffs[12]?", "None"),
    ("refractiveUndistortPoints|initRefractiveUndistortRectifyMap", "depth", "float"),
    ("initRefractiveUndistortRectifyMap", "R|newCameraMatrix", "None"),
    ("triangulateRefractiveExtended", "calibrationCovariance", "None"),
    (r"\w*[cC]alibrateGlass(?:Extended)?", "imagePointsDirect[12]?", "None"),
]


def load_generator(directory):
    sys.path.insert(0, directory)
    import gen2
    import hdr_parser
    from typing_stubs_generation import generation, predefined_types
    from typing_stubs_generation.nodes.type_node import AliasTypeNode, PrimitiveTypeNode, TypeResolutionError

    class MatOnlyParser(hdr_parser.CppHeaderParser):
        def __init__(self, preprocessor_definitions=None, **_):
            super().__init__(preprocessor_definitions=preprocessor_definitions)

    types = predefined_types.PREDEFINED_TYPES
    number = PrimitiveTypeNode
    types["TermCriteria"] = AliasTypeNode.tuple_("TermCriteria", items=(number.int_(), number.int_(), number.float_()))

    def drop_unknown_types(root):
        for name, node in list(types.items()):
            try:
                node.resolve(root)
            except TypeResolutionError:
                del types[name]

    hdr_parser.CppHeaderParser = MatOnlyParser
    generation.apply_manual_api_refinement = drop_unknown_types     # the refinement is for calls of other modules
    return gen2.PythonWrapperGenerator()


def loosen(stub):
    for function, arguments, also in LOOSER_TYPES:
        if re.search(rf"def (?:{function})\(", stub):
            stub = re.sub(rf"\b({arguments}): ((?:_typing\.Sequence\[)?cv2\.typing\.MatLike\]?)", rf"\1: \2 | {also}",
                          stub)
    return stub


def write_stubs(output):
    """The stubs speak of cv2.refract and cv2.typing; cv2 need not be there, nor be new enough to have types."""
    stubs = (output / "cv2" / "refract" / "__init__.pyi").read_text()
    files = (output / "cv2" / "__init__.pyi").read_text()
    stubs += files[files.index("FileStorage_READ"):]        # after the imports
    stubs = re.sub(r"\bcv2\.(FileNode|FileStorage)", r"\1", "\n".join(map(loosen, stubs.split("\n"))))
    stubs = stubs.replace("import cv2\n", "")
    (output / "__init__.pyi").write_text(stubs.replace("cv2.typing", "opencv_refract.typing")
                                         + "\nerror: type[Exception]\n__version__: str\n")
    types = (output / "cv2" / "typing" / "__init__.py").read_text()
    types = types.replace("import cv2.mat_wrapper\n", "").replace("cv2.mat_wrapper.Mat, ", "")
    (output / "typing.py").write_text('"""Types of the arguments and results of opencv_refract."""\n' + types)


def main(generator, output, persistence, header, *custom_headers):
    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    load_generator(generator).gen([persistence, header], str(output))
    includes = "".join(f'#include "{path}"\n' for path in custom_headers)
    (output / "pyopencv_custom_headers.h").write_text(includes)
    write_stubs(output)


if __name__ == "__main__":
    main(*sys.argv[1:])
