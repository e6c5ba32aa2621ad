# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Runs OpenCV's bindings generator on refract.hpp, and on core's persistence.hpp for the files that cameras are written to.

    generate_bindings.py GENERATOR OUTPUT PERSISTENCE_HEADER HEADER [CUSTOM_HEADER...]

Writes the C++ that native.cpp includes, the enumerations and the typed stubs of the package. What differs from OpenCV's own cv2:

- each form of an overloaded call is a function of its own; calls.hpp chooses one by what it is given (`FORMS`), and says why
  none fits;
- arrays that are read and returned changed are copied (signatures.is_in_out); outputs without an element have a shape;
- docstrings are those of the header, of classes and fields too.
"""
import copy
import re
import sys
from pathlib import Path

import header_docs
import signatures
import stubs

TEXTS = {}      # of the header, by name

WINDOW_MADE = """

GlassWindow() is no window; GlassWindow(normal, thickness, index) a pane; lists of thicknesses and indices are layers, from the
camera outwards. The normal is normalised. The fields are attributes. Their lists cannot be changed in place: set the field.
"""
OPTIONS_MADE = """

The fields are attributes, and arguments: flags is the first, the others are given by name. Lists of arrays are read as tuples: to
change one, set the field.
"""
ENTRY = """
static const Argument {name}_arguments[][{most}] = {{ {arguments} }};
static const Form {name}_forms[] = {{ {forms} }};
static PyObject* {name}(PyObject* self, PyObject* args, PyObject* keywords)
{{
    static const Call call = {{ "{python}", {name}_forms, {count}, {flags} }};
    return choose(call, self, args, keywords);
}}

"""


def quoted(text):
    text = text.encode("ascii", "xmlcharrefreplace").decode()
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", '\\n') + '"'


def call_forms(gen2):
    class Function(gen2.FuncInfo):
        form = None         # of a copy of it: the number of its only form

        def get_wrapper_name(self):
            name = super().get_wrapper_name()
            return name if self.form is None else f"{name}_{self.form}"

        def gen_code(self, codegen):
            if self.isconstructor or self.form is not None:
                return super().gen_code(codegen)
            name, code, arguments, forms = self.get_wrapper_name(), "", [], []
            for number, variant in enumerate(self.variants):
                form = copy.copy(self)
                form.form, form.variants = number, [variant]
                code += rules_of_ours(form.gen_code(codegen), self.name, variant)
                takes = signatures.arguments_of(self.name, variant)
                arguments.append("{ " + ", ".join(f'{{ "{a.name}", {a.kind}, {int(not a.default)} }}' for a in takes) + " }")
                forms.append(f"{{ {form.get_wrapper_name()}, {name}_arguments[{number}], {len(takes)} }}")
            most = max(1, *(len(signatures.arguments_of(self.name, variant)) for variant in self.variants), 1)
            returns_flags = self.name.startswith("selectLensCoefficients")
            return code + ENTRY.format(name=name, python=self.python_name, most=most, arguments=", ".join(arguments),
                                       forms=", ".join(forms), count=len(forms), flags=int(returns_flags))

        @property
        def python_name(self):
            return f"{self.classname.rpartition('_')[2]}.{self.name}" if self.classname else self.name

        def get_tab_entry(self):
            texts = TEXTS.get(self.python_name, [])
            texts = texts + [""]*(len(self.variants) - len(texts))
            doc = quoted(signatures.docstring(self.name, self.variants, texts))
            flags = "METH_STATIC" if self.is_static else "0"
            return f'    {{"{self.name}", CV_PY_FN_WITH_KW_({self.get_wrapper_name()}, {flags}), {doc}}},\n'

    return Function


def fields_of_ours(code):
    """Fields have the header's text in place of their names; what a result leaves out has a shape; options own their arrays."""
    def named(match):
        text = TEXTS.get(match[1].rpartition("_")[2] + "." + match[2], [match[2]])[0]
        return f"(getter)pyopencv_{match[1]}_get_{match[2]}, {match[3]}, (char*){quoted(text)}, NULL}}"
    code = re.sub(r'\(getter\)pyopencv_(\w+)_get_(\w+), (NULL|\(setter\)\w+), \(char\*\)"\w+", NULL\}', named, code)
    code = re.sub(r"(Result_get_\w+\([^)]*\)\s*\{\s*return )pyopencv_from\(", r"\1fromResult(", code)
    return re.sub(r"((?:Options|Result)_set_\w+\([^{]*\{(?:(?!\n\}).)*?)pyopencv_to_safe\(", r"\1takeField(", code, flags=re.DOTALL)


