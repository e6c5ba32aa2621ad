# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Figure 17: matching errors at two positions of the glass, the windows differently tilted and nearly parallel."""
import numpy as np
import figures
import methods
import published
import simulation as sim
import stereo
from tables import px, show

POSITIONS = (*stereo.POSITION_1, published.MATCHING_1), (*stereo.POSITION_2, published.MATCHING_2)
DISTANCES = published.BOARD_DISTANCE, 660.


def run(trials, folder):
    rng = np.random.default_rng(sim.SEED)
    rows = []
    figure, panels = figures.plt.subplots(1, 2, figsize=(12, 3.8))
    for axes, (name, normal1, normal2, printed) in zip(panels, POSITIONS):
        rigs = [stereo.Rig(rng, normal1, normal2) for _ in range(trials)]
        for z in DISTANCES:
            boards = [sim.board_points(rng, (0, 0, z), (10, 10, 10), 5, (0, 1)) for _ in rigs]
            errors = [rig.matching_errors(board, rng) for rig, board in zip(rigs, boards)]
            *with_glass, without = (px(sim.rms([e[method] for e in errors])) for method in methods.METHODS)
            rows.append([f"{name}, {z:.0f} mm", printed, *with_glass, published.MATCHING_WITHOUT, without])
        for method, color in methods.COLORS.items():
            axes.plot(range(1, 31), errors[0][method], ".-", color=color, label=method)
        axes.set(title=f"{name}, one board at {z:.0f} mm".capitalize(), xlabel="corner (row by row)",
                 ylabel="matching error, px")
        axes.grid(alpha=0.3)
    figures.legend_below(figure, panels[0])
    figures.finish(figure, folder, "paper_figure17.png")
    show(f"Figure 17: matching errors, px (RMS of {trials} rigs)",
         ["", "published", *methods.METHODS[:-1], "published, no glass", methods.WITHOUT], rows)


if __name__ == "__main__":
    run(10, "out")
