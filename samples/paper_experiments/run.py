# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Section 4 (and 5.2) of the paper, rebuilt by simulation with its published rig: every table, and the figures.

    run.py [--figures=DIRECTORY]      # default: out

Needs opencv_refract (pip install . in the repository), cv2 and matplotlib. doc/paper_experiments.md shows the output
and says what to make of it. Everything random comes from one seed; it takes a minute.
"""
import argparse

import dense
import deviations
import matching
import normals
import own_rows
import plane
import pollution
import simulation
import triangulation

options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
options.add_argument("--figures", default="out", metavar="DIRECTORY", help="where the pictures go (out)")
folder = options.parse_args().figures

print(f"Seed {simulation.SEED}; noise {simulation.SIGMA:.4f} px in each coordinate of each corner.")
deviations.run(folder)
normals.run(trials=200)
plane.run(40, folder)
matching.run(20, folder)
dense.run()
triangulation.run(40, folder)
pollution.run(200)
own_rows.run()
