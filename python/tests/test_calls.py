# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Every call once, in both overloads, against what it must give by construction."""
import numpy as np
import pytest

import opencv_refract as refract

ZERO = np.zeros(3)


def test_project_and_unproject(rig):
    pixels, status = refract.refractiveProjectPoints(rig.points, ZERO, ZERO, *rig.lens1)
    assert pixels.shape == (40, 1, 2) and pixels.dtype == np.float64
    assert status.shape == (40, 1) and status.dtype == np.uint8 and not status.any()
    np.testing.assert_array_equal(pixels, rig.pixels1)

    for camera in (rig.lens1, (rig.camera1,)):
        origins, directions, status = refract.refractiveUnprojectPoints(pixels, *camera)
        to_point = rig.points - origins[:, 0]
        along = np.sum(to_point*directions[:, 0], axis=1)
        miss = np.linalg.norm(to_point - along[:, None]*directions[:, 0], axis=1)
        assert miss.max() < 1e-8 and along.min() > 0 and not status.any()


def test_project_extended_gives_the_jacobian(rig):
    rvec, tvec = np.array([0.1, -0.2, 0.05]), np.array([1., 2., 3.])
    pixels, status, jacobian = refract.refractiveProjectPointsExtended(rig.points, rvec, tvec, rig.camera1)
    # rvec, tvec; fx, fy, cx, cy and 5 coefficients; normal, distance, thickness, index, innerIndex, outerIndex
    assert jacobian.shape == (80, 6 + 9 + 8)
    step = 1e-4
    moved = [refract.refractiveProjectPoints(rig.points, rvec, tvec + (0, 0, s), rig.camera1)[0] for s in (step, -step)]
    np.testing.assert_allclose(jacobian[:, 5], (moved[0] - moved[1]).ravel()/(2*step), rtol=1e-6, atol=1e-8)


def test_undistort(rig):
    expected = rig.points[:, :2]/rig.points[:, 2:]
    for camera in (rig.lens1, (rig.camera1,)):
        corrected, status = refract.refractiveUndistortPoints(rig.pixels1, *camera, depth=rig.points[:, 2].copy())
        np.testing.assert_allclose(corrected[:, 0], expected, atol=1e-10)
        assert not status.any()
    corrected, _ = refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, depth=rig.points[:, 2].copy(), P=rig.K1)
    np.testing.assert_allclose(corrected[:, 0], expected*rig.K1[[0, 1], [0, 1]] + rig.K1[:2, 2], atol=1e-6)


@pytest.mark.parametrize("depth", [600., 600, np.float64(600), (600.,), np.array([600.]), np.array(600.),
                                   np.full(5, 600., np.float32)])
@pytest.mark.parametrize("count", [1, 4, 5])
def test_one_depth_in_every_form(rig, depth, count):
    if np.size(depth) > 1 and np.size(depth) != count:
        pytest.skip("as many depths as points")
    points = np.column_stack((rig.points[:count, :2], np.full(count, 600.)))
    pixels, _ = refract.refractiveProjectPoints(points, ZERO, ZERO, rig.camera1)
    corrected, status = refract.refractiveUndistortPoints(pixels, rig.camera1, depth=depth)
    assert not status.any()
    np.testing.assert_allclose(corrected[:, 0], points[:, :2]/600., atol=1e-10)
    back, status = refract.refractiveDistortPoints(corrected, rig.camera1, depth)
    np.testing.assert_allclose(back, pixels, atol=1e-7)


def test_no_depth_is_said_only_without_window(rig):
    with pytest.raises(refract.error, match="depth is 0 .Python: None.; give the depth of the scene"):
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, None)
    with pytest.raises(refract.error, match="depth is empty; give the depth of the scene"):
        refract.initRefractiveUndistortRectifyMap(rig.camera1, None, None, None, (64, 48), 5)
    bare = refract.RefractiveCamera.create(rig.K1, rig.D1)
    none, _ = refract.refractiveUndistortPoints(rig.pixels1, bare, None)
    some, _ = refract.refractiveUndistortPoints(rig.pixels1, bare, 700)
    np.testing.assert_array_equal(none, some)


