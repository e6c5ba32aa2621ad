# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What Python costs: each call of a million points from Python and, in the same process on the same arrays, from C++.

Usage: overhead.py LIBRARY [POINTS]     LIBRARY is calls.cpp, compiled; run.sh does both"""
import ctypes
import statistics
import sys
import time

import numpy as np
import opencv_refract as refract

ROUNDS = 15
K = np.array([[2438., 0, 644], [0, 2438, 500], [0, 0, 1]])
D = np.array([-0.4082, 0.4359, 0, 0, 0])
ZERO, R, T = np.zeros(3), np.array([0.01, 0.3, 0]), np.array([-180., 2, 25])


def camera(x):
    return refract.RefractiveCamera.create(K, D, refract.GlassWindow((x, 0.1, 1), 20, 1.5437, 50))


def seconds(call):
    start = time.perf_counter()
    result = call()
    stop = time.perf_counter()
    del result
    return stop - start


def layouts(points):
    """The same points in one piece; as columns of a wider table; and backwards, which only a copy makes a cv::Mat."""
    table = np.zeros((len(points), points.shape[1] + 3))
    table[:, 1:1 + points.shape[1]] = points
    return ('contiguous', points), ('columns', table[:, 1:1 + points.shape[1]]), ('backwards', points[::-1])


def compare(name, layout, from_python, from_cpp, count):
    """Alternating rounds, so that a busy machine disturbs both alike."""
    for call in (lambda: seconds(from_python), from_cpp):
        call()      # warm
    pairs = [(seconds(from_python), from_cpp()) for _ in range(ROUNDS)]
    python, cpp = (statistics.median(times) for times in zip(*pairs))
    over = statistics.median(a/b for a, b in pairs) - 1
    print('%-28s %-11s %10.1f %10.1f %+9.1f %%' % (name, layout, python/count*1e9, cpp/count*1e9, 100*over))


def main(library, count=1000000):
    cpp = ctypes.CDLL(library)
    for function in (cpp.project, cpp.undistort, cpp.unproject, cpp.triangulate):
        function.restype = ctypes.c_double
    generator = np.random.default_rng(1)
    scene = generator.uniform((-90, -70, 560), (90, 70, 660), (count, 3))
    camera1, camera2 = camera(-0.25), camera(0.18)
    pixels1 = refract.refractiveProjectPoints(scene, ZERO, ZERO, camera1)[0].reshape(-1, 2)
    pixels2 = refract.refractiveProjectPoints(scene, R, T, camera2)[0].reshape(-1, 2)

    def run(name, arrays, from_python, from_cpp):
        """arrays: one or two in the same layout; where that is backwards, C++ has them forwards, without a copy."""
        forward = [a if a.strides[0] > 0 else a[::-1] for a in arrays]
        data = [ctypes.c_void_p(a.ctypes.data) for a in forward] + [count, ctypes.c_size_t(forward[0].strides[0])]
        compare(name, layout, lambda: from_python(*arrays), lambda: from_cpp(*data), count)

    print('%-28s %-11s %10s %10s %11s' % ('%d points, ns a point' % count, '', 'Python', 'C++', 'overhead'))
    for layout, points in layouts(scene):
        run('refractiveProjectPoints', [points],
            lambda a: refract.refractiveProjectPoints(a, ZERO, ZERO, camera1), cpp.project)
    for layout, points in layouts(pixels1):
        run('refractiveUndistortPoints', [points],
            lambda a: refract.refractiveUndistortPoints(a, camera1, depth=np.array([600.])), cpp.undistort)
        run('refractiveUnprojectPoints', [points],
            lambda a: refract.refractiveUnprojectPoints(a, camera1), cpp.unproject)
    for (layout, first), (_, second) in zip(layouts(pixels1), layouts(pixels2)):
        run('triangulateRefractive', [first, second],
            lambda a, b: refract.triangulateRefractive(camera1, camera2, R, T, a, b), cpp.triangulate)


main(sys.argv[1], *map(int, sys.argv[2:]))
