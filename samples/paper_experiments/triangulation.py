# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Figure 18: depth and position of points triangulated through two windows; lengths near and far without noise."""
import numpy as np
import figures
import methods
import published
import simulation as sim
import stereo
from tables import mm, show

# Where both cameras see a board, and its scale: at 305 mm only right of the left camera's axis, and only a small one.
PLACES = ((55, -5, published.BOARD_DISTANCE/2), 0.2), ((0, 0, published.BOARD_DISTANCE), 1.), \
         ((0, 0, 2*published.BOARD_DISTANCE), 1.)
BOARDS = 3      # a rig, at the paper's distance
POSITIONS = stereo.POSITION_1, stereo.POSITION_2


def errors_of_rig(rng, normals):
    """Per method: errors (3 boards, 30, 3) of points; errors (4, 6) of lengths: with noise, then without at PLACES."""
    rig = stereo.Rig(rng, *normals)
    boards = [sim.board_points(rng, (0, 0, published.BOARD_DISTANCE), (10, 10, 10), 5, (0, 1)) for _ in range(BOARDS)]
    measured = [rig.triangulate(board, rng) for board in boards]
    real = np.array([rig.triangulate(board, rng)[methods.WITHOUT] for board in boards])      # the paper's true points
    points = {method: np.array([m[method] for m in measured]) for method in methods.METHODS}
    to_camera1 = sim.rigid_motion(points[methods.PINHOLE].reshape(-1, 3), real.reshape(-1, 3))  # its frame is its own
    points[methods.PINHOLE] = to_camera1(points[methods.PINHOLE])
    errors = {method: points[method] - real for method in methods.METHODS}
    lengths = {method: [sim.segment_lengths(points[method][0]) - sim.segment_lengths(sim.BOARD)]
               for method in methods.METHODS}
    for center, scale in PLACES:
        board = sim.board_points(rng, center, (5, 5, 10), 5, (0, 1), scale)
        for method, found in rig.triangulate(board).items():
            lengths[method].append(sim.segment_lengths(found) - scale*sim.segment_lengths(sim.BOARD))
    return errors, lengths


def draw_depth(axes, points, name):
    for method, color in methods.COLORS.items():
        depth = np.sqrt(np.mean(np.square([p[method][..., 2] for p in points]), axis=(0, 1)))
        axes.plot(range(1, 31), depth, ".-", color=color, label=method)
    axes.set(yscale="log", ylim=(0.15, 15), title=f"Windows of {name}", xlabel="corner (row by row)",
             ylabel="depth error, RMS, mm")
    axes.grid(alpha=0.3)


def draw_lengths(axes, lengths, name):
    places = np.arange(len(PLACES))
    for i, (method, color) in enumerate(methods.COLORS.items()):
        heights = [sim.rms([rig[method][1 + place] for rig in lengths]) for place in places]
        axes.bar(places + 0.15*(i - 2), heights, 0.15, color=color)
    axes.set(yscale="log", title=f"Windows of {name}, measured without noise", ylabel="length error, RMS, mm",
             xlabel="distance, mm")
    axes.set_xticks(places, [f"{center[2]:.0f}" for center, _ in PLACES])


def published_cells(method):
    return {methods.IGNORED: (published.DEPTH_BEFORE, published.POSITION_3D_BEFORE),
            methods.PAPER: (published.DEPTH_AFTER, published.POSITION_3D_AFTER)}.get(method, ("", ""))


def show_errors(name, points, lengths):
    rows = []
    for method in methods.METHODS:
        errors = np.array([p[method] for p in points])
        of_depth, of_position = published_cells(method)
        rows.append([method, of_depth, mm(sim.rms(errors[..., 2])), of_position, mm(sim.rms(sim.norms(errors))),
                     *(mm(sim.rms([rig[method][i] for rig in lengths])) for i in range(1 + len(PLACES)))])
    show(f"Figure 18, windows of {name}: RMSE of {len(points)} rigs, mm",
         ["", "depth, published", "depth", "position, published", "position", "lengths",
          "lengths, no noise in what is measured: 305 mm, fifth size", "610 mm", "1220 mm"], rows)


def run(trials, folder):
    rng = np.random.default_rng(sim.SEED)
    figure, panels = figures.plt.subplots(1, 3, figsize=(12, 3.6), width_ratios=(1, 1, 1.2))
    for axes, (name, *normals) in zip(panels, POSITIONS):
        points, lengths = zip(*(errors_of_rig(rng, normals) for _ in range(trials)))
        show_errors(name, points, lengths)
        draw_depth(axes, points, name)
        if name == POSITIONS[0][0]:
            draw_lengths(panels[-1], lengths, name)
    figures.legend_below(figure, panels[0])
    figures.finish(figure, folder, "paper_figure18.png")


if __name__ == "__main__":
    run(20, "out")