@pytest.mark.parametrize("depth", [600., 600, np.array([600.]), np.array([0., 0., 1., 600.])])
def test_images(rig, depth):
    image = np.full((1024, 1280, 3), 99, np.uint8)
    for camera in (rig.lens1, (rig.camera1,)):
        K, roi = refract.getOptimalNewRefractiveCameraMatrix(*camera, depth, (1280, 1024), 0)
        assert K.shape == (3, 3) and tuple(roi) == (0, 0, 1280, 1024)
        corrected = refract.refractiveUndistortImage(image, *camera, depth, newCameraMatrix=K)
        assert corrected.shape == image.shape and corrected.min() == 99
        drawn = refract.drawRefractiveFrameAxes(np.zeros_like(image), *camera, np.array([0.4, -0.5, 0.1]), np.array([0., 0., 600.]),
                                                60)
        assert all(drawn[:, :, c].any() for c in range(3))


def test_epipolar_distance(rig):
    moved = rig.pixels2 - (0., 3.)
    for cameras in ((*rig.lens1, *rig.lens2), (rig.camera1, rig.camera2)):
        none, status = refract.refractiveEpipolarDistance(rig.pixels1, rig.pixels2, *cameras, rig.R, rig.T)
        assert none.shape == (40, 1) and np.abs(none).max() < 1e-6 and not status.any()
        distance, _ = refract.refractiveEpipolarDistance(rig.pixels1, moved, *cameras, rig.R, rig.T)
        assert (np.abs(distance) > 2).all() and (np.abs(distance) < 3.01).all()
    _, _, depths, jacobian = refract.refractiveEpipolarDistanceExtended(
        rig.pixels1, moved, rig.camera1, rig.camera2, rig.R, rig.T, 1, (0., np.inf))
    assert depths.shape == (40, 1) and jacobian.shape == (40, 10)
    np.testing.assert_allclose(-3*jacobian[:, 3], distance[:, 0], atol=0.02)


def test_spline_weights(rig):
    intrinsics = np.zeros(4 + 2*9*8)
    intrinsics[:4] = 600, 600, 320, 240
    camera = refract.RefractiveCamera.createMrcal("LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=9_Ny=8_fov_x_deg=110", intrinsics,
                                                  rig.window1)
    controls, weights, status = refract.refractiveSplineWeights(rig.points, ZERO, ZERO, camera)
    assert controls.shape == weights.shape == (40, 16) and controls.dtype == np.int32 and not status.any()
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)


def test_points_on_plane(rig):
    normal = np.array([0.1, -0.05, 1.])
    on_plane = rig.points.copy()
    on_plane[:, 2] = 610. - on_plane[:, :2] @ normal[:2]
    pixels, _ = refract.refractiveProjectPoints(on_plane, ZERO, ZERO, rig.camera1)
    for camera in (rig.lens1, (rig.camera1,)):
        found, status = refract.refractivePointsOnPlane(pixels, *camera, (*normal, 610.))
        np.testing.assert_allclose(found[:, 0], on_plane, atol=1e-7)
        assert not status.any()


@pytest.mark.parametrize("depth", [600., np.array([0., 0., 1., 600.])])
def test_map(rig, depth):
    size = (64, 48)
    K = np.array([[100., 0, 32], [0, 100, 24], [0, 0, 1]])
    for camera in ((rig.K1, None, rig.window1), (refract.RefractiveCamera.create(rig.K1, None, rig.window1),)):
        x, y = refract.initRefractiveUndistortRectifyMap(*camera, depth, None, K, size, 5)     # 5 = CV_32FC1
        assert x.shape == y.shape == (48, 64) and x.dtype == np.float32
        point = np.array([[(40 - 32)/100.*600., (30 - 24)/100.*600., 600.]])
        pixel, _ = refract.refractiveProjectPoints(point, ZERO, ZERO, rig.K1, None, rig.window1)
        np.testing.assert_allclose([x[30, 40], y[30, 40]], pixel.ravel(), rtol=1e-6)


def distance_to_polyline(line, point):
    start, step = line[:-1], np.diff(line, axis=0)
    t = np.clip(np.sum((point - start)*step, axis=1)/np.sum(step*step, axis=1), 0, 1)
    return np.linalg.norm(start + t[:, None]*step - point, axis=1).min()


