# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What a call of one point costs from Python, in microseconds: the best of many rounds, which a busy machine disturbs least.

Usage: small_calls.py [ROUNDS]"""
import sys
import timeit

import numpy as np
import opencv_refract as refract

K = np.array([[2438., 0, 644], [0, 2438, 500], [0, 0, 1]])
D = np.array([-0.4082, 0.4359, 0, 0, 0])
zero, R, T = np.zeros(3), np.array([0.01, 0.3, 0]), np.array([-180., 2, 25])
windows = [refract.GlassWindow((x, 0.1, 1), 20, 1.5437, 50) for x in (-0.25, 0.18)]
camera1, camera2 = (refract.RefractiveCamera.create(K, D, window) for window in windows)
point = np.array([[10., 20., 600.]])
left = refract.refractiveProjectPoints(point, zero, zero, camera1)[0]
right = refract.refractiveProjectPoints(point, R, T, camera2)[0]

CALLS = {
    "project": lambda: refract.refractiveProjectPoints(point, zero, zero, camera1),
    "undistort": lambda: refract.refractiveUndistortPoints(left, camera1, 600.),
    "undistort, depth=": lambda: refract.refractiveUndistortPoints(left, camera1, depth=600.),
    "triangulate": lambda: refract.triangulateRefractive(camera1, camera2, R, T, left, right),
    "project, with lens and window": lambda: refract.refractiveProjectPoints(point, zero, zero, K, D, windows[0]),
    "triangulate, rig": lambda: refract.triangulateRefractive([camera1, camera2], [np.eye(3), R], [zero, T], [left, right]),
}


def main(rounds=2000, count=100):
    for name, call in CALLS.items():
        call()
        print(f"{name:30s} {min(timeit.repeat(call, number=count, repeat=rounds))/count*1e6:6.2f} us")


main(*map(int, sys.argv[1:]))
