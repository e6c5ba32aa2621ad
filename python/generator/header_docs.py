# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The comments of a C++ header as texts for Python. OpenCV's parser keeps those of functions only, and of these not the `//!`."""
import re

TOKENS = re.compile(r"""
      /\*\*(?P<block>.*?)\*/
    | //!<(?P<after>[^\n]*)
    | //!(?P<line>[^\n]*)
    | //[^\n]*
    | (?:class|struct)\s+(?:CV_EXPORTS\w*\s+)?(?P<scope>\w+)[^;{]*\{
    | enum\s+(?P<enum>\w+)\s*\{
    | (?P<constant>[A-Z]\w*)\s*=\s*(?P<value>\d+)
    | (?P<close>\};)
    | (?P<statement>CV_(?:WRAP|PROP(?:_RW)?|EXPORTS_(?:W|AS))\b[^;{]*;)
    | (?P<unwrapped>(?:CV_|virtual|void|static|friend)[^;{]*;)
""", re.VERBOSE | re.DOTALL)

# What a reader of Python knows by another name.
WORDS = [(r"\\f[\[$\]](.*?)\\f[\[$\]]", r"\1"), (r"\\(tau|sum|sin|left|right|theta|gamma)\b", r"\1"), (r"@cite (\w+)", r"[\1]"),
         (r"@(brief|overload|addtogroup \w+|\{)\s*", ""), (r"\bnoArray\(\)", "None"), (r"\bDBL_MAX\b", "infinity"),
         (r"\bSize\(\)", "(0, 0)"),
         (r"\bcv::fisheye::", "cv2.fisheye."), (r"\bcv::", "cv2."), (r"\bCV_64F\b", "float64"), (r"\bCV_32F\b", "float32"),
         (r"\bCV_8U\b", "uint8"), (r"\bCV_32S\b", "int32"), (r"\bNx1 (\d)-channel\b", r"(N, 1, \1)"),
         (r"\bMx1 (\d)-channel\b", r"(M, 1, \1)"),
         (r"\s*\(or std::vector<Vec4d>\)", ""), (r"\bmay be 0 \(Python: None\)", "may be None"),
         (r"\s*A std::vector<Matx33d> must have this size before\.", "")]


def plain(comment):
    """One comment without Doxygen's commands: a text, then the arguments, then what is returned."""
    for pattern, text in WORDS:
        comment = re.sub(pattern, text, comment, flags=re.DOTALL)
    comment = "\n".join(line.strip() for line in comment.strip().split("\n"))
    text, *commands = re.split(r"^@(?=param|return)", comment, flags=re.MULTILINE)
    arguments, rest = [], []
    for command in commands:
        command, _, further = command.strip().partition("\n\n")     # a paragraph after it is no part of it
        if further:
            rest.append(further)
        kind, _, what = command.partition(" ")
        name, _, what = what.partition(" ") if kind == "param" else ("returns", "", what)
        arguments.append(f"    {name}: " + re.sub(r"\s*\n\s*", " ", what))
    parts = [text.strip(), "\n".join(arguments), "\n\n".join(rest)]
    return "\n\n".join(part for part in parts if part)


def read(header):
    """{name: [text, ...]}: of functions, classes, enumerations; of Class.method, Class.field, Enumeration.CONSTANT. Functions
    have a text for each form, in the header's order."""
    source = re.sub(r"#ifndef OPENCV_BINDINGS_PARSER.*?#endif", "", header.read_text(), flags=re.DOTALL)
    texts, scope, pending, last = {}, "", [], None

    def put(name):
        nonlocal pending, last
        last = texts.setdefault(f"{scope}.{name}" if scope else name, [])
        last.append(plain("\n".join(pending)))
        pending = []

    for token in TOKENS.finditer(source):
        if token["block"] is not None:
            pending = [token["block"]]
        elif token["after"] is not None:
            if last:
                last[-1] = (last[-1] + " " + plain(token["after"])).strip()
        elif token["line"] is not None:
            pending.append(token["line"].strip())
        elif token["scope"] or token["enum"]:
            scope = ""
            put(token["scope"] or token["enum"])
            scope = token["scope"] or token["enum"]
        elif token["constant"]:
            put(token["constant"])
        elif token["close"]:
            scope = ""
        elif token["unwrapped"]:
            pending, last = [], None
        elif token["statement"]:
            statement = token["statement"]
            alias = re.match(r"CV_EXPORTS_AS\((\w+)\)", statement)
            name = re.search(r"(\w+)\s*\(", re.sub(r"CV_\w+\(\w+\)", "", statement)) or re.search(r"(\w+)\s*;", statement)
            if name:
                put(alias[1] if alias else name[1])
    return texts
