#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What tools/lint.sh asks of every text: no tabs, no white space at the end of a line, one line feed at the end of a file, lines of
code of at most 140 characters (128 in the public header), and links of a Markdown page that lead to files which are there.

    lint_text.py FILE...       prints file:line: what; exit code 1 if there is anything
"""
import re
import sys
from pathlib import Path
from urllib.parse import unquote

CODE = {".cpp", ".hpp", ".h", ".py", ".sh", ".cmake", ".txt", ".js", ".in", ".m"}
PROSE = {".md", ".markdown", ".html", ".bib", ".yml", ".toml", ".mustache", ".bash", ".map", ""}
NOT_OURS = ("test/fuzz/corpus/", "test/fuzz/regressions/", "samples/data/", "test/reference/", "test/exports.txt", "LICENSE")
LONGEST, LONGEST_OF_HEADER = 140, 128


def findings_of_lines(path, text):
    longest = LONGEST_OF_HEADER if "include/opencv2" in path.as_posix() else LONGEST
    for number, line in enumerate(text.split("\n"), 1):
        if "\t" in line:
            yield number, "a tab"
        if line != line.rstrip():
            yield number, "white space at the end of the line"
        if path.suffix in CODE and len(line) > longest:
            yield number, f"{len(line)} characters; {longest} at most"
    if text and (not text.endswith("\n") or text.endswith("\n\n")):
        yield text.count("\n"), "the file must end with one line feed"


def dead_links(path, text):
    for number, line in enumerate(text.split("\n"), 1):
        for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            target = unquote(link.split("#")[0])
            if target and not re.match(r"[a-z]+:", link) and not (path.parent / target).exists():
                yield number, f"the link {link} leads nowhere"


def main(names):
    found = False
    for path in (Path(name) for name in names):
        if path.as_posix().startswith(NOT_OURS) or path.suffix not in CODE | PROSE or not path.is_file():
            continue
        text = path.read_text(encoding="utf-8")
        findings = list(findings_of_lines(path, text))
        if path.suffix == ".md":
            findings += dead_links(path, text)
        for number, what in findings:
            found = True
            print(f"{path}:{number}: {what}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
