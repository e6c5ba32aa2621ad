# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""A hundred values from the module's calls, one "name value" a line; values.cpp prints the same. All input is made by
exact arithmetic or decimal literals, so that both programs start from the same bits."""
import numpy as np

try:
    import cv2
    refract = cv2.refract       # OpenCV's own module
except (ImportError, AttributeError):
    import opencv_refract as refract

K = np.array([[2438.5, 0, 644.25], [0, 2440.125, 500.5], [0, 0, 1]])
D = np.array([-0.408, 0.436, 0.001, -0.0005, 0.03])
ZERO, R, T = np.zeros(3), np.array([0.01, 0.3, 0.02]), np.array([-180., 2, 25])


def show(name, values, count):
    """The first `count` numbers of an array, in memory order."""
    values = np.ravel(values)
    assert values.dtype == np.float64 and values.size >= count
    for i in range(count):
        print('%s[%d] %.17g' % (name, i, values[i]))


def pane(x):
    return refract.GlassWindow((x, 0.1, 1), 20, 1.5437, 50)


def port():
    """Two layers into water."""
    window = refract.GlassWindow((0.18, -0.05, 1), 12, 1.49, 30, 1.333)
    window.thickness = [12, 8]
    window.index = [1.49, 1.52]
    return window


def scene():
    return np.array([[20.*i - 70, 13.*((3*i) % 8) - 45, 560 + 9.*i] for i in range(8)])


def show_geometry(points):
    camera1 = refract.RefractiveCamera.create(K, D, pane(-0.25))
    camera2 = refract.RefractiveCamera.create(K, D, pane(0.18))
    in_water = refract.RefractiveCamera.create(K, D, port())
    pixels1, _ = refract.refractiveProjectPoints(points, ZERO, ZERO, camera1)
    pixels2, _ = refract.refractiveProjectPoints(points, R, T, camera2)
    wet, _ = refract.refractiveProjectPoints(points, ZERO, ZERO, in_water)
    show('project.air', pixels1, 10)
    show('project.water', wet, 10)

    origins, directions, _ = refract.refractiveUnprojectPoints(wet, in_water)
    show('unproject.origin', origins, 9)
    show('unproject.direction', directions, 9)

    ideal, _ = refract.refractiveUndistortPoints(pixels1, camera1, depth=np.array([600.]), P=K)
    show('undistort', ideal, 10)
    on_plane, _ = refract.refractivePointsOnPlane(pixels1, camera1, (0.1, -0.05, 1, 600))
    show('plane', on_plane, 9)

    lines, _ = refract.computeRefractiveEpilines(pixels1, 1, camera1, camera2, R, T, (300, 1500))
    for name, line in zip(('epiline', 'epiline2'), lines):
        show(name + '.near', line[0], 2)
        show(name + '.far', line[-1], 2)

    shifted = pixels2 + (0.25, -0.5)        # the rays miss each other
    points3d, _ = refract.triangulateRefractive(camera1, camera2, R, T, pixels1, shifted)
    show('triangulate.optimal', points3d, 9)
    points3d, _ = refract.triangulateRefractive(camera1, camera2, R, T, pixels1, shifted,
                                                flags=refract.TRIANGULATE_MIDPOINT)
    show('triangulate.midpoint', points3d, 9)


def observed(board, rvec, tvec, window, pattern):
    """Pixels that are off by up to 0.1 px, in a pattern."""
    pixels, _ = refract.refractiveProjectPoints(board, rvec, tvec, K, D, window)
    i = np.arange(len(pixels))
    off = np.stack([((37*i + 11*pattern) % 17 - 8)/80., ((23*i + 5*pattern) % 19 - 9)/90.], axis=1)
    return pixels + off[:, None]


def show_calibration():
    board = np.array([[39.*(i % 6) - 97.5, 39.*(i//6) - 78, 0] for i in range(30)])
    direct, refracted = [], []
    for view in range(4):
        rvec = np.array([0.3 - 0.15*view, 0.25*(view % 3) - 0.2, 0.1*view])
        tvec = np.array([10.*(view % 2), 8.*view - 15, 590. + 10*view])
        direct.append(observed(board, rvec, tvec, refract.GlassWindow(), 2*view))
        refracted.append(observed(board, rvec, tvec, pane(-0.25), 2*view + 1))
    rms, normal, center, _ = refract.calibrateGlassNormal(direct, refracted, K, D)
    show('calibrateGlassNormal.rms', rms, 1)
    show('calibrateGlassNormal.normal', normal, 3)
    show('calibrateGlassNormal.center', center, 2)

    rms, window, rvecs, tvecs = refract.calibrateGlass(
        [board]*4, direct, refracted, K, D, pane(0), flags=refract.GLASS_FREE_THICKNESS,
        criteria=(1, 50, 0))        # a count of 50
    show('calibrateGlass.rms', rms, 1)
    show('calibrateGlass.normal', np.array(window.normal), 3)
    show('calibrateGlass.thickness', np.array(window.thickness), 1)
    show('calibrateGlass.rvec', rvecs[3], 3)
    show('calibrateGlass.tvec', tvecs[3], 3)


show_geometry(scene())
show_calibration()
