# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The stereo rig behind two windows, calibrated from simulated images with noise; matches and points by every method.

The lenses, R and T come from 25 views without glass (OpenCV); those of the pinholes calibrated through the glass from
the same 25 boards seen through it. The paper's normals come from one pair of images for each camera, ours from the same
pair, or from ten.
"""
import cv2
import numpy as np
import opencv_refract as refract
import normals
import paper_method
import published
import simulation as sim
from methods import IGNORED, OURS_1, OURS_10, PAPER, PINHOLE, WITHOUT

POSITION_1 = "position 1", published.TABLE_3_LEFT[2], published.TABLE_3_RIGHT[2]
POSITION_2 = "position 2", published.POSITION_2_LEFT[2], published.POSITION_2_RIGHT[2]
DEPTH_RANGE = 200., 3000.


class CentralPair:
    """Two OpenCV cameras."""
    def __init__(self, views1, views2, flags):
        self.lenses = [sim.calibrate_lens(views, flags) for views in (views1, views2)]
        self.R, self.T = sim.calibrate_extrinsics(*self.lenses, views1, views2)
        *self.rectified, _, _, _ = cv2.stereoRectify(*self.lenses[0], *self.lenses[1], published.IMAGE_SIZE,
                                                     self.R, self.T)

    def row_difference(self, pixels1, pixels2):
        """The paper's matching error: rows in the rectified images, px (N)."""
        R1, R2, P1, P2 = self.rectified
        rows = [refract.refractiveUndistortPoints(pixels, *lens, sim.NO_WINDOW, None, R=R, P=P)[0][:, 0, 1]
                for pixels, lens, R, P in zip((pixels1, pixels2), self.lenses, (R1, R2), (P1, P2))]
        return rows[0] - rows[1]

    def triangulate(self, pixels1, pixels2):
        ideal = [sim.undistorted(pixels, lens).T for pixels, lens in zip((pixels1, pixels2), self.lenses)]
        P1, P2 = self.lenses[0][0] @ np.eye(3, 4), self.lenses[1][0] @ np.hstack((self.R, self.T))
        points = cv2.triangulatePoints(P1, P2, *ideal)
        return (points[:3]/points[3]).T


class PaperPair:
    """The paper's rays behind two windows of known normals."""
    def __init__(self, direct, pair):
        self.direct = direct
        self.normals = [normals.fit_paper(*views, lens) for views, lens in zip(pair, direct.lenses)]

    def rays_and_points(self, pixels1, pixels2):
        (p1, d1), (p2, d2) = (
            paper_method.rays(sim.undistorted(pixels, lens), lens[0], normal, published.THICKNESS, published.INDEX)
            for pixels, lens, normal in zip((pixels1, pixels2), self.direct.lenses, self.normals))
        R, T = self.direct.R, self.direct.T.ravel()
        return paper_method.triangulate((p1, d1), ((p2 - T) @ R, d2 @ R))

    def matching_error(self, pixels1, pixels2):
        """The gap of the two rays, which the paper wants coplanar, in px at the point (N)."""
        points, gap = self.rays_and_points(pixels1, pixels2)
        return gap*self.direct.lenses[0][0][0, 0]/sim.norms(points)

    def triangulate(self, pixels1, pixels2):
        return self.rays_and_points(pixels1, pixels2)[0]


class RefractivePair:
    """Two cameras of this module; windows from the joint fit of stereoCalibrateGlass."""
    def __init__(self, direct, pairs):
        (direct1, glass1), (direct2, glass2) = pairs
        starts = [normals.fit_closed(*views, lens) for views, lens in zip(pairs, direct.lenses)]
        self.cameras = [refract.RefractiveCamera.create(*lens, sim.make_window(normal))
                        for lens, normal in zip(direct.lenses, starts)]
        _, self.R, self.T, *_ = refract.stereoCalibrateGlass([sim.BOARD]*len(glass1), direct1, glass1, direct2, glass2,
                                                             *self.cameras, direct.R, direct.T)

    def matching_error(self, pixels1, pixels2):
        """Distance of the partners from their epipolar curves, px (N)."""
        curves, _ = refract.computeRefractiveEpilines(pixels1, 1, *self.cameras, self.R, self.T, DEPTH_RANGE)
        return np.array([distance(curve[:, 0], pixel) for curve, pixel in zip(curves, pixels2)])

    def triangulate(self, pixels1, pixels2):
        return refract.triangulateRefractive(*self.cameras, self.R, self.T, pixels1, pixels2)[0][:, 0]


def distance(polyline, point):
    """Of a point from a polyline (M, 2), with a sign: the side."""
    start, step = polyline[:-1], np.diff(polyline, axis=0)
    along = np.clip(np.sum((point - start)*step, axis=1)/np.sum(step*step, axis=1), 0, 1)
    offset = point - start - along[:, None]*step
    i = np.argmin(sim.norms(offset))
    return np.copysign(sim.norms(offset[i]), step[i, 1]*offset[i, 0] - step[i, 0]*offset[i, 1])


class Rig:
    """One calibration of everything, behind windows of the given normals."""
    def __init__(self, rng, normal1, normal2):
        self.windows = sim.make_window(normal1), sim.make_window(normal2)
        boards = sim.calibration_boards(rng, (0, 1))
        views = [normals.pairs(rng, boards, camera, self.windows[camera]) for camera in (0, 1)]
        (direct1, glass1), (direct2, glass2) = views
        first, ten = ([[d[:count], g[:count]] for d, g in views] for count in (1, 10))
        direct = CentralPair(direct1, direct2, cv2.CALIB_ZERO_TANGENT_DIST + cv2.CALIB_FIX_K3)
        self.direct = direct
        self.pinholes = CentralPair(glass1, glass2, 0)
        self.paper = PaperPair(direct, first)
        self.ours_1, self.ours_10 = (RefractivePair(direct, pairs) for pairs in (first, ten))

    def look(self, points, rng):
        """Pixels of both cameras: through the windows, and without."""
        return [[sim.look(points, camera, window, rng) for camera, window in enumerate(windows)]
                for windows in (self.windows, (sim.NO_WINDOW, sim.NO_WINDOW))]

    def matching_errors(self, points, rng):
        glass, direct = self.look(points, rng)
        return {IGNORED: self.direct.row_difference(*glass), PAPER: self.paper.matching_error(*glass),
                PINHOLE: self.pinholes.row_difference(*glass), OURS_1: self.ours_1.matching_error(*glass),
                OURS_10: self.ours_10.matching_error(*glass), WITHOUT: self.direct.row_difference(*direct)}

    def triangulate(self, points, rng=None):
        glass, direct = self.look(points, rng)
        return {IGNORED: self.direct.triangulate(*glass), PAPER: self.paper.triangulate(*glass),
                PINHOLE: self.pinholes.triangulate(*glass), OURS_1: self.ours_1.triangulate(*glass),
                OURS_10: self.ours_10.triangulate(*glass), WITHOUT: self.direct.triangulate(*direct)}
