# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The Python that the pages of doc/ show runs, one block after the other, where the bundled rig's file is called calib.yml."""
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def page(tmp_path, monkeypatch):
    shutil.copy(ROOT / "samples/data/stereo/truth.yml", tmp_path / "calib.yml")
    monkeypatch.chdir(tmp_path)

    def run(name):
        names = {}
        for block in re.findall(r"^```python\n(.*?)^```", (ROOT / "doc" / name).read_text(), re.M | re.S):
            exec(compile(block, name, "exec"), names)
        return names
    return run


def test_howto_python(page, capsys):
    page("howto_python.md")
    assert capsys.readouterr().out == "REFRACT_BEHIND_WINDOW\n"


def test_howto_bundle(page):
    names = page("howto_bundle.md")
    assert names["points"].shape == (150, 1, 3)


def test_no_page_is_forgotten():
    pages = {path.name for path in (ROOT / "doc").glob("*.md") if "```python" in path.read_text()}
    assert pages == {"python_first.md", "howto_python.md", "howto_bundle.md"}


def test_python_first(page, capsys):
    names = page("python_first.md")
    assert capsys.readouterr().out.endswith("[ True  True]\n")
    points = names["points"].reshape(-1, 3)
    assert np.all((points[:, 2] > 500) & (points[:, 2] < 700))      # the rig looks at a board there
    assert all(len(curve) > 1 for curve in names["curves"])