def test_epilines(rig):
    for cameras in ((*rig.lens1, *rig.lens2), (rig.camera1, rig.camera2)):
        lines, status = refract.computeRefractiveEpilines(rig.pixels1, 1, *cameras, rig.R, rig.T, (400., np.inf))
        assert len(lines) == 40 and not status.any()
        for line, partner in zip(lines, rig.pixels2[:, 0]):
            assert distance_to_polyline(line[:, 0], partner) < 0.0105
    lines, _ = refract.computeRefractiveEpilines(rig.pixels2, 2, rig.camera1, rig.camera2, rig.R, rig.T, (300., 1500.),
                                                 tolerance=0.001)
    for line, partner in zip(lines, rig.pixels1[:, 0]):
        assert distance_to_polyline(line[:, 0], partner) < 0.00105


def test_triangulate(rig):
    for cameras in ((*rig.lens1, *rig.lens2), (rig.camera1, rig.camera2)):
        for flags in (refract.TRIANGULATE_OPTIMAL, refract.TRIANGULATE_MIDPOINT):
            points, status = refract.triangulateRefractive(*cameras, rig.R, rig.T, rig.pixels1, rig.pixels2, flags=flags)
            np.testing.assert_allclose(points[:, 0], rig.points, atol=1e-6)
            assert points.shape == (40, 1, 3) and not status.any()


def test_triangulate_extended(rig):
    points, status, covariance, errors = refract.triangulateRefractiveExtended(
        rig.camera1, rig.camera2, rig.R, rig.T, rig.pixels1, rig.pixels2, 0, 0.1, None)
    np.testing.assert_allclose(points[:, 0], rig.points, atol=1e-6)
    assert covariance.shape == (40, 9)
    sigma = np.sqrt(covariance[:, [0, 4, 8]])
    assert (sigma > 0.001).all() and (sigma < 1.).all() and not status.any()


def test_triangulate_by_any_number_of_cameras(rig):
    zero, R3, T3 = np.zeros(3), np.array([0., -0.3, 0.]), np.array([180., 0., 25.])
    cameras = [rig.camera1, rig.camera2, rig.camera1.clone()]
    pixels3 = refract.refractiveProjectPoints(rig.points, R3, T3, cameras[2])[0]
    Rs, Ts = [np.eye(3), rig.R, R3], [zero, rig.T, T3]
    images = [rig.pixels1[:, 0].copy(), rig.pixels2[:, 0].copy(), pixels3[:, 0].copy()]
    images[0][3] = images[1][4] = images[2][5] = images[0][6] = images[1][6] = np.nan
    for pixels in (images, [image.astype(np.float64)[:, None] for image in images], np.array(images)):
        for flags in (refract.TRIANGULATE_OPTIMAL, refract.TRIANGULATE_MIDPOINT):
            points, status = refract.triangulateRefractive(cameras, Rs, Ts, pixels, flags=flags)
            assert points.shape == (40, 1, 3) and status[6] == refract.REFRACT_TOO_FEW_VIEWS and np.isnan(points[6]).all()
            seen = np.arange(40) != 6
            np.testing.assert_allclose(points[seen, 0], rig.points[seen], atol=1e-6)
            assert not status[seen].any()
    points, status, covariance, errors = refract.triangulateRefractiveExtended(cameras, Rs, Ts, images, 0, 0.1, None)
    assert covariance.shape == (40, 9) and np.isnan(covariance[6]).all() and (covariance[seen, 8] > 0).all()
    with pytest.raises(refract.error, match="imagePoints has 2 elements; cameras has 3"):
        refract.triangulateRefractive(cameras, Rs, Ts, images[:2])


def test_half_pixels_are_observations(rig, board):
    """A coordinate that is NaN is not known, and the other one is; pixelCovariances says how well."""
    sheet = rig.pixels2.copy()
    sheet[..., 1] = np.nan
    cameras, Rs, Ts = [rig.camera1, rig.camera2], [np.eye(3), rig.R], [np.zeros(3), rig.T]
    points, status = refract.triangulateRefractive(cameras, Rs, Ts, [rig.pixels1, sheet])
    np.testing.assert_allclose(points[:, 0], rig.points, atol=1e-7)
    assert not status.any()
    # Of three coordinates the point is the same, whatever their variances; its covariance is not.
    worse = np.tile((1., 0., 1.), (40, 1))
    depth = []
    for factor in (1., 9.):
        found, _, covariance, _ = refract.triangulateRefractiveExtended(cameras, Rs, Ts, [rig.pixels1, sheet], 0, 0.1, None,
                                                                        pixelCovariances=[worse, factor*worse])
        np.testing.assert_allclose(found, points, atol=1e-6)
        depth.append(covariance[:, 8])
    assert (depth[1] > 2*depth[0]).all() and (depth[1] < 9*depth[0]).all()
    sheet[3] = np.nan
    points, status = refract.triangulateRefractive(cameras, Rs, Ts, [rig.pixels1, sheet])
    assert status[3] == refract.REFRACT_TOO_FEW_VIEWS and np.isnan(points[3]).all() and np.flatnonzero(status).tolist() == [3]
    with pytest.raises(refract.error, match="pixelCovariances"):
        refract.triangulateRefractiveExtended(cameras, Rs, Ts, [rig.pixels1, sheet], 0, 0.1, None, pixelCovariances=[worse, -worse])


