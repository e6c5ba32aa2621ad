# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Where the pictures go, and their look."""
import os

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def finish(figure, folder, name):
    os.makedirs(folder, exist_ok=True)
    figure.tight_layout()
    figure.savefig(os.path.join(folder, name), dpi=72, bbox_inches="tight")
    plt.close(figure)


def legend_below(figure, axes):
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.01), ncol=len(labels), fontsize=9,
                  frameon=False)


def image_axes(axes, size):
    axes.set(xlim=(0, size[0]), ylim=(size[1], 0), aspect="equal", xlabel="u, px", ylabel="v, px")


def arrows(axes, points, steps, times, label):
    drawn = axes.quiver(*points.T, *steps.T, np.linalg.norm(steps, axis=1), angles="xy", scale_units="xy",
                        scale=1/times, width=0.004, cmap="viridis")
    axes.figure.colorbar(drawn, ax=axes, shrink=0.75, label=label)
