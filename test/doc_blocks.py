#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Runs the commands of the documentation as they stand there: each page's ```sh blocks in turn, in an empty folder of its own with
the tools on PATH and `samples` beside it.

    doc_blocks.py [--short] BIN [PAGE...]      BIN: where the tools are; without PAGE all guides; --short leaves slow blocks out

What a page says of a block stands before it, in comments that no reader sees:

    <!-- before: COMMANDS -->           what must be there: files under the names that the text has for the reader's own
    <!-- exit code 2 -->                what the block's last command ends with, if not 0
    <!-- slow -->                       left out with --short
    <!-- not run: REASON -->            of a block that cannot be run here
    <!-- prints -->                     before a block of output: the last ```sh block prints these lines, numbers within 5 %

A block that is indented and begins with one of our commands is an error: it does not say whether it runs.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMMAND = re.compile(r"\s*(?:\w+=\S+\s+)*(?:\S*/)?(?:refract_\w+ |pip |python3? |for \w+ in |(?:test|tools|doc)/[\w/]+\.sh|cmake )")
FAILED = "<failed>"


def words_of(row):
    """Words and numbers of a line, as they stand; a rule of a table is one word, however long."""
    return re.findall(r"\d+(?:\.\d+)?|[^\s\d]+", re.sub(r"--+", "--", row))


def same(expected, printed):
    """Numbers may differ by the machine's rounding, which fits make more of."""
    return len(expected) == len(printed) and all(
        a == b or (a[0].isdigit() and b[0].isdigit() and abs(float(a) - float(b)) <= 0.05*float(a) + 2e-4)
        for a, b in zip(expected, printed))


class Block:
    def __init__(self, line, text, notes):
        self.line, self.text, self.expected = line, text, []
        self.before = [note[len("before:"):] for note in notes if note.startswith("before:")]
        self.slow = "slow" in notes
        self.why_not = next((note for note in notes if note.startswith("not run:")), None)
        self.exit_code = next((int(note.split()[-1]) for note in notes if note.startswith("exit code")), 0)


def parts(text):
    """What a page consists of, as far as it matters: (kind, number of its line, text), kind being note, sh, block or indented."""
    lines, k = text.splitlines(), 0
    while k < len(lines):
        first, line = k, lines[k].strip()
        if line.startswith("<!--"):
            while "-->" not in lines[k]:
                k += 1
            yield "note", first, re.sub(r"^\s*<!--\s*|\s*-->.*$", "", "\n".join(lines[first:k + 1]), flags=re.S)
        elif line.startswith("```"):
            k += 1
            while lines[k].strip() != "```":
                k += 1
            indent = len(lines[first]) - len(lines[first].lstrip())
            yield "sh" if line == "```sh" else "block", first, "\n".join(row[indent:] for row in lines[first + 1:k])
        elif lines[k].startswith("    ") and line:
            while k + 1 < len(lines) and (lines[k + 1].startswith("    ") or not lines[k + 1].strip()):
                k += 1
            yield "indented", first, "\n".join(lines[first:k + 1])
        k += 1


def blocks_of(page):
    blocks, notes, errors = [], [], []
    for kind, line, text in parts(page.read_text()):
        if kind == "note":
            notes.append(text)
            continue
        if kind == "sh":
            blocks.append(Block(line + 1, text, notes))
        elif "prints" in notes:
            blocks[-1].expected += [row for row in text.splitlines() if row.strip()]
        elif kind == "indented" and COMMAND.match(text):
            errors.append(f"{page.relative_to(ROOT)}:{line + 1}: a command that does not say whether it runs: make it ```sh or ```console")
        notes = []
    return blocks, errors


def script_of(blocks):
    """One shell for all blocks of a page, as a reader has; each begins with a line that names it."""
    script = ["set -eu"]
    for number, block in enumerate(blocks):
        script += [f"echo '<block {number}>'", *block.before]
        if block.exit_code:
            script += ["set +e", block.text, f"[ $? = {block.exit_code} ] || {{ echo '{FAILED}'; exit 1; }}", "set -e"]
        else:
            script += [block.text]
    return "\n".join([*script, "echo '<block end>'", ""])


def run_page(page, blocks, binaries):
    """Returns what went wrong."""
    name = page.relative_to(ROOT)
    with tempfile.TemporaryDirectory() as folder:
        for entry in ("samples", "python"):
            os.symlink(ROOT/entry, f"{folder}/{entry}")
        os.makedirs(f"{folder}/build/release")
        os.symlink(binaries, f"{folder}/build/release/bin")
        environment = dict(os.environ, PATH=f"{binaries}:{os.environ['PATH']}")
        done = subprocess.run(["sh"], input=script_of(blocks), cwd=folder, env=environment, text=True, errors="replace",
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    outputs = dict(re.findall(r"<block (\w+)>\n(.*?)(?=<block \w+>\n|\Z)", done.stdout, re.S))
    errors = []
    if "end" not in outputs:
        last = len(outputs) - 1
        tail = "\n    ".join(outputs[str(last)].splitlines()[-12:])
        errors.append(f"{name}:{blocks[last].line}: a command failed:\n    {tail}")
    for number, block in enumerate(blocks):
        printed = [words_of(row) for row in outputs.get(str(number), "").splitlines()]
        missing = [row.strip() for row in block.expected if not any(same(words_of(row), other) for other in printed)]
        if missing and str(number + 1 if number + 1 < len(blocks) else "end") in outputs:
            errors.append(f"{name}:{block.line}: does not print, as the page says,\n    " + "\n    ".join(missing))
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--short", action="store_true", help="leave slow blocks out")
    parser.add_argument("binaries", type=lambda path: Path(path).resolve())
    parser.add_argument("pages", nargs="*", type=lambda path: Path(path).resolve())
    arguments = parser.parse_args()
    pages = arguments.pages or [ROOT/"README.md", *sorted((ROOT/"doc").glob("*.md"))]
    all_errors, run, left_out = [], 0, 0
    for page in pages:
        blocks, errors = blocks_of(page)
        runnable = [block for block in blocks if not block.why_not and not (block.slow and arguments.short)]
        started = time.time()
        if runnable:
            errors += run_page(page, runnable, arguments.binaries)
            print(f"{page.relative_to(ROOT)}: {len(runnable)} of {len(blocks)} blocks, {time.time() - started:.1f} s", flush=True)
        run += len(runnable)
        left_out += len(blocks) - len(runnable)
        all_errors += errors
    for error in all_errors:
        print("FAILED: " + error)
    print(f"{run} blocks run, {left_out} left out, {len(all_errors)} wrong")
    return 1 if all_errors else 0


if __name__ == "__main__":
    sys.exit(main())