def test_half_pixels_of_a_pose(rig, board):
    pixels = board.glass1[0].copy()
    pixels[::3, 0, 0], pixels[1::3, 0, 1] = np.nan, np.nan
    found, rvec, tvec, error = refract.refractiveSolvePnP(board.target[0], pixels, rig.camera1)
    assert found and error < 1e-6
    np.testing.assert_allclose(tvec.ravel(), board.tvecs[0], atol=1e-4)
    # One coordinate that is wrong, and said to be.
    pixels[0, 0, 1] += 30
    said = np.tile((1., 0., 1.), (30, 1))
    said[0, 2] = 1e10
    found, rvec, tvec, _, covariance = refract.refractiveSolvePnPExtended(board.target[0], pixels, rig.camera1, False, sigma=0.1,
                                                                          pixelCovariances=said)
    np.testing.assert_allclose(tvec.ravel(), board.tvecs[0], atol=1e-3)
    assert found and covariance.shape == (6, 6)
    unseen = np.full_like(pixels, np.nan)
    assert not refract.refractiveSolvePnP(board.target[0], unseen, rig.camera1)[0]


def test_half_pixels_of_a_rig(rig, board):
    """A projector behind its window is calibrated by u alone."""
    from conftest import rotation
    start = refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.)
    halves = [pixels.copy() for pixels in board.glass2]
    for pixels in halves:
        pixels[..., 1] = np.nan
    cameras = [refract.RefractiveCamera.create(K, D, start) for K, D in ((rig.K1, rig.D1), (rig.K2, rig.D2))]
    weights = [[np.tile((1., 0., 1.), (30, 1))]*8, [np.tile((4., 0., 4.), (30, 1))]*8]
    options = refract.GlassRigOptions(pixelCovariancesDirect=weights, pixelCovariancesRefracted=weights)
    result = refract.calibrateGlassRigExtended(
        board.target, [board.direct1, board.direct2], [board.glass1, halves], cameras, [0, 1],
        [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], (), (), options)[0]
    assert result.rms < 1e-5
    for camera, window in zip(cameras, (rig.window1, rig.window2)):
        np.testing.assert_allclose(camera.window().normal, window.normal, atol=1e-5)


def test_half_pixels_of_a_bundle(rig):
    """A camera and a projector that sees u, of one scene in four poses."""
    from conftest import rotation
    rvecs = [np.array((0.05*i, -0.08*i, 0.03)) for i in (1, 2, 3, 4)]
    tvecs = [np.array((0., 0., 600.)) - rotation(rvec) @ (0., 0., 600.) for rvec in rvecs]
    images1, images2 = [], []
    for rvec, tvec in zip(rvecs, tvecs):
        scene = rig.points @ rotation(rvec).T + tvec
        images1.append(refract.refractiveProjectPoints(scene, np.zeros(3), np.zeros(3), rig.camera1)[0])
        images2.append(refract.refractiveProjectPoints(scene, rig.R, rig.T, rig.camera2)[0])
        images2[-1][..., 1] = np.nan
    cameras = [rig.camera1.clone(), rig.camera2.clone()]
    weights = [[np.tile((1., 0., 1.), (40, 1))]*4, [np.tile((2., 0., 2.), (40, 1))]*4]
    options = refract.BundleAdjustOptions(refract.GLASS_FIX_NORMAL, pixelCovariances=weights)
    result, _, _, found_rvecs, found_tvecs, points = refract.refractiveBundleAdjustExtended(
        [images1, images2], cameras, [0, 1], [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], rvecs, tvecs, rig.points + 0.3, None,
        options)
    assert result.rms < 1e-4
    assert [covariance.shape for covariance in result.viewCovariances] == [(6, 6)]*4
    moved = points.reshape(-1, 3)
    for rvec, tvec, pixels in zip(found_rvecs, found_tvecs, images1):      # the scene's frame is free: where camera 1 sees it
        seen = refract.refractiveProjectPoints(moved, rvec, tvec, rig.camera1)[0]
        np.testing.assert_allclose(seen, pixels, atol=1e-3)
    def lengths(points):
        return np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(lengths(moved), lengths(rig.points), atol=1e-2)


