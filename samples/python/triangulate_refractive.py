# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Points seen by two cameras behind two windows -> 3-D points. In an existing program replace undistortPoints and
triangulatePoints by triangulateRefractive."""
import os

import cv2
import numpy as np
import opencv_refract as refract

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "stereo")
SIZE, SQUARE = (6, 5), 39.


def find_corners(name):
    image = cv2.imread(os.path.join(DATA, name), cv2.IMREAD_GRAYSCALE)
    assert image is not None, "cannot read " + name
    found, corners = cv2.findChessboardCornersSB(image, SIZE, flags=cv2.CALIB_CB_ACCURACY)
    assert found, "no chessboard found in " + name
    return corners


def length_error(points):
    """RMS error of the sides of the squares."""
    grid = points.reshape(SIZE[1], SIZE[0], 3)
    sides = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).ravel() for axis in (0, 1)]
    return np.sqrt(np.mean((np.concatenate(sides) - SQUARE)**2))


calib = os.path.join(DATA, "truth.yml")
(camera1, camera2), (_, R), (_, T) = refract.readRig(calib)

left, right = find_corners("measure1/z600_1.jpg"), find_corners("measure2/z600_1.jpg")
points, status = refract.triangulateRefractive(camera1, camera2, R, T, left, right)

# The same cameras with their windows forgotten.
none = refract.GlassWindow()
ignored, _ = refract.triangulateRefractive(camera1.cameraMatrix(), camera1.distCoeffs(), none,
                                           camera2.cameraMatrix(), camera2.distCoeffs(), none, R, T, left, right)

print(f"{len(points)} points; RMS error of the squares' sides: window ignored {length_error(ignored):.3f}, "
      f"corrected {length_error(points):.3f}")
