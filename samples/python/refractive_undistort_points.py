# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Measures on a plane with one camera behind a window: raw pixels -> where a camera without lens distortion and window
would see them -> lengths. In an existing program replace undistortPoints by refractiveUndistortPoints."""
import os

import cv2
import numpy as np
import opencv_refract as refract

CALIB = os.path.join(os.path.dirname(__file__), "..", "data", "stereo", "truth.yml")
DEPTH = 600.        # z of the measured plane

camera = refract.RefractiveCamera.read(CALIB, "camera1")
K, D, window = camera.cameraMatrix(), camera.distCoeffs(), camera.window()

# A bar of 156 mm on the plane, and its two ends in the raw image.
bar = np.array([[-78., 20., DEPTH], [78., 20., DEPTH]])
raw, _ = refract.refractiveProjectPoints(bar, np.zeros(3), np.zeros(3), K, D, window)

before = cv2.undistortPoints(raw, K, D)
after, status = refract.refractiveUndistortPoints(raw, K, D, window, depth=DEPTH)

print("true length        156.000")
print(f"window ignored     {DEPTH*np.linalg.norm(before[1] - before[0]):.3f}")
print(f"window corrected   {DEPTH*np.linalg.norm(after[1] - after[0]):.3f}")