def test_calibrate_normal(rig, board):
    for camera in ((rig.K1, rig.D1), (rig.camera1,)):
        rms, normal, center, covariance = refract.calibrateGlassNormal(board.direct1, board.glass1, *camera)
        assert rms < 1e-6 and normal.shape == (3, 1) and covariance.shape == (3, 3)
        np.testing.assert_allclose(normal.ravel(), rig.window1.normal, atol=1e-9)
        expected = rig.K1[:2, 2] + rig.K1[[0, 1], [0, 1]]*normal.ravel()[:2]/normal[2]
        np.testing.assert_allclose(center.ravel(), expected, rtol=1e-12)


def test_calibrate_glass(rig, board):
    start = refract.GlassWindow((0., 0., 1.), 21., 1.5437, 50.)
    flags = refract.GLASS_FREE_THICKNESS
    rms, window, rvecs, tvecs = refract.calibrateGlass(board.target, board.direct1, board.glass1, rig.K1, rig.D1, start,
                                                       flags=flags)
    assert rms < 1e-5 and start.thickness[0] == 21.
    np.testing.assert_allclose(window.normal, rig.window1.normal, atol=1e-7)
    np.testing.assert_allclose(window.thickness, [20.], atol=1e-5)
    np.testing.assert_allclose(np.squeeze(rvecs), board.rvecs, atol=1e-7)
    np.testing.assert_allclose(np.squeeze(tvecs), board.tvecs, atol=1e-4)

    camera = refract.RefractiveCamera.create(rig.K1, rig.D1, start)
    rms, rvecs, tvecs = refract.calibrateGlass(board.target, board.direct1, board.glass1, camera, flags=flags)
    np.testing.assert_allclose(camera.window().normal, rig.window1.normal, atol=1e-7)


def test_calibrate_glass_extended(rig, board):
    start = refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.)
    rms, window, rvecs, tvecs, deviations, covariance, per_view, jacobian = refract.calibrateGlassExtended(
        board.target, board.direct1, board.glass1, rig.K1, rig.D1, start)
    parameters = 9 + 8
    assert deviations.shape == (parameters, 1) and covariance.shape == (parameters, parameters)
    assert per_view.shape == (8, 2) and jacobian.shape == (2*2*8*30, parameters + 6*8)
    camera = refract.RefractiveCamera.create(rig.K1, rig.D1, start)
    result = refract.calibrateGlassExtended(board.target, board.direct1, board.glass1, camera)
    np.testing.assert_allclose(result[-1], jacobian, rtol=1e-6, atol=1e-6)


def test_calibrate_stereo(rig, board):
    windows = [refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.) for _ in range(2)]
    camera1 = refract.RefractiveCamera.create(rig.K1, rig.D1, windows[0])
    camera2 = refract.RefractiveCamera.create(rig.K2, rig.D2, windows[1])
    from conftest import rotation
    result, R, T, rvecs, tvecs = refract.stereoCalibrateGlass(
        board.target, board.direct1, board.glass1, board.direct2, board.glass2, camera1, camera2,
        rotation(rig.R), rig.T.reshape(3, 1))
    assert result.rms < 1e-5 and result.perViewErrors.shape == (8, 4) and result.covariance.shape == (2*17 + 6, 2*17 + 6)
    assert result.degreesOfFreedom == 4*2*8*30 - 8*6 - 2*2 and 0 < result.pixelStd < 1e-5
    np.testing.assert_allclose(camera1.window().normal, rig.window1.normal, atol=1e-7)
    np.testing.assert_allclose(camera2.window().normal, rig.window2.normal, atol=1e-7)


