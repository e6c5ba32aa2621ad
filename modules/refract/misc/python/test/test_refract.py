#!/usr/bin/env python
# This file is part of OpenCV project.
# It is subject to the license terms in the LICENSE file found in the top-level directory
# of this distribution and at http://opencv.org/license.html.

import functools
import math
import os
import tempfile

import cv2 as cv
import numpy as np

from tests_common import NewOpenCVTests

K = np.array([[2438., 0, 644], [0, 2438, 500], [0, 0, 1]])
D = np.array([-0.4082, 0.4359, 0, 0])
R = cv.Rodrigues(np.array([0.01, 0.3, 0]))[0]
T = np.array([-180., 2, 25])


def make_window(x=-0.25):
    return cv.refract.GlassWindow((x, 0.1, 1), 20, 1.5437, 50)


def make_camera(x=-0.25):
    return cv.refract.RefractiveCamera.create(K, D, make_window(x))


def make_board():
    grid = np.mgrid[0:6, 0:5].T.reshape(-1, 2)*39. - (97.5, 78)
    return np.hstack([grid, np.zeros((len(grid), 1))])


def make_views(camera, second=False):
    """Perfect views of the board in five poses, in camera 1 or, by R and T, in camera 2."""
    views = []
    for i in range(5):
        r = cv.Rodrigues(np.array([0.3 - 0.15*i, 0.25*(i % 3) - 0.2, 0.1*i]))[0]
        t = np.array([10.*(i % 2), 8.*i - 15, 590. + 10*i])
        if second:
            r, t = R.dot(r), R.dot(t) + T
        pixels, status = cv.refract.refractiveProjectPoints(make_board(), r, t, camera)
        assert not status.any()
        views.append(pixels)
    return views


def needs_ceres(test):
    """Skips where the module was built without Ceres."""
    @functools.wraps(test)
    def run(self):
        try:
            test(self)
        except cv.error as error:
            if 'needs the library Ceres' not in str(error):
                raise
            self.skipTest('no Ceres')
    return run


