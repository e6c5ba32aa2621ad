# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The command line tools of refract: one program for all of them, and gnuplot, with which they draw."""
import os
import signal
import sys
from functools import partial
from pathlib import Path

_PROGRAMS = Path(__file__).parent / "bin"


def _run(tool):
    """Becomes the tool called `tool`, with this process' arguments. A gnuplot of the machine's own goes first."""
    path = os.environ.get("PATH", os.defpath)
    for name in ("SIGPIPE", "SIGXFSZ"):     # which Python ignores, and with it what takes its place
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    environment = {**os.environ, "PATH": f"{path}{os.pathsep}{_PROGRAMS}"}
    os.execve(_PROGRAMS / "refract_tools", [tool, *sys.argv[1:]], environment)


def __getattr__(name):
    """The tools are functions here: what pip puts on PATH calls them. The program knows which there are."""
    if name.startswith("refract_"):
        return partial(_run, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
