# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Figure 13, Tables 1 and 2: positions and lengths on a measurement plane seen by the left camera.

As in the paper the plane is known from a board in it that is seen without glass; the pinhole that was calibrated
through the glass finds it by the same board seen through the glass. It is turned by 90 degrees from the board that is
measured. One pair of images of the latter gives the normal; another image through the glass is measured.
Everything is calibrated from simulated images with noise: the lens from 25 views without glass, the pinhole from the
same 25 boards seen through it; the first 10 of these are the pairs of "ours, 10 pairs".
"""
import cv2
import numpy as np
import opencv_refract as refract
import figures
import normals
import paper_method
import published
import simulation as sim
from methods import COLORS, IGNORED, METHODS, OURS_1, OURS_10, PAPER, PINHOLE, WITHOUT
from tables import mm, show

ATTITUDES = published.ATTITUDE_1, published.ATTITUDE_2
REAL = "measured without glass, the paper's real values"
HEADER = ["", "published before", IGNORED, "published after", *METHODS[1:]]
TURNED_BOARD = sim.BOARD[:, [1, 0, 2]]*(1, -1, 1)
DISTANCES = (published.BOARD_DISTANCE/2, 0.5), (published.BOARD_DISTANCE, 1.), (2*published.BOARD_DISTANCE, 1.)


def plane_of_board(board, pixels, lens):
    """The plane (a, b, c, d) in camera coordinates in which a central camera sees the board."""
    _, rvec, tvec = cv2.solvePnP(board, pixels, *lens)
    normal = cv2.Rodrigues(rvec)[0][:, 2]
    return np.append(normal, normal @ tvec.ravel())


def on_plane(pixels, lens, window, plane):
    return refract.refractivePointsOnPlane(pixels, *lens, window, tuple(plane))[0][:, 0]


class Trial:
    """One calibration of the left camera, and what it measures."""
    def __init__(self, rng, normal):
        self.window = sim.make_window(normal)
        boards = sim.calibration_boards(rng, (0,))
        direct, glass = normals.pairs(rng, boards, 0, self.window)
        self.lens = sim.calibrate_lens(direct)
        self.pinhole = sim.calibrate_lens(glass, flags=0)

        truth = sim.board_points(rng, (0, 0, published.BOARD_DISTANCE), (10, 10, 10), 2)
        pair = normals.pairs(rng, [truth], 0, self.window)
        self.paper_normal = normals.fit_paper(*pair, self.lens)
        self.ours_1, self.ours_10 = (sim.make_window(normals.fit_joint(*views, self.lens))
                                     for views in (pair, (direct[:10], glass[:10])))

        self.points = self.measure(truth, 1., rng)
        to_camera = sim.rigid_motion(self.points[PINHOLE], self.points[REAL])       # its frame is its own
        self.points[PINHOLE] = to_camera(self.points[PINHOLE])

        # Without noise in what is measured: what the calibration itself is wrong by.
        self.own_errors = []
        for distance, scale in DISTANCES:
            board = sim.board_points(rng, (0, 0, distance), (10*scale, 10*scale, 10), 2, scale=scale)
            points = self.measure(board, scale)
            self.own_errors.append({method: sim.segment_lengths(points[method]) - scale*sim.segment_lengths(sim.BOARD)
                                    for method in METHODS})

    def measure(self, board, scale, rng=None):
        """Points (30, 3) in camera coordinates by every method; without rng no noise."""
        turned = sim.rigid_motion(scale*sim.BOARD, board)(scale*TURNED_BOARD)
        plane = plane_of_board(scale*sim.BOARD, sim.look(turned, 0, sim.NO_WINDOW, rng), self.lens)
        pinhole_plane = plane_of_board(scale*sim.BOARD, sim.look(turned, 0, self.window, rng), self.pinhole)
        pixels = sim.look(board, 0, self.window, rng)
        real, without = (on_plane(sim.look(board, 0, sim.NO_WINDOW, rng), self.lens, sim.NO_WINDOW, plane)
                         for _ in range(2))
        return {
            IGNORED: on_plane(pixels, self.lens, sim.NO_WINDOW, plane),
            PAPER: paper_method.measure_on_plane(sim.undistorted(pixels, self.lens), self.lens[0], self.paper_normal,
                                                 published.THICKNESS, published.INDEX, plane),
            PINHOLE: on_plane(pixels, self.pinhole, sim.NO_WINDOW, pinhole_plane),
            OURS_1: on_plane(pixels, self.lens, self.ours_1, plane),
            OURS_10: on_plane(pixels, self.lens, self.ours_10, plane),
            WITHOUT: without,
            REAL: real}


def beside_published(before, after, errors):
    """Cells in the order of HEADER; errors: one number for each method."""
    return [f"{before:.4f}", mm(errors[IGNORED]), f"{after:.4f}", *(mm(errors[method]) for method in METHODS[1:])]


def position_errors(trial, method):
    return sim.norms(trial.points[method] - trial.points[REAL])


def show_positions(trials):
    rows = []
    for i, ((name, *_), some) in enumerate(zip(ATTITUDES, trials)):
        errors = {method: [position_errors(trial, method) for trial in some] for method in METHODS}
        root = {method: sim.rms(e) for method, e in errors.items()}
        largest = {method: np.mean(np.max(e, axis=1)) for method, e in errors.items()}
        rows.append([name + ", RMSE",
                     *beside_published(published.POSITION_BEFORE[i], published.POSITION_AFTER[i], root)])
        rows.append([name + ", largest",
                     *beside_published(published.POSITION_BEFORE_MAX[i], published.POSITION_AFTER_MAX[i], largest)])
    show("Figure 13: positions on the plane against those measured without glass, mm "
         f"(RMS of {len(trials[0])} trials; largest: their mean)", HEADER, rows)


def show_lengths(number, rows_published, stated, trials, reference):
    """One of the Tables; reference(trial) gives the real values (6)."""
    rows = []
    for (name, *_), some, segments, of_text in zip(ATTITUDES, trials, rows_published, stated):
        errors = {method: np.array([sim.segment_lengths(trial.points[method]) - reference(trial) for trial in some])
                  for method in METHODS}
        for i, (segment, (*_, before, after)) in enumerate(zip(published.SEGMENTS, segments)):
            of_segment = {method: sim.rms(e[:, i]) for method, e in errors.items()}
            rows.append([f"{name}, {segment}", *beside_published(before, after, of_segment)])
        rows.append([f"**{name}, RMSE**", *beside_published(*of_text, {m: sim.rms(e) for m, e in errors.items()})])
    real = "as measured without glass" if number == 1 else "as made (156, 195, 249.72 mm)"
    show(f"Table {number}: errors of lengths, real values {real}, mm (RMS of {len(trials[0])} trials)", HEADER, rows)


def show_own_errors(trials):
    rows = []
    for (name, *_), some in zip(ATTITUDES, trials):
        for i, (distance, _) in enumerate(DISTANCES):
            errors = (sim.rms([trial.own_errors[i][method] for trial in some]) for method in METHODS)
            rows.append([f"{name}, {distance:.0f} mm", *(f"{error:.4f}" for error in errors)])
    show("Lengths again, with no noise in the measured image: what each calibration itself is wrong by, mm "
         f"(RMS of {len(trials[0])} trials; segments half as long at {DISTANCES[0][0]:.0f} mm)", ["", *METHODS], rows)


def draw(trials, folder):
    figure, panels = figures.plt.subplots(1, 2, figsize=(12, 3.8), sharey=True)
    for axes, (name, *_), some in zip(panels, ATTITUDES, trials):
        for method, color in COLORS.items():
            errors = [position_errors(trial, method) for trial in some]
            axes.plot(range(1, 31), np.sqrt(np.mean(np.square(errors), axis=0)), ".-", color=color, label=method)
        axes.set(yscale="log", title="Glass " + name, xlabel="corner (row by row)")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("position error on the plane, RMS, mm")
    figures.legend_below(figure, panels[0])
    figures.finish(figure, folder, "paper_figure13.png")


def run(count, folder):
    rng = np.random.default_rng(sim.SEED)
    trials = [[Trial(rng, normal) for _ in range(count)] for _, _, normal, _ in ATTITUDES]
    show_positions(trials)
    draw(trials, folder)
    show_lengths(1, published.TABLE_1, published.TABLE_1_RMSE, trials,
                 lambda trial: sim.segment_lengths(trial.points[REAL]))
    show_lengths(2, published.TABLE_2, published.TABLE_2_RMSE, trials,
                 lambda trial: sim.segment_lengths(sim.BOARD))
    show_own_errors(trials)


if __name__ == "__main__":
    run(40, "out")