def rules_of_ours(code, function, variant):
    """Copies of what is read and returned changed, shapes for outputs without an element."""
    for argument in variant.args:
        name = argument.name
        if argument.outputarg and signatures.is_in_out(function, argument):
            code = code.replace(f'pyopencv_to_safe(pyobj_{name}, {name}, ArgInfo("{name}", 1))',
                                f'takeCopy(pyobj_{name}, {name}, ArgInfo("{name}", 0))')
        if argument.outputarg and argument.tp in ("Mat", "vector_Mat"):
            channels, depth = signatures.empty_of(name)
            code = code.replace(f"pyopencv_from({name})", f"fromOutput({name}, {channels}, {depth})")
    if variant.rettype == "Mat":
        code = code.replace("pyopencv_from(retval)", "fromOutput(retval, 1, CV_64F)")
    return code


def load_generator(directory):
    sys.path.insert(0, directory)
    import gen2
    import hdr_parser

    class Declaration(list):
        place = ""          # file:line

    class Variant(gen2.FuncVariant):
        def __init__(self, namespace, classname, name, decl, *args):
            super().__init__(namespace, classname, name, decl, *args)
            self.place = decl.place

    class MatOnlyParser(hdr_parser.CppHeaderParser):        # no overloads for UMat and GpuMat
        def __init__(self, preprocessor_definitions=None, **_):
            super().__init__(preprocessor_definitions=preprocessor_definitions)

        def parse_func_decl(self, *args, **keywords):
            decl = Declaration(super().parse_func_decl(*args, **keywords) or [])
            decl.place = f"{self.hname}:{self.lineno}"
            return decl

    class Generator(gen2.PythonWrapperGenerator):
        def clear(self):
            super().clear()
            self.typing_stubs_generator.generate = lambda output: None      # stubs.py writes them

    hdr_parser.CppHeaderParser = MatOnlyParser
    gen2.FuncVariant = Variant
    gen2.FuncInfo = call_forms(gen2)
    return Generator()


def main(generator, output, persistence, header, *custom_headers):
    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    TEXTS.update(header_docs.read(Path(header)))
    for name, texts in TEXTS.items():       # GLASS_FIX_K1 speaks for the others
        fixed = re.search(r"GLASS_FIX_(K\d)$", name)
        if fixed and not texts[0]:
            texts[0] = f"{fixed[1].lower()} stays"
    generator = load_generator(generator)
    generator.gen([persistence, header], str(output))
    types = output / "pyopencv_generated_types_content.h"
    types.write_text(fields_of_ours(types.read_text()))
    includes = "".join(f'#include "{path}"\n' for path in custom_headers)
    (output / "pyopencv_custom_headers.h").write_text(includes)
    (output / "_enumerations.py").write_text(stubs.enumerations(header, TEXTS))
    (output / "__init__.pyi").write_text(stubs.package(generator, header, TEXTS))
    (output / "class_texts.h").write_text("".join(
        f"static const char* const TEXT_OF_{name} = {quoted(text)};\n"
        for name, text in [("GlassWindow", TEXTS["GlassWindow"][0] + WINDOW_MADE), ("FileStorage", "A file: see cv2.FileStorage."),
                           ("FileNode", "A node of a file: see cv2.FileNode."),
                           *((name, TEXTS[name][0] + OPTIONS_MADE) for name in ("GlassRigOptions", "BundleAdjustOptions")),
                           *((name, TEXTS[name][0]) for name in ("RefractiveCamera", "GlassRigResult", "BundleAdjustResult"))]))


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except signatures.Unknown as what:
        sys.exit(str(what))
