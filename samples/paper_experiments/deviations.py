# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Figure 10: how far the window moves the image points of a board at 610 mm, for both glass attitudes."""
import figures
import published
import simulation as sim
from tables import px, show

ATTITUDES = published.ATTITUDE_1, published.ATTITUDE_2


def deviations(normal):
    board = sim.BOARD + (0, 0, published.BOARD_DISTANCE)
    direct = sim.look(board, 0, sim.NO_WINDOW)
    return direct, sim.look(board, 0, sim.make_window(normal)) - direct


def run(folder):
    rows = []
    figure, panels = figures.plt.subplots(1, 2, figsize=(12, 4.6))
    for axes, (name, _, normal, center), (least, most) in zip(panels, ATTITUDES, published.DEVIATION):
        points, steps = deviations(normal)
        size = sim.norms(steps)
        rows.append([name, least, px(size.min()), most, px(size.max())])
        figures.arrows(axes, points, steps, 8, "deviation, px (arrows eight times as long)")
        axes.plot(*center, "o", color="tab:red", mec="black", label="distortion centre, published")
        figures.image_axes(axes, published.IMAGE_SIZE)
        axes.set_title("Glass " + name)
        axes.legend(loc="lower right", fontsize=8)
    figures.finish(figure, folder, "paper_figure10.png")
    show("Figure 10: deviation of the image points, px (board at 610 mm on the axis, no noise)",
         ["", "smallest, published", "simulated", "largest, published", "simulated"], rows)


if __name__ == "__main__":
    run("out")