def test_calibrate_rig(rig, board):
    from conftest import rotation
    start = refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.)
    def call(flags=0, rvecs=(), tvecs=(), **fields):
        cameras = [refract.RefractiveCamera.create(K, D, start) for K, D in ((rig.K1, rig.D1), (rig.K2, rig.D2))]
        result = refract.calibrateGlassRigExtended(
            board.target, [board.direct1, board.direct2], [board.glass1, board.glass2], cameras, [0, 1],
            [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], rvecs, tvecs, refract.GlassRigOptions(flags, **fields))
        for camera, window in zip(cameras, (rig.window1, rig.window2)):
            np.testing.assert_allclose(camera.window().normal, window.normal, atol=1e-6)
        return result

    result, Rs, Ts, rvecs, tvecs = call()
    assert result.rms < 1e-5 and result.perViewErrors.shape == (8, 4) and result.covariance.shape == (2*17 + 6, 2*17 + 6)
    assert result.stdDeviations.shape == (2*17 + 6, 1) and result.otherMinima.shape == (2, 5) and np.isnan(result.otherMinima).all()
    assert result.imageStatus.shape == (8, 4) and not result.imageStatus.any()
    assert len(result.inliers) == 32 and all(mask.all() for mask in result.inliers)
    assert np.isnan(result.targetErrors).all()
    assert call(computeCovariance=False)[0].covariance.shape == (0, 0)
    np.testing.assert_allclose(np.squeeze(tvecs), board.tvecs, atol=1e-4)
    np.testing.assert_allclose(np.squeeze(call(refract.GLASS_FREE_EXTRINSICS)[2][1]), rig.T, atol=1e-4)

    cameras = [refract.RefractiveCamera.create(K, D, start) for K, D in ((rig.K1, rig.D1), (rig.K2, rig.D2))]
    moved = refract.calibrateGlassRigExtended(
        board.target, [board.direct1, board.direct2], [board.glass1, board.glass2], cameras, [0, 1],
        [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], [], [],
        refract.GlassRigOptions(targetCovariance=np.diag([1e-3] + 3*[1e-3] + 3*[1.])**2))[0]
    assert moved.covariance.shape == (2*17 + 6 + 7, 2*17 + 6 + 7)
    assert moved.targetErrors.shape == (7, 1) and np.abs(moved.targetErrors).max() < 1e-3

    known = dict(rvecs=board.rvecs, tvecs=board.tvecs, flags=refract.GLASS_USE_POSES)
    np.testing.assert_array_equal(np.squeeze(call(**known)[4]), board.tvecs)
    call(**known, poseCovariances=[1e-6*np.eye(6)]*8)

    wrong, _ = np.divmod(np.arange(60.).reshape(30, 1, 2), 7)
    glass1, board.glass1 = board.glass1, [board.glass1[0] + wrong*(np.arange(30) % 4 == 0)[:, None, None],
                                          *board.glass1[1:]]
    result = call(refract.GLASS_ROBUST)[0]
    board.glass1 = glass1
    np.testing.assert_array_equal(np.flatnonzero(result.inliers[1] == 0), np.arange(4, 30, 4))


def test_calibrate_rig_in_short(rig, board):
    from conftest import rotation
    start = refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.)
    cameras = [refract.RefractiveCamera.create(K, D, start) for K, D in ((rig.K1, rig.D1), (rig.K2, rig.D2))]
    rms, Rs, Ts, rvecs, tvecs = refract.calibrateGlassRig(
        board.target, [board.direct1, board.direct2], [board.glass1, board.glass2], cameras, [],
        [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], flags=refract.GLASS_FREE_EXTRINSICS)
    assert rms < 1e-5
    np.testing.assert_allclose(np.squeeze(Ts[1]), rig.T, atol=1e-4)
    np.testing.assert_allclose(np.squeeze(tvecs), board.tvecs, atol=1e-4)


def test_bundle_adjust(rig):
    from conftest import rotation
    start = rig.points + np.random.default_rng(1).normal(0, 1, rig.points.shape)
    length = np.linalg.norm(rig.points[0] - rig.points[1])
    rms, Rs, Ts, points = refract.refractiveBundleAdjust(
        [rig.pixels1, rig.pixels2], [rig.camera1, rig.camera2], [], [np.eye(3), rotation(rig.R)], [np.zeros(3), rig.T], start,
        np.array([[0., 1., length, 0.01]]), flags=refract.GLASS_FIX_NORMAL)
    assert rms < 1e-5
    np.testing.assert_allclose(np.squeeze(points), np.squeeze(rig.points), atol=1e-3)


