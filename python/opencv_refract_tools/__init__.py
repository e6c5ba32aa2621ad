# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The command line tools of refract: one program for all of them, and gnuplot, with which they draw."""
import os
import sys
from pathlib import Path

_PROGRAMS = Path(__file__).parent / "bin"


def run(tool):
    """Becomes the tool called `tool`, with this process' arguments. A gnuplot of the machine's own goes first."""
    path = os.environ.get("PATH", os.defpath)
    environment = {**os.environ, "PATH": f"{path}{os.pathsep}{_PROGRAMS}"}
    os.execve(_PROGRAMS / "refract_tools", [tool, *sys.argv[1:]], environment)
