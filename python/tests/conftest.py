# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""A stereo rig behind two tilted windows, and points that both cameras see."""
import numpy as np
import pytest

import opencv_refract as refract


class Rig:
    K1 = np.array([[2438.07, 0, 643.98], [0, 2438.08, 500.01], [0, 0, 1]])
    K2 = np.array([[2443.13, 0, 647.83], [0, 2443.13, 487.49], [0, 0, 1]])
    D1 = np.array([-0.4082, 0.4359, 0, 0, 0])
    D2 = np.array([-0.4100, 0.4389, 0, 0, 0])
    window1 = refract.GlassWindow((-0.24, 0.093, 0.966), 20., 1.5437, 50.)
    window2 = refract.GlassWindow((0.173, -0.266, 0.948), 20., 1.5437, 50.)
    R = np.array([0.03, 0.293, 0.005])
    T = np.array([-211.4756, 1.3306, 53.3775])

    def __init__(self):
        self.lens1 = self.K1, self.D1, self.window1
        self.lens2 = self.K2, self.D2, self.window2
        self.camera1 = refract.RefractiveCamera.create(*self.lens1)
        self.camera2 = refract.RefractiveCamera.create(*self.lens2)
        random = np.random.default_rng(1)
        self.points = random.uniform((-60, -50, 540), (60, 50, 680), (40, 3))
        zero = np.zeros(3)
        self.pixels1 = refract.refractiveProjectPoints(self.points, zero, zero, self.camera1)[0]
        self.pixels2 = refract.refractiveProjectPoints(self.points, self.R, self.T, self.camera2)[0]


@pytest.fixture(scope="session")
def rig():
    return Rig()


class Board:
    """Images of a 6x5 chessboard in eight poses: direct, and through each window."""
    def __init__(self, rig):
        target = np.zeros((30, 3))
        target[:, :2] = 39.*np.mgrid[0:6, 0:5].T.reshape(-1, 2) - (97.5, 78.)
        random = np.random.default_rng(2)
        none = refract.GlassWindow()
        direct1, direct2 = (refract.RefractiveCamera.create(K, D, none) for K, D in ((rig.K1, rig.D1), (rig.K2, rig.D2)))
        self.rvecs = [random.uniform(-0.4, 0.4, 3) for _ in range(8)]
        self.tvecs = [random.uniform((-20, -20, 600), (20, 20, 680)) for _ in self.rvecs]
        self.target = [target]*len(self.rvecs)
        self.direct1, self.direct2, self.glass1, self.glass2 = [], [], [], []
        for rvec, tvec in zip(self.rvecs, self.tvecs):
            for pixels, camera in ((self.direct1, direct1), (self.glass1, rig.camera1)):
                pixels.append(refract.refractiveProjectPoints(target, rvec, tvec, camera)[0])
            # in the frame of camera 1, then in that of camera 2
            points = rotation(rvec) @ target.T + tvec[:, None]
            for pixels, camera in ((self.direct2, direct2), (self.glass2, rig.camera2)):
                pixels.append(refract.refractiveProjectPoints(points.T, rig.R, rig.T, camera)[0])


def rotation(rvec):
    """Rodrigues' formula: the tests also run where cv2 is not installed."""
    angle = np.linalg.norm(rvec)
    x, y, z = rvec/angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle)*cross + (1 - np.cos(angle))*cross @ cross


@pytest.fixture(scope="session")
def board(rig):
    return Board(rig)
