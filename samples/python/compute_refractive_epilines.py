# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Where to look for the partner of a point in the other image: a curve, not a line."""
import os

import cv2
import numpy as np
import opencv_refract as refract

CALIB = os.path.join(os.path.dirname(__file__), "..", "data", "stereo", "truth.yml")


def distance_to_curve(curve, point):
    start, step = curve[:-1], np.diff(curve, axis=0)
    t = np.clip(np.sum((point - start)*step, axis=1)/np.sum(step*step, axis=1), 0, 1)
    return np.linalg.norm(start + t[:, None]*step - point, axis=1).min()


camera1 = refract.RefractiveCamera.read(CALIB, "camera1")
camera2 = refract.RefractiveCamera.read(CALIB, "camera2")
file = cv2.FileStorage(CALIB, cv2.FILE_STORAGE_READ)
R = file.getNode("R").mat()
T = file.getNode("T").mat()

# A point at z = 600 and its true image in both cameras.
point = np.array([[30., -40., 600.]])
pixel1, _ = refract.refractiveProjectPoints(point, np.zeros(3), np.zeros(3), camera1)
pixel2, _ = refract.refractiveProjectPoints(point, R, T, camera2)

lines, status = refract.computeRefractiveEpilines(pixel1, 1, camera1, camera2, R, T, (400., 1500.))

curve = lines[0][:, 0]
print(f"curve of {len(curve)} points from {curve[0]} to {curve[-1]}")
print(f"the true partner {pixel2[0, 0]} lies {distance_to_curve(curve, pixel2[0, 0]):.4f} px beside it")