def test_swapped_pairs_are_refused(rig, board):
    start = refract.GlassWindow((0., 0., 1.), 20., 1.5437, 50.)
    with pytest.raises(refract.error, match="swapped") as caught:
        refract.calibrateGlass(board.target, board.glass1, board.direct1, rig.K1, rig.D1, start)
    assert caught.value.cause == "PAIRS_SWAPPED" and caught.value.reason in caught.value.err
    assert caught.value.view == caught.value.camera == caught.value.point == -1
    with pytest.raises(refract.error) as caught:
        refract.calibrateGlass(board.target, board.glass1, board.direct1, rig.K1, rig.D1, "window")
    assert not hasattr(caught.value, "cause")


def test_four_points_take_a_number_but_no_guess(rig):
    pixels = rig.pixels1[:4]
    number, _ = refract.refractiveUndistortPoints(pixels, rig.camera1, 600.)
    each, _ = refract.refractiveUndistortPoints(pixels, rig.camera1, np.full(4, 600.))
    np.testing.assert_array_equal(number, each)
    for depth in (np.array([600., 0, 0, 0]), (600., 0., 0., 0.)):      # a number as cv::Scalar, or a depth each
        with pytest.raises(refract.error, match="four points"):
            refract.refractiveUndistortPoints(pixels, rig.camera1, depth)


def test_both_poses_of_a_board(rig, board):
    for camera in (rig.lens1, (rig.camera1,)):
        count, rvecs, tvecs, errors = refract.refractiveSolvePnPGeneric(board.target[0], board.glass1[0], *camera)
        assert count == len(rvecs) == len(tvecs) == len(errors) and 1 <= count <= 2
        np.testing.assert_allclose(tvecs[0].ravel(), board.tvecs[0], atol=1e-5)
    unseen = np.full_like(board.glass1[0], np.nan)
    assert refract.refractiveSolvePnPGeneric(board.target[0], unseen, rig.camera1)[0] == 0
    found, rvec, _, _ = refract.refractiveSolvePnP(board.target[0], unseen, rig.camera1, None, None)
    assert found is False and rvec.size == 0


def test_epipolar_distances(rig):
    from conftest import rotation
    off = rig.pixels2.copy()
    off.reshape(-1, 2)[::2] += (0, 5)
    for cameras in (rig.lens1 + rig.lens2, (rig.camera1, rig.camera2)):
        distances, status = refract.refractiveEpipolarDistance(rig.pixels1, off, *cameras, rig.R, rig.T)
        assert distances.shape == (40, 1) and not status.any()
        assert np.abs(distances[1::2]).max() < 1e-8 and np.abs(distances[::2]).min() > 3
    distances, status, depths, jacobian = refract.refractiveEpipolarDistanceExtended(
        rig.pixels1, rig.pixels2, rig.camera1, rig.camera2, rig.R, rig.T, 2, (300., 1500.))
    assert jacobian.shape == (40, 10) and np.abs(distances).max() < 1e-8
    x2 = rotation(rig.R) @ rig.points.T + rig.T[:, None]
    np.testing.assert_allclose(depths.ravel(), x2[2], atol=1e-3)


def test_relative_pose_among_wrong_matches(rig):
    from conftest import rotation
    off = rig.pixels2.copy()
    off.reshape(-1, 2)[::4] += (50, 70)
    for cameras in (rig.lens1 + rig.lens2, (rig.camera1, rig.camera2)):
        count, R, T, mask = refract.refractiveRecoverPose(rig.pixels1, off, *cameras)
        assert 30 <= count == mask.sum() <= 31
        np.testing.assert_allclose(R, rotation(rig.R), atol=1e-3)
        np.testing.assert_allclose(T.ravel()/np.linalg.norm(T), rig.T/np.linalg.norm(rig.T), atol=1e-3)
    count, R, T, mask, covariance, interval = refract.refractiveRecoverPoseExtended(
        rig.pixels1, off, rig.camera1, rig.camera2, 0.999, 1.)
    assert covariance.shape == (6, 6) and interval[0] <= np.linalg.norm(T)*(1 + 1e-9)   # perfect matches: rounding
    inexact = [np.diag(np.full(len(camera.parameterNames()), 1e-6)) for camera in (rig.camera1, rig.camera2)]
    wider = refract.refractiveRecoverPoseExtended(rig.pixels1, off, rig.camera1, rig.camera2, 0.999, 1.,
                                                  cameraCovariances=inexact)[4]
    assert (np.diag(wider) > np.diag(covariance)).all()
    unseen = np.full_like(off, np.nan)
    assert refract.refractiveRecoverPose(rig.pixels1, unseen, rig.camera1, rig.camera2)[0] == 0


