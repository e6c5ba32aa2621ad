# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Figure 11 and Table 3: the normal and its distortion centre from one pair of images, and from ten."""
import numpy as np
import opencv_refract as refract
import paper_method
import published
import simulation as sim
from tables import px, show

PRINTED = published.ATTITUDE_1, published.ATTITUDE_2, published.TABLE_3_LEFT, published.TABLE_3_RIGHT


def center_of_normal(normal, K):
    normal = np.ravel(normal)
    return K[:2, :2] @ normal[:2]/normal[2] + K[:2, 2]


def pairs(rng, boards, camera, window):
    """Direct and refracted views of unmoved boards."""
    return [[sim.look(board, camera, seen_through, rng) for board in boards]
            for seen_through in (sim.NO_WINDOW, window)]


def fit_paper(direct, glass, lens):
    ideal = (sim.undistorted(np.vstack(views), lens) for views in (direct, glass))
    return paper_method.calibrate_normal(*ideal, lens[0])


def fit_closed(direct, glass, lens):
    return refract.calibrateGlassNormal(direct, glass, *lens)[1].ravel()


def fit_joint(direct, glass, lens, normal=(0, 0, 1)):
    """calibrateGlass: the board's geometry, thickness and index are known."""
    _, window, *_ = refract.calibrateGlass([sim.BOARD]*len(direct), direct, glass, *lens, sim.make_window(normal))
    return np.array(window.normal)


def bound(boards, camera, window):
    """Cramer-Rao bound of fit_joint: RMS angle in degrees over both directions, from the exact derivatives."""
    normal = np.array(window.normal)
    tangents = np.linalg.svd(normal[None])[2][1:].T
    information = np.zeros((2, 2))
    zero = np.zeros(3)
    for board in boards:
        by_pose, by_normal = [], []
        for seen_through in (sim.NO_WINDOW, window):
            device = refract.RefractiveCamera.create(*sim.LENSES[camera], seen_through)
            turn, shift = sim.POSES[camera]
            jacobian = refract.refractiveProjectPointsExtended(board @ turn.T + shift, zero, zero, device)[2]
            first = 6 + len(device.lensParameters())
            by_pose.append(jacobian[:, :6])
            by_normal.append(jacobian[:, first:first + 3] @ tangents)
        by_normal[0][:] = 0     # the direct view knows nothing of the window
        A, B = np.vstack(by_pose), np.vstack(by_normal)
        information += B.T @ B - B.T @ A @ np.linalg.solve(A.T @ A, A.T @ B)
    return np.degrees(sim.SIGMA*np.sqrt(np.trace(np.linalg.inv(information))))


FITS = fit_paper, fit_closed, fit_joint


def errors(rng, printed, count, trials):
    """RMS over trials of the angle (degrees) and of the distortion centre (px) of every fit, and the bound."""
    _, camera, normal, _ = printed
    window, lens = sim.make_window(normal), sim.LENSES[camera]
    true_center = center_of_normal(normal, lens[0])
    angles, centers, bounds = [], [], []
    for _ in range(trials):
        boards = sim.calibration_boards(rng, (0, 1), count)
        views = pairs(rng, boards, camera, window)
        normals = [fit(*views, lens) for fit in FITS]
        angles.append([sim.angle(found, window.normal) for found in normals])
        centers.append([np.linalg.norm(center_of_normal(found, lens[0]) - true_center) for found in normals])
        bounds.append(bound(boards, camera, window))
    per_fit = [np.sqrt(np.mean(np.square(values), axis=0)) for values in (angles, centers)]
    return *per_fit, sim.rms(bounds)


def run(trials):
    rng = np.random.default_rng(sim.SEED)
    rows = []
    for count in (1, 10):
        for printed in PRINTED:
            name, *_, center = printed
            angles, centers, least = errors(rng, printed, count, trials)
            rows.append([f"{name}, {count} pair{'s' if count > 1 else ''}", "({:.1f}, {:.1f})".format(*center),
                         *map(px, centers), *(f"{a:.3f}" for a in angles), f"{least:.3f}"])
    show(f"Figure 11, Table 3: distortion centre and normal from pairs of images (RMS errors of {trials} trials)",
         ["", "centre, published", "the paper's method, px", "`calibrateGlassNormal`, px", "`calibrateGlass`, px",
          "the paper's method, degrees", "`calibrateGlassNormal`, degrees", "`calibrateGlass`, degrees",
          "Cramer-Rao bound, degrees"], rows)


if __name__ == "__main__":
    run(200)