class refract_test(NewOpenCVTests):

    def setUp(self):
        super().setUp()
        self.zero = np.zeros(3)
        self.camera1, self.camera2 = make_camera(), make_camera(0.18)
        self.points = make_board()*0.8 + (0, 0, 600)
        self.points[:, 2] += np.arange(30) % 9
        self.pixels1, status1 = cv.refract.refractiveProjectPoints(self.points, self.zero, self.zero, self.camera1)
        self.pixels2, status2 = cv.refract.refractiveProjectPoints(self.points, R, T, self.camera2)
        self.assertFalse(status1.any() or status2.any())

    def assertClose(self, a, b, tolerance):
        a, b = np.asarray(a), np.asarray(b)
        np.testing.assert_allclose(a.ravel(), b.ravel(), rtol=0, atol=tolerance)

    def test_window(self):
        window = cv.refract.GlassWindow()
        self.assertEqual(((0, 0, 1), 0, 1, 1), (window.normal, window.distance, window.innerIndex, window.outerIndex))
        self.assertEqual(0, len(window.thickness) + len(window.index))
        window.normal = (0, 0.6, 0.8)
        window.distance = 30
        window.thickness = [6, 0.76, 6]
        window.index = [1.52, 1.48, 1.52]
        window.innerIndex, window.outerIndex = 1.333, 1.0
        window.check()
        self.assertEqual((0, 0.6, 0.8), window.normal)
        self.assertEqual((30, 1.333, 1), (window.distance, window.innerIndex, window.outerIndex))
        self.assertEqual([6, 0.76, 6], list(window.thickness))
        self.assertEqual([1.52, 1.48, 1.52], list(window.index))
        window.wedge = [(1e-3, 0), (0, 0), (-1e-3, 2e-3)]
        window.check()
        self.assertEqual([(1e-3, 0), (0, 0), (-1e-3, 2e-3)], [tuple(pair) for pair in window.wedge])
        window.index = [0.9, 1.48, 1.52]
        with self.assertRaisesRegex(cv.error, r'window\.index\[0\] is 0\.9'):
            window.check()

    def test_dome(self):
        dome = cv.refract.GlassWindow.dome((1, -2, 3), 50, 7, 1.5, 1.33)
        self.assertEqual((cv.refract.WINDOW_DOME, (1, -2, 3), 50), (dome.shape, dome.center, dome.radius))
        camera = cv.refract.RefractiveCamera.create(np.diag([1000., 1000, 1]), None, dome)
        self.assertEqual(('center[2]', 'radius'), tuple(camera.parameterNames()[6:8]))
        with self.assertRaisesRegex(cv.error, 'inside the dome'):
            cv.refract.GlassWindow.dome((0, 0, 60), 50, 7, 1.5)

    def test_tube(self):
        tube = cv.refract.GlassWindow.tube((1, -2, 3), (0, 2, 0), 50, 7, 1.5, 1.33)
        self.assertEqual((cv.refract.WINDOW_TUBE, (1, 0, 3), (0, 1, 0), 50), (tube.shape, tube.center, tube.axis, tube.radius))
        camera = cv.refract.RefractiveCamera.create(np.diag([1000., 1000, 1]), None, tube)
        self.assertEqual(tube.axis, camera.window().axis)
        with self.assertRaisesRegex(cv.error, 'inside the tube'):
            cv.refract.GlassWindow.tube((60, 0, 0), (0, 1, 0), 50, 7, 1.5)

    def test_window_defaults(self):
        window = cv.refract.GlassWindow(normal=(0, 0, 2), thickness=10, index=1.5)
        self.assertEqual(((0, 0, 1), 0, 1), (window.normal, window.distance, window.outerIndex))

    def test_refractive_index(self):
        self.assertAlmostEqual(1.51680, cv.refract.refractiveIndex('N-BK7', 587.5618), delta=1e-5)
        self.assertEqual(cv.refract.refractiveIndex('water', 550), cv.refract.refractiveIndex('water:T=20'))
        self.assertEqual(0.0005, cv.refract.refractiveIndexTolerance('N-BK7'))
        self.assertRaisesRegex(cv.error, "nearest is 'N-BK7'", cv.refract.refractiveIndex, 'N-BK8')

    def test_camera(self):
        self.assertClose(K, self.camera1.cameraMatrix(), 0)
        self.assertClose(D, self.camera1.distCoeffs(), 0)
        self.assertEqual('opencv', self.camera1.lensModel())
        self.assertEqual((0, 0), self.camera1.imageSize())
        self.camera1.setImageSize((1280, 1024))
        self.assertEqual((1280, 1024), self.camera1.imageSize())
        self.assertEqual(8, self.camera1.lensParameters().size)
        self.camera1.setLensParameters(self.camera1.lensParameters()*1.01)
        self.assertClose(2438*1.01, self.camera1.cameraMatrix()[0, 0], 1e-9)
        self.camera1.setWindow(cv.refract.GlassWindow())
        self.assertEqual(0, len(self.camera1.window().thickness))
        self.assertEqual('fisheye', cv.refract.RefractiveCamera.createFisheye(K, None, make_window()).lensModel())
        mrcal = cv.refract.RefractiveCamera.createMrcal('LENSMODEL_PINHOLE', np.array([2438., 2438, 644, 500]))
        self.assertEqual('LENSMODEL_PINHOLE', mrcal.lensModel())
        self.assertIn('fisheye', cv.refract.RefractiveCamera.lensModels())
        self.assertEqual('LENSMODEL_LONLAT', cv.refract.RefractiveCamera.createByName('LENSMODEL_LONLAT', K, None).lensModel())

    def test_camera_is_cloned(self):
        copy = self.camera1.clone()
        copy.setWindow(cv.refract.GlassWindow())
        self.assertEqual(1, len(self.camera1.window().thickness))
        self.assertClose(copy.lensParameters(), self.camera1.lensParameters(), 0)

    def test_camera_in_a_file_of_ones_own(self):
        storage = cv.FileStorage('.yml', cv.FILE_STORAGE_WRITE | cv.FILE_STORAGE_MEMORY)
        self.camera1.write(storage, 'left')
        storage = cv.FileStorage(storage.releaseAndGetString(), cv.FILE_STORAGE_READ | cv.FILE_STORAGE_MEMORY)
        camera = cv.refract.RefractiveCamera.read(storage.getNode('left'))
        self.assertClose(self.camera1.lensParameters(), camera.lensParameters(), 0)
        self.assertClose(self.camera1.window().normal, camera.window().normal, 1e-15)

    def test_camera_is_read(self):
        handle, filename = tempfile.mkstemp('.yml')
        os.close(handle)
        try:
            storage = cv.FileStorage(filename, cv.FILE_STORAGE_WRITE)
            storage.write('camera_matrix', K)
            storage.write('distortion_coefficients', D)
            storage.release()
            self.assertClose(K, cv.refract.RefractiveCamera.read(filename).cameraMatrix(), 0)
        finally:
            os.remove(filename)
        with self.assertRaisesRegex(cv.error, 'cannot be opened'):
            cv.refract.RefractiveCamera.read(filename)

    def test_project(self):
        pixels, status = cv.refract.refractiveProjectPoints(self.points, self.zero, self.zero, K, D, make_window())
        self.assertClose(self.pixels1, pixels, 0)
        self.assertEqual(((30, 1, 2), np.float64, np.uint8), (pixels.shape, pixels.dtype, status.dtype))
        pinhole = cv.projectPoints(self.points, self.zero, self.zero, K, D)[0]
        self.assertClose(pinhole, cv.refract.refractiveProjectPoints(self.points, self.zero, self.zero, K, D,
                                                                     cv.refract.GlassWindow())[0], 1e-9)
        pixels, status, jacobian = cv.refract.refractiveProjectPointsExtended(self.points, self.zero, self.zero,
                                                                              self.camera1)
        self.assertEqual((60, 6 + 8 + 8), jacobian.shape)
        self.assertClose(self.pixels1, pixels, 1e-9)

    def test_arrays(self):
        def project(points):
            return cv.refract.refractiveProjectPoints(points, self.zero, self.zero, self.camera1)[0]

        wide = np.empty((60, 5))
        wide[::2, 1:4] = self.points
        expected = project(self.points)
        for view in (wide[::2, 1:4], np.asfortranarray(self.points), self.points[:, None, :], self.points[None, :, :],
                     self.points.tolist()):
            self.assertClose(expected, project(np.asarray(view)), 0)
        single = project(self.points.astype(np.float32))
        self.assertEqual(np.float32, single.dtype)
        self.assertClose(expected, single, 1e-3)
        backwards = project(self.points[::-1])
        self.assertClose(expected[::-1], backwards, 0)
        with self.assertRaisesRegex(cv.error, 'objectPoints'):
            project(np.zeros((5, 4)))

    def test_no_answer(self):
        points = np.array([[0, 0, 600.], [0, 0, 40], [math.nan, 0, 600]])
        pixels, status = cv.refract.refractiveProjectPoints(points, self.zero, self.zero, self.camera1)
        self.assertEqual([cv.refract.REFRACT_OK, cv.refract.REFRACT_BEHIND_WINDOW, cv.refract.REFRACT_NOT_FINITE],
                         list(status.ravel()))
        self.assertEqual([False, True, True], list(np.isnan(pixels).all(axis=(1, 2))))
        with self.assertRaisesRegex(cv.error, 'camera is empty'):
            cv.refract.refractiveProjectPoints(points, self.zero, self.zero, None)

    def test_unproject(self):
        origins, directions, status = cv.refract.refractiveUnprojectPoints(self.pixels1, self.camera1)
        self.assertFalse(status.any())
        misses = np.cross(directions.reshape(-1, 3), self.points - origins.reshape(-1, 3))
        self.assertClose(misses, np.zeros_like(misses), 1e-8)
        self.assertClose(directions, cv.refract.refractiveUnprojectPoints(self.pixels1, K, D, make_window())[1], 0)

    def test_undistort(self):
        depth = self.points[:, 2]
        expected = self.points[:, :2]/depth[:, None]
        normalized, status = cv.refract.refractiveUndistortPoints(self.pixels1, self.camera1, depth=depth)
        self.assertClose(expected, normalized, 1e-12)
        pixels, status = cv.refract.refractiveUndistortPoints(self.pixels1, K, D, make_window(), depth=depth, P=K)
        self.assertClose(expected*2438 + (644, 500), pixels, 1e-9)
        self.assertEqual(30, len(cv.refract.refractiveUndistortPoints(self.pixels1, K, D, make_window(), depth)[0]))

    def test_one_depth_for_four_points(self):
        points = np.array([[-60., 30, 600], [-20, 10, 600], [20, -10, 600], [60, -30, 600]])
        pixels = cv.refract.refractiveProjectPoints(points, self.zero, self.zero, self.camera1)[0]
        for depth in (600., 600, np.float64(600), np.array([600.]), np.full(4, 600.), np.full(4, 600, np.uint16)):
            for args in ((self.camera1,), (K, D, make_window())):
                ideal = cv.refract.refractiveUndistortPoints(pixels, *args, depth)[0]
                self.assertClose(points[:, :2]/600, ideal, 1e-10)
                raw, status = cv.refract.refractiveDistortPoints(ideal, *args, depth)
                self.assertClose(pixels, raw, 1e-7)
                self.assertFalse(status.any())
        with self.assertRaisesRegex(cv.error, 'depth is'):
            cv.refract.refractiveUndistortPoints(pixels, self.camera1, None)
        bare = cv.refract.RefractiveCamera.create(K, D)
        self.assertClose(cv.refract.refractiveUndistortPoints(pixels, bare, None)[0],
                         cv.refract.refractiveUndistortPoints(pixels, bare, 700)[0], 0)

    def test_images(self):
        image = np.zeros((1024, 1280, 3), np.uint8)
        for args in ((self.camera1,), (K, D, make_window())):
            for depth in (600., np.array([0., 0, 1, 600])):
                new, roi = cv.refract.getOptimalNewRefractiveCameraMatrix(*args, depth, (1280, 1024), 0)
                self.assertEqual(((3, 3), (0, 0, 1280, 1024)), (new.shape, tuple(roi)))
                undistorted = cv.refract.refractiveUndistortImage(image + 99, *args, depth, newCameraMatrix=new)
                self.assertEqual(99, undistorted.min())
            drawn = cv.refract.drawRefractiveFrameAxes(image.copy(), *args, np.array([0.4, -0.5, 0.1]), np.array([0., 0, 600]), 60)
            self.assertEqual([True]*3, [bool(drawn[:, :, c].any()) for c in range(3)])

    def test_epipolar_distance(self):
        moved = self.pixels2 - (0, 3)
        for args in ((self.camera1, self.camera2), (K, D, make_window(), K, D, make_window(0.18))):
            none, status = cv.refract.refractiveEpipolarDistance(self.pixels1, self.pixels2, *args, R, T)
            self.assertEqual(((30, 1), False), (none.shape, bool(status.any())))
            self.assertClose(np.zeros(30), none, 1e-6)
            distance = cv.refract.refractiveEpipolarDistance(self.pixels1, moved, *args, R, T)[0]
            self.assertTrue((np.abs(distance) > 2.5).all() and (np.abs(distance) < 3.01).all())
        _, _, depths, jacobian = cv.refract.refractiveEpipolarDistanceExtended(
            self.pixels1, moved, self.camera1, self.camera2, R, T, 1, (0, math.inf))
        self.assertEqual(((30, 1), (30, 10)), (depths.shape, jacobian.shape))
        self.assertClose(-3*jacobian[:, 3], distance, 0.02)

    def test_spline_weights(self):
        intrinsics = np.zeros(4 + 2*9*8)
        intrinsics[:4] = 600, 600, 320, 240
        model = 'LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=9_Ny=8_fov_x_deg=110'
        camera = cv.refract.RefractiveCamera.createMrcal(model, intrinsics, make_window())
        controls, weights, status = cv.refract.refractiveSplineWeights(self.points, self.zero, self.zero, camera)
        self.assertEqual(((30, 16), (30, 16), np.int32), (controls.shape, weights.shape, controls.dtype))
        self.assertFalse(status.any())
        self.assertClose(np.ones(30), weights.sum(axis=1), 1e-12)
        before = cv.refract.refractiveProjectPoints(self.points, self.zero, self.zero, camera)[0]
        intrinsics[4 + 2*controls[7, 5]] += 1e-4
        camera = cv.refract.RefractiveCamera.createMrcal(model, intrinsics, make_window())
        after = cv.refract.refractiveProjectPoints(self.points, self.zero, self.zero, camera)[0]
        self.assertClose(600*weights[7, 5], (after - before)[7, 0, 0]/1e-4, 1e-4)

    def test_map(self):
        new = np.array([[120., 0, 32], [0, 120, 24], [0, 0, 1]])
        for args in ((self.camera1,), (K, D, make_window())):
            x, y = cv.refract.initRefractiveUndistortRectifyMap(*args, np.array([600.]), None, new, (64, 48),
                                                                cv.CV_32FC1)
            self.assertEqual(((48, 64), (48, 64)), (x.shape, y.shape))
            point = np.array([[(40 - 32)*5., (8 - 24)*5, 600]])
            expected = cv.refract.refractiveProjectPoints(point, self.zero, self.zero, self.camera1)[0]
            self.assertClose(expected, (x[8, 40], y[8, 40]), 1e-3)

    def test_plane(self):
        points = self.points.copy()
        points[:, 2] = 600 - 0.2*points[:, 0]
        pixels = cv.refract.refractiveProjectPoints(points, self.zero, self.zero, self.camera1)[0]
        found, status = cv.refract.refractivePointsOnPlane(pixels, self.camera1, (0.2, 0, 1, 600))
        self.assertClose(points, found, 1e-8)
        self.assertClose(found, cv.refract.refractivePointsOnPlane(pixels, K, D, make_window(), (0.2, 0, 1, 600))[0], 0)

    def test_epilines(self):
        lines, status = cv.refract.computeRefractiveEpilines(self.pixels1, 1, self.camera1, self.camera2, R, T,
                                                             (300, math.inf), tolerance=0.01)
        self.assertEqual((30, 0), (len(lines), np.count_nonzero(status)))
        for line, pixel in zip(lines, self.pixels2):
            a, b = line[:-1, 0], line[1:, 0]
            t = np.clip(np.sum((pixel - a)*(b - a), axis=1)/np.sum((b - a)**2, axis=1), 0, 1)
            self.assertLess(np.linalg.norm(pixel - a - t[:, None]*(b - a), axis=1).min(), 0.0105)
        same, _ = cv.refract.computeRefractiveEpilines(self.pixels1, 1, K, D, make_window(), K, D, make_window(0.18),
                                                       R, T, (300, math.inf))
        self.assertClose(lines[7], same[7], 0)

    def test_triangulate(self):
        points, status = cv.refract.triangulateRefractive(self.camera1, self.camera2, R, T, self.pixels1, self.pixels2)
        self.assertEqual((30, 1, 3), points.shape)
        self.assertClose(self.points, points, 1e-6)
        points, status = cv.refract.triangulateRefractive(
            K, D, make_window(), K, D, make_window(0.18), R, T, self.pixels1, self.pixels2,
            flags=cv.refract.TRIANGULATE_MIDPOINT)
        self.assertClose(self.points, points, 1e-6)
        points, status, covariance, errors = cv.refract.triangulateRefractiveExtended(
            self.camera1, self.camera2, R, T, self.pixels1, self.pixels2, cv.refract.TRIANGULATE_OPTIMAL, 0.1, None)
        self.assertEqual(((30, 9), (30, 2)), (covariance.shape, errors.shape))
        self.assertLess(errors.max(), 1e-6)
        self.assertTrue((covariance[:, [0, 4, 8]] > 0).all())

    def test_half_pixels(self):
        half = np.array(self.pixels2, dtype=float).reshape(-1, 2)
        half[:, 1] = np.nan
        rig = [self.camera1, self.camera2], [np.eye(3), R], [np.zeros(3), T], [self.pixels1, half]
        points, status = cv.refract.triangulateRefractive(*rig)
        self.assertEqual(0, status.max())
        self.assertClose(self.points, points, 1e-6)
        covariances = [np.tile(4*np.eye(2), (len(half), 1, 1)), np.tile([4., 0, 4], (len(half), 1))]
        plain = cv.refract.triangulateRefractiveExtended(*rig, 0, 0.2, None)
        weighted = cv.refract.triangulateRefractiveExtended(*rig, 0, 0.1, None, pixelCovariances=covariances)
        self.assertClose(plain[2], weighted[2], 1e-9*plain[2].max())

    def test_calibrate_normal(self):
        direct = make_views(cv.refract.RefractiveCamera.create(K, D))
        refracted = make_views(self.camera1)
        rms, normal, center, covariance = cv.refract.calibrateGlassNormal(direct, refracted, K, D)
        self.assertClose(make_window().normal, normal, 1e-8)
        self.assertEqual(((2, 1), (3, 3)), (center.shape, covariance.shape))
        self.assertClose(normal, cv.refract.calibrateGlassNormal(direct, refracted, self.camera1)[1], 0)
        with self.assertRaisesRegex(cv.error, 'the normal is undetermined'):
            cv.refract.calibrateGlassNormal(direct, direct, K, D)

    @needs_ceres
    def test_calibrate_glass(self):
        boards = [make_board()]*5
        direct, refracted = make_views(cv.refract.RefractiveCamera.create(K, D)), make_views(self.camera1)
        start = cv.refract.GlassWindow((0, 0, 1), 15, 1.5437, 50)
        rms, window, rvecs, tvecs = cv.refract.calibrateGlass(boards, direct, refracted, K, D, start,
                                                              flags=cv.refract.GLASS_FREE_THICKNESS)
        self.assertLess(rms, 1e-6)
        self.assertClose(make_window().normal, window.normal, 1e-6)
        self.assertClose(20, window.thickness[0], 1e-4)
        self.assertEqual((5, 5), (len(rvecs), len(tvecs)))

        camera = cv.refract.RefractiveCamera.create(K, D, cv.refract.GlassWindow((0, 0, 1), 20, 1.5437, 50))
        rms, rvecs, tvecs, deviations, covariance, per_view, jacobian = cv.refract.calibrateGlassExtended(
            boards, None, refracted, camera)
        self.assertLess(rms, 1e-6)
        self.assertClose(make_window().normal, camera.window().normal, 1e-6)
        self.assertEqual(((16, 1), (16, 16), (5, 2)), (deviations.shape, covariance.shape, per_view.shape))

    @needs_ceres
    def test_calibrate_stereo(self):
        boards = [make_board()]*5
        bare = cv.refract.RefractiveCamera.create(K, D)
        first, second = (cv.refract.RefractiveCamera.create(K, D, cv.refract.GlassWindow((0, 0, 1), 20, 1.5437, 50))
                         for _ in range(2))
        result = cv.refract.stereoCalibrateGlass(boards, make_views(bare), make_views(self.camera1),
                                                 make_views(bare, True), make_views(self.camera2, True),
                                                 first, second, R.copy(), T.copy())
        self.assertLess(result[0].rms, 1e-6)
        self.assertEqual((5, 4), result[0].perViewErrors.shape)
        self.assertClose(make_window().normal, first.window().normal, 1e-6)
        self.assertClose(make_window(0.18).normal, second.window().normal, 1e-6)

    @needs_ceres
    def test_calibrate_rig(self):
        bare = cv.refract.RefractiveCamera.create(K, D)
        cameras = [cv.refract.RefractiveCamera.create(K, D, cv.refract.GlassWindow((0, 0, 1), 20, 1.5437, 50))
                   for _ in range(2)]
        options = cv.refract.GlassRigOptions(cv.refract.GLASS_ROBUST)
        result = cv.refract.calibrateGlassRigExtended(
            [make_board()]*5, [make_views(bare), make_views(bare, True)],
            [make_views(self.camera1), make_views(self.camera2, True)], cameras, [0, 1], [np.eye(3), R.copy()], [np.zeros(3), T.copy()],
            [], [], options)
        self.assertEqual((5, 20, (2, 5)), (len(result), len(result[0].inliers), result[0].otherMinima.shape))
        options.targetCovariance = 1e-6*np.eye(7)
        options.cameraCovariances = [1e-2*np.eye(8), None]
        self.assertEqual((cv.refract.GLASS_ROBUST, (8, 8)), (options.flags, options.cameraCovariances[0].shape))
        options.cameraCovariances = []
        moved = cv.refract.calibrateGlassRigExtended(
            [make_board()]*5, [make_views(bare), make_views(bare, True)],
            [make_views(self.camera1), make_views(self.camera2, True)], [camera.clone() for camera in cameras], [0, 1],
            [np.eye(3), R.copy()], [np.zeros(3), T.copy()], [], [], options)
        self.assertEqual((7, 1), moved[0].targetErrors.shape)
        rms, Rs, Ts, rvecs, tvecs = cv.refract.calibrateGlassRig(
            [make_board()]*5, [make_views(bare), make_views(bare, True)],
            [make_views(self.camera1), make_views(self.camera2, True)], [camera.clone() for camera in cameras], [],
            [np.eye(3), R.copy()], [np.zeros(3), T.copy()])
        self.assertLess(rms, 1e-6)
        self.assertEqual((2, 5), (len(Rs), len(tvecs)))
        self.assertLess(result[0].rms, 1e-6)
        self.assertClose(make_window().normal, cameras[0].window().normal, 1e-6)
        self.assertClose(make_window(0.18).normal, cameras[1].window().normal, 1e-6)

    def test_stereo(self):
        size = (1280, 1024)
        results = cv.refract.refractiveStereoRectify(self.camera1, self.camera2, R, T, size, (400, 1000))
        R1, R2, P1, P2, Q = results[:5]
        self.assertEqual(((3, 4), (3, 4), (4, 4)), (P1.shape, P2.shape, Q.shape))
        maps1 = cv.refract.initRefractiveStereoRectifyMap(self.camera1, 600., R1, P1, None, size, cv.CV_32FC1)
        maps2 = cv.refract.initRefractiveStereoRectifyMap(self.camera2, 600., R2, P2, T, size, cv.CV_32FC1)
        self.assertEqual([(1024, 1280)]*4, [m.shape for m in maps1 + maps2])
        disparity = np.full((1024, 1280), 700, np.float32)
        depth1, depth2 = cv.refract.refractiveRectifiedDepth(disparity, P1, P2, size)[:2]
        self.assertEqual(((1024, 1280), (1024, 1280)), (depth1.shape, depth2.shape))
        with self.assertRaisesRegex(cv.error, 'do not belong together'):
            cv.refract.initRefractiveStereoRectifyMap(self.camera2, 600., R2, P2, None, size, cv.CV_32FC1)

    @needs_ceres
    def test_bundle_adjust(self):
        points = self.points + np.array([0, 0, 7.])*(np.arange(30) % 5)[:, None]
        pixels = [cv.refract.refractiveProjectPoints(points, self.zero, self.zero, self.camera1)[0],
                  cv.refract.refractiveProjectPoints(points, R, T, self.camera2)[0]]
        lengths = np.array([[i, 29 - i, np.linalg.norm(points[i] - points[29 - i]), 0.01] for i in range(15)])
        cameras = [self.camera1.clone(), self.camera2.clone()]
        result = cv.refract.refractiveBundleAdjustExtended(
            [[pixels[0]], [pixels[1]]], cameras, [0, 1], [np.eye(3), R.copy()], [np.zeros(3), T.copy()], [self.zero.copy()],
            [self.zero.copy()], points + 0.5, lengths, cv.refract.BundleAdjustOptions())
        self.assertLess(result[0].rms, 1e-5)
        self.assertClose(points, result[5], 1e-3)
        options = cv.refract.BundleAdjustOptions()
        options.rigCovariance = np.zeros(result[0].covariance.shape)
        options.lengthScaleStd = 1e-3
        known = cv.refract.refractiveBundleAdjustExtended(
            [[pixels[0]], [pixels[1]]], cameras, [0, 1], [np.eye(3), R.copy()], [np.zeros(3), T.copy()], [self.zero.copy()],
            [self.zero.copy()], points + 0.5, lengths, options)
        self.assertClose(points, known[5], 1e-3)
        self.assertGreater(np.nanmin(known[0].pointDeviations[:, 2]/points[:, 2]), 1e-4)
        observations = np.array([(0, camera, point) for camera in range(2) for point in range(30)], np.int32)
        listed = cv.refract.refractiveBundleAdjustSparse(
            observations, np.concatenate([p.reshape(-1, 2) for p in pixels]), cameras, [0, 1], [np.eye(3), R.copy()],
            [np.zeros(3), T.copy()], [self.zero.copy()], [self.zero.copy()], points + 0.5, lengths, cv.refract.BundleAdjustOptions())
        self.assertLess(listed[0].rms, 1e-5)
        self.assertClose(points, listed[5], 1e-3)
        self.assertEqual(((60, 1), (6, 6)), (listed[0].inliers[0].shape, listed[0].viewCovariances[0].shape))

    def test_pnp_generic_extended(self):
        pose = np.array([0.1, -0.2, 0.3]), np.array([10., -5, 620])
        pixels = cv.refract.refractiveProjectPoints(make_board(), *pose, self.camera1)[0]
        count, rvecs, tvecs, errors, covariances = cv.refract.refractiveSolvePnPGenericExtended(
            make_board(), pixels, self.camera1, False, None, None, sigma=0.1)
        self.assertEqual([count]*4, [len(a) for a in (rvecs, tvecs, errors, covariances)])
        self.assertEqual((6, 6), covariances[0].shape)
        self.assertClose(pose[1], tvecs[0], 1e-4)

    def test_rig_is_written_and_read(self):
        handle, filename = tempfile.mkstemp('.yml')
        os.close(handle)
        try:
            cv.refract.writeRig(filename, [self.camera1, self.camera2], [np.eye(3), R], [np.zeros(3), T], [0, 1])
            cameras, Rs, Ts = cv.refract.readRig(filename)
            windows = cv.refract.readRigExtended(filename)[3]
        finally:
            os.remove(filename)
        self.assertEqual((2, 2, 2, [0, 1]), (len(cameras), len(Rs), len(Ts), list(windows)))
        self.assertClose(R, Rs[1], 1e-12)
        self.assertClose(T, Ts[1], 1e-9)
        self.assertClose(self.camera2.window().normal, cameras[1].window().normal, 1e-12)

    @needs_ceres
    def test_select_lens(self):
        random = np.random.RandomState(1)
        bare = cv.refract.RefractiveCamera.create(K, D)
        views = [view + random.normal(0, 0.05, view.shape) for view in make_views(bare)]
        camera = cv.refract.RefractiveCamera.create(K, np.zeros(8))
        flags, scores = cv.refract.selectLensCoefficients([make_board()]*5, [views], [], [camera], [], [], [])
        self.assertEqual((8, 4), scores.shape)
        self.assertEqual(cv.refract.GLASS_FIX_K4, flags & cv.refract.GLASS_FIX_K4)
        self.assertIn(flags, scores[:, 0])
        self.assertClose(-0.41, camera.distCoeffs()[0, 0], 0.1)

    def test_pnp(self):
        pose = np.array([0.1, -0.2, 0.3]), np.array([10., -5, 620])
        pixels = cv.refract.refractiveProjectPoints(make_board(), *pose, self.camera1)[0]
        for args in ((self.camera1,), (K, D, make_window())):
            found, rvec, tvec, error = cv.refract.refractiveSolvePnP(make_board(), pixels, *args)
            self.assertIs(True, found)
            self.assertLess(error[0, 0], 1e-6)
            self.assertClose(pose[0], rvec, 1e-6)
            self.assertClose(pose[1], tvec, 1e-4)
            count, rvecs, tvecs, errors = cv.refract.refractiveSolvePnPGeneric(make_board(), pixels, *args)
            self.assertEqual((count, count, (count, 1)), (len(rvecs), len(tvecs), errors.shape))
            self.assertClose(pose[1], tvecs[0], 1e-4)
        found, rvec, tvec, error, covariance = cv.refract.refractiveSolvePnPExtended(
            make_board(), pixels, self.camera1, False, sigma=0.1)
        self.assertEqual((True, (6, 6)), (found, covariance.shape))
        count, rvecs, tvecs = cv.refract.refractiveSolveP3P(make_board()[:4], pixels[:4], self.camera1)
        self.assertEqual((count, count), (len(rvecs), len(tvecs)))

    def test_pnp_ransac(self):
        pose = np.array([0.1, -0.2, 0.3]), np.array([10., -5, 620])
        pixels = cv.refract.refractiveProjectPoints(make_board(), *pose, self.camera1)[0]
        pixels.reshape(-1, 2)[::4] += 40
        for args in ((self.camera1,), (K, D, make_window())):
            found, rvec, tvec, inliers = cv.refract.refractiveSolvePnPRansac(make_board(), pixels, *args, reprojectionError=2.)
            self.assertIs(True, found)
            self.assertClose(pose[1], tvec, 1e-4)
            self.assertEqual(1, inliers[0, 0])

    def test_recover_pose(self):
        points = make_board() + np.array([0, 0, 600.])
        points.reshape(-1, 3)[:, 2] += 9*(np.arange(points.size//3) % 7)
        pose = np.array([0, 0.2, 0]), np.array([-180., 2, 25])
        pixels1 = cv.refract.refractiveProjectPoints(points, np.zeros(3), np.zeros(3), self.camera1)[0]
        pixels2 = cv.refract.refractiveProjectPoints(points, *pose, self.camera2)[0]
        count, R, T, mask = cv.refract.refractiveRecoverPose(pixels1, pixels2, self.camera1, self.camera2)
        self.assertEqual(count, mask.sum())
        self.assertLess(len(points.reshape(-1, 3))//2, count)
        self.assertClose(cv.Rodrigues(pose[0])[0], R, 1e-2)


if __name__ == '__main__':
    NewOpenCVTests.bootstrap()