def test_pose_among_wrong_matches(rig, board):
    pixels = board.glass1[0].copy()
    wrong = np.arange(0, len(pixels), 4)
    pixels.reshape(-1, 2)[wrong] += 40
    for camera in (rig.lens1, (rig.camera1,)):
        found, rvec, tvec, inliers = refract.refractiveSolvePnPRansac(board.target[0], pixels, *camera, iterationsCount=300,
                                                                      reprojectionError=2.)
        assert found is True and inliers.dtype == np.int32
        np.testing.assert_array_equal(inliers.ravel(), np.setdiff1d(np.arange(len(pixels)), wrong))
        np.testing.assert_allclose(tvec.ravel(), board.tvecs[0], atol=1e-4)
    found, rvec, tvec, inliers, covariance = refract.refractiveSolvePnPRansacExtended(
        board.target[0], pixels, rig.camera1, False, 300, 2., 0.999, sigma=0.1)
    assert covariance.shape == (6, 6) and covariance[5, 5] > 0
    unseen = np.full_like(pixels, np.nan)
    found, rvec, _, _ = refract.refractiveSolvePnPRansac(board.target[0], unseen, rig.camera1)
    assert found is False and rvec.size == 0


def test_pose(rig, board):
    for camera in (rig.lens1, (rig.camera1,)):
        found, rvec, tvec, error = refract.refractiveSolvePnP(board.target[0], board.glass1[0], *camera)
        assert found is True and error.shape == (1, 1) and error < 1e-6
        np.testing.assert_allclose(rvec.ravel(), board.rvecs[0], atol=1e-8)
        np.testing.assert_allclose(tvec.ravel(), board.tvecs[0], atol=1e-5)
    _, rvec, tvec, _ = refract.refractiveSolvePnP(board.target[0], board.glass1[0], rig.camera1, board.rvecs[0] + 0.01,
                                                  board.tvecs[0] + 1., useExtrinsicGuess=True)
    np.testing.assert_allclose(rvec.ravel(), board.rvecs[0], atol=1e-8)


def test_refractive_index_by_name():
    assert refract.refractiveIndex("N-BK7", 587.5618) == pytest.approx(1.51680, abs=1e-5)      # the data sheet's nd
    assert refract.refractiveIndex("water:T=20", wavelengthNm=550.) == refract.refractiveIndex("water")
    assert refract.refractiveIndexTolerance("soda-lime") > refract.refractiveIndexTolerance("N-BK7") > 0
    with pytest.raises(refract.error, match="nearest is 'N-BK7'"):
        refract.refractiveIndex("N-BK8")
    with pytest.raises(refract.error, match="wavelengthNm is 100"):
        refract.refractiveIndex("N-BK7", 100.)


def test_window_in_another_colour():
    window = refract.GlassWindow((0., 0., 1.), 10., 1.5, 40.)
    with pytest.raises(refract.error, match="window.materials is empty"):
        window.atWavelength(465.)
    window.materials = ["air", "N-BK7", "water:T=12"]
    green = window.atWavelength(540.)       # of no wavelength yet: the catalogue's
    assert green.wavelength == 540. and list(green.materials) == list(window.materials)
    assert green.outerIndex == refract.refractiveIndex("water:T=12", 540.)
    assert green.atWavelength(465.).outerIndex == pytest.approx(refract.refractiveIndex("water:T=12", 465.), rel=1e-15)


def test_lens_of_mrcal():
    controls = np.zeros(2*12*10)
    camera = refract.RefractiveCamera.createMrcal("LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=12_Ny=10_fov_x_deg=90",
                                                  np.concatenate(([1000., 1000., 639.5, 479.5], controls)))
    pixels, status = refract.refractiveProjectPoints(np.array([[100., 50., 600.], [0., 0., -1.]]), ZERO, ZERO, camera)
    angle = np.arctan2(np.hypot(100., 50.), 600.)
    expected = 2000.*np.tan(angle/2)*np.array([100., 50.])/np.hypot(100., 50.) + (639.5, 479.5)
    np.testing.assert_allclose(pixels[0, 0], expected, atol=1e-10)
    assert status.ravel().tolist()[0] == 0 and np.isnan(pixels[1]).all() and status[1] != 0
    assert camera.lensParameters().size == 4 and camera.distCoeffs().size == controls.size
