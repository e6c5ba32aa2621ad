# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The window's normal from one pair of images of an unmoved chessboard, without and with the window."""
import os

import cv2
import numpy as np
import opencv_refract as refract

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "stereo")


def find_corners(name):
    image = cv2.imread(os.path.join(DATA, name), cv2.IMREAD_GRAYSCALE)
    assert image is not None, "cannot read " + name
    found, corners = cv2.findChessboardCornersSB(image, (6, 5), flags=cv2.CALIB_CB_ACCURACY)
    assert found, "no chessboard found in " + name
    return corners


camera = refract.RefractiveCamera.read(os.path.join(DATA, "truth.yml"))
K, D = camera.cameraMatrix(), camera.distCoeffs()

direct, glass = find_corners("direct1/pair1.jpg"), find_corners("glass1/pair1.jpg")
rms, normal, center, covariance = refract.calibrateGlassNormal([direct], [glass], K, D)

off = np.degrees(np.arccos(min(1., float(np.dot(normal.ravel(), camera.window().normal)))))
print(f"normal {normal.ravel()}, +- {np.degrees(np.sqrt(np.trace(covariance)/2)):.3f} degrees per axis")
print(f"distortion centre {center.ravel()} px, RMS {rms:.3f} px")
print(f"off the truth by {off:.3f} degrees: this pane has a wedge of 2 arc minutes, which looks like a tilt; refract_calib knows that")
