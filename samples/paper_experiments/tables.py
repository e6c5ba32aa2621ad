# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Markdown tables, as doc/paper_experiments.md shows them."""


def show(title, header, rows):
    print(f"\n### {title}\n")
    for row in (header, ["---"]*len(header), *rows):
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print(flush=True)


def mm(value):
    return f"{value:.3f}"


def px(value):
    return f"{value:.2f}"
