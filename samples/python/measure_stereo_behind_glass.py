# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Measures a chessboard with two cameras that look through glass.

    measure_stereo.py | measure_stereo_behind_glass.py [DIRECTORY]      # images as in samples/data/stereo, the default

measure_stereo.py is an ordinary OpenCV script that knows nothing of the glass; measure_stereo_behind_glass.py is the
same script made right. doc/drop_in.md shows what changed.
"""
import glob
import os
import sys

import cv2
import numpy as np
import opencv_refract as refract

DATA = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), "..", "data", "stereo")
SIZE, SQUARE = (6, 5), 39.
BOARD = np.array([(SQUARE*x, SQUARE*y, 0) for y in range(SIZE[1]) for x in range(SIZE[0])], np.float32)


def corners(folder):
    found = []
    for name in sorted(glob.glob(os.path.join(DATA, folder, "*.*"))):
        image = cv2.imread(name, cv2.IMREAD_GRAYSCALE)
        if image is None:
            sys.exit("cannot read " + name)
        ok, points = cv2.findChessboardCornersSB(image, SIZE, flags=cv2.CALIB_CB_ACCURACY)
        if not ok:
            sys.exit("no chessboard found in " + name)
        found.append(points.astype(np.float64))
    return found


def ends(line, width=1280):
    a, b, c = line.ravel()
    return np.array([[[0., -c/b]], [[width, -(c + a*width)/b]]])


def distance(curve, point):
    start, step = curve[:-1, 0], np.diff(curve[:, 0], axis=0)
    t = np.clip(np.sum((point - start)*step, axis=1)/np.sum(step*step, axis=1), 0, 1)
    return np.linalg.norm(start + t[:, None]*step - point, axis=1).min()


def rms(errors):
    return np.sqrt(np.mean(np.square(errors)))


# Each camera, then the rig, from images that were taken without the glass.
air1, air2 = corners("direct1"), corners("direct2")
boards = [BOARD]*len(air1)
single = [[view.astype(np.float32) for view in views] for views in (air1, air2)]
K1, D1 = cv2.calibrateCamera(boards, single[0], (1280, 1024), None, None, flags=cv2.CALIB_FIX_K3)[1:3]
K2, D2 = cv2.calibrateCamera(boards, single[1], (1280, 1024), None, None, flags=cv2.CALIB_FIX_K3)[1:3]
R, T, E, F = cv2.stereoCalibrate(boards, single[0], single[1], K1, D1, K2, D2, (1280, 1024), flags=cv2.CALIB_FIX_INTRINSIC)[5:9]
w1, w2 = (refract.calibrateGlass([BOARD]*6, air, glass, K, D, refract.GlassWindow((0, 0, 1), 20, 1.5437))[1]
          for air, glass, K, D in ((air1[-6:], corners("glass1"), K1, D1), (air2[-6:], corners("glass2"), K2, D2)))
P1, P2 = K1 @ np.eye(3, 4), K2 @ np.hstack((R, T))

lengths, beside, fit = [], [], []
for left, right in zip(corners("measure1"), corners("measure2")):
    points, _ = refract.triangulateRefractive(K1, D1, w1, K2, D2, w2, R, T, left, right)
    u1, _ = refract.refractiveUndistortPoints(left, K1, D1, w1, depth=points[..., 2].ravel(), P=K1)
    curves, partners = refract.computeRefractiveEpilines(left, 1, K1, D1, w1, K2, D2, w2, R, T, (400, 1500))[0], right

    lengths += [np.linalg.norm(points[1:] - points[0], axis=-1).ravel() - np.linalg.norm(BOARD[1:] - BOARD[0], axis=1)]
    beside += [distance(curve, partner) for curve, partner in zip(curves, partners)]
    rvec, tvec = cv2.solvePnP(BOARD, u1, K1, None)[1:]
    fit += [np.linalg.norm(cv2.projectPoints(BOARD, rvec, tvec, K1, None)[0] - u1, axis=2)]

print(f"lengths on the board: {rms(lengths):.3f} mm RMS error")
print(f"partners beside their epipolar curves: {rms(beside):.3f} px RMS")
print(f"board fitted to the left image's undistorted points: {rms(fit):.3f} px RMS")
