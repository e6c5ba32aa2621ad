# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""GlassWindow and RefractiveCamera."""
import copy
import pickle
import sys

import numpy as np
import pytest

import opencv_refract as refract
from opencv_refract._classes import WINDOW_FIELDS

K = np.array([[1000., 0, 640], [0, 1000, 480], [0, 0, 1]])


def test_a_window_is_none_by_default():
    window = refract.GlassWindow()
    assert window.normal == (0., 0., 1.) and window.distance == 0.
    assert len(window.thickness) == len(window.index) == 0
    assert window.innerIndex == window.outerIndex == 1.


def test_a_pane():
    window = refract.GlassWindow((0.3, 0., 0.4), 20., 1.5, distance=50., outerIndex=1.33)
    np.testing.assert_allclose(window.normal, (0.6, 0., 0.8))
    assert list(window.thickness) == [20.] and list(window.index) == [1.5]
    assert window.distance == 50. and window.outerIndex == 1.33
    for normal in (np.array([0.3, 0., 0.4]), np.array([[0.3], [0.], [0.4]]), np.array([0.3, 0., 0.4], np.float32)):
        np.testing.assert_allclose(refract.GlassWindow(normal, 20., 1.5).normal, (0.6, 0., 0.8))


def test_layers_are_set_as_lists_tuples_or_arrays():
    window = refract.GlassWindow()
    for layers in ([3., 0.8, 3.], (3., 0.8, 3.), np.array([3., 0.8, 3.]), np.array([3., 0., 0.8, 0., 3.])[::2]):
        window.thickness = layers
        assert list(window.thickness) == [3., 0.8, 3.]
    window.index = [1.52, 1.48, 1.52]
    window.normal = (0., 0.6, 0.8)
    window.distance, window.innerIndex, window.outerIndex = 12.5, 1., 1.33
    window.check()


@pytest.mark.parametrize("field, value", [("normal", (0., 0., 2.)), ("distance", -1.), ("thickness", [-20.]),
                                          ("index", [0.9]), ("outerIndex", 0.5), ("innerIndex", float("nan")),
                                          ("thickness", [1., 2.])])
def test_a_wrong_field_is_named(field, value):
    window = refract.GlassWindow((0., 0., 1.), 20., 1.5)
    setattr(window, field, value)
    with pytest.raises(refract.error, match=field):
        window.check()
    with pytest.raises(refract.error, match=field):
        refract.RefractiveCamera.create(K, None, window)


def test_a_dome():
    dome = refract.GlassWindow.dome((1, -2, 3.), 50, 7, 1.5, 1.33)
    assert dome.shape == refract.WINDOW_DOME and dome.center == (1., -2., 3.) and dome.radius == 50. and dome.thickness == [7]
    same = refract.GlassWindow(shape=refract.WINDOW_DOME, center=[1, -2, 3], radius=50, thickness=7, index=1.5, outerIndex=1.33)
    assert same == dome and eval(repr(dome), {"GlassWindow": refract.GlassWindow}) == dome
    assert pickle.loads(pickle.dumps(dome)) == dome and copy.deepcopy(dome) == dome
    camera = refract.RefractiveCamera.create(K, None, dome)
    assert camera.window() == dome and camera.parameterNames()[4:8] == ("center[0]", "center[1]", "center[2]", "radius")
    X = np.array([[80., -60., 700.], [0., 0., 600.]])
    pixels, status = refract.refractiveProjectPoints(X, np.zeros(3), np.zeros(3), camera)
    origins, directions, status = refract.refractiveUnprojectPoints(pixels, camera)
    offset = X - np.asarray(origins).reshape(-1, 3)
    assert np.abs(np.cross(offset, np.asarray(directions).reshape(-1, 3))).max() < 1e-9
    with pytest.raises(refract.error, match="inside the dome"):
        refract.GlassWindow.dome((0, 0, 60.), 50, 7, 1.5)
    with pytest.raises(refract.error, match="radius"):
        refract.GlassWindow((0, 0, 1), 7, 1.5, radius=50)
    truth = camera.window().center
    object_points = [np.array([[30.*x, 30.*y, 0] for y in range(-2, 3) for x in range(-3, 4)]) for _ in range(6)]
    poses = [((0.3*np.sin(i), 0.3*np.cos(i), 0.1), (5.*i - 12, 8., 550. + 40*i)) for i in range(6)]
    seen = [refract.refractiveProjectPoints(o, r, t, camera)[0] for o, (r, t) in zip(object_points, poses)]
    bare = refract.RefractiveCamera.create(K, None)
    direct = [refract.refractiveProjectPoints(o, r, t, bare)[0] for o, (r, t) in zip(object_points, poses)]
    start = refract.RefractiveCamera.create(K, None, refract.GlassWindow.dome((0, 0, 0), 50, 7, 1.5, 1.33))
    refract.calibrateGlass(object_points, direct, seen, start)
    assert np.abs(np.array(start.window().center) - truth).max() < 1e-5



def test_a_tube():
    tube = refract.GlassWindow.tube((1, -2, 3.), (0, 2, 0), 50, 7, 1.5, 1.33)
    assert tube.shape == refract.WINDOW_TUBE and tube.center == (1., 0., 3.) and tube.axis == (0., 1., 0.) and tube.radius == 50.
    same = refract.GlassWindow(shape=refract.WINDOW_TUBE, center=[1, 0, 3], axis=[0, 5, 0], radius=50, thickness=7, index=1.5,
                               outerIndex=1.33)
    assert same == tube and eval(repr(tube), {"GlassWindow": refract.GlassWindow}) == tube
    assert pickle.loads(pickle.dumps(tube)) == tube and copy.deepcopy(tube) == tube
    camera = refract.RefractiveCamera.create(K, None, tube)
    assert camera.window() == tube and camera.parameterNames()[7:11] == ("axis[0]", "axis[1]", "axis[2]", "radius")
    X = np.array([[80., -60., 700.], [0., 0., 600.]])
    pixels, status = refract.refractiveProjectPoints(X, np.zeros(3), np.zeros(3), camera)
    origins, directions, status = refract.refractiveUnprojectPoints(pixels, camera)
    offset = X - np.asarray(origins).reshape(-1, 3)
    assert np.abs(np.cross(offset, np.asarray(directions).reshape(-1, 3))).max() < 1e-9
    with pytest.raises(refract.error, match="inside the tube"):
        refract.GlassWindow.tube((60., 0, 0), (0, 1, 0), 50, 7, 1.5)
    with pytest.raises(refract.error, match="axis"):
        refract.GlassWindow((0, 0, 1), 7, 1.5, axis=(0, 1, 0))


def test_a_bent_pane():
    bent = refract.GlassWindow((0, 0, 2), 7, 1.5, 40, shape=refract.WINDOW_BENT, curvature=1e-5)
    assert bent.normal == (0., 0., 1.) and bent.curvature == 1e-5 and eval(repr(bent), {"GlassWindow": refract.GlassWindow}) == bent
    assert pickle.loads(pickle.dumps(bent)) == bent
    camera = refract.RefractiveCamera.create(K, None, bent)
    assert camera.parameterNames()[-1] == "curvature"
    with pytest.raises(refract.error, match="curvature"):
        refract.GlassWindow((0, 0, 1), 7, 1.5, curvature=1e-5)


def test_faces_that_are_not_parallel():
    window = refract.GlassWindow((0., 0., 1.), 20., 1.5, distance=50.)
    assert len(window.wedge) == 0
    for wedge in ([(1e-3, -2e-3)], ((1e-3, -2e-3),), np.array([[1e-3, -2e-3]])):
        window.wedge = wedge
        assert [tuple(pair) for pair in window.wedge] == [(1e-3, -2e-3)]
    camera = refract.RefractiveCamera.create(K, None, window)
    assert camera.parameterNames()[-2:] == ("wedge[0][0]", "wedge[0][1]")
    assert [tuple(pair) for pair in copy.deepcopy(camera).window().wedge] == [(1e-3, -2e-3)]
    assert [tuple(pair) for pair in pickle.loads(pickle.dumps(window)).wedge] == [(1e-3, -2e-3)]
    X = np.array([[80., -60., 700.], [0., 0., 600.]])
    pixels, status = refract.refractiveProjectPoints(X, np.zeros(3), np.zeros(3), camera)
    origins, directions, status = refract.refractiveUnprojectPoints(pixels, camera)
    offset = X - np.asarray(origins).reshape(-1, 3)
    np.testing.assert_allclose(np.cross(offset, np.asarray(directions).reshape(-1, 3)), 0., atol=1e-10)
    assert np.abs(np.asarray(origins).reshape(-1, 3)[:, :2]).max() > 1e-3      # off the axis
    window.wedge = [(2., 0.)]
    with pytest.raises(refract.error, match="wedge"):
        window.check()


def test_wrong_types_are_refused():
    with pytest.raises((TypeError, refract.error)):
        refract.GlassWindow("normal", 20., 1.5)
    with pytest.raises((TypeError, refract.error)):
        refract.GlassWindow((0., 0., 1.), "thick", 1.5)
    with pytest.raises((TypeError, refract.error)):
        refract.RefractiveCamera.create(K, None, "window")
    with pytest.raises(TypeError):
        refract.RefractiveCamera()
    window = refract.GlassWindow()
    with pytest.raises((TypeError, refract.error)):
        window.distance = "far"


def test_a_camera_keeps_what_it_was_given():
    window = refract.GlassWindow((0.3, 0., 0.4), 20., 1.5)
    for count in (0, 4, 5, 8, 12, 14):
        coefficients = np.linspace(-0.01, 0.01, count)
        camera = refract.RefractiveCamera.create(K, coefficients, window)
        np.testing.assert_array_equal(camera.cameraMatrix(), K)
        np.testing.assert_array_equal(np.ravel(camera.distCoeffs()) if count else [], coefficients)
        assert camera.lensModel() == "opencv"
        assert len(camera.lensParameters()) == 4 + count
        assert camera.window().normal == window.normal
    assert refract.RefractiveCamera.createFisheye(K, np.zeros(4)).lensModel() == "fisheye"
    mrcal = refract.RefractiveCamera.createMrcal("LENSMODEL_OPENCV4", np.array([1000., 1000., 640., 480., 0, 0, 0, 0]))
    assert mrcal.lensModel() == "LENSMODEL_OPENCV4"
    assert "LENSMODEL_CAHVORE_linearity=..." in refract.RefractiveCamera.lensModels()
    assert refract.RefractiveCamera.createByName("LENSMODEL_LATLON", K, None).lensModel() == "LENSMODEL_LATLON"


def test_a_camera_changes():
    camera = refract.RefractiveCamera.create(K, None)
    pixel = camera.lensParameters()
    camera.setLensParameters(pixel + 1.)
    np.testing.assert_array_equal(camera.lensParameters(), pixel + 1.)
    window = camera.window()
    window.thickness, window.index = [10.], [1.5]
    assert len(camera.window().thickness) == 0      # a copy until it is set
    camera.setWindow(window)
    assert list(camera.window().thickness) == [10.]
    camera.setImageSize((1280, 960))
    assert camera.imageSize() == (1280, 960)


def test_a_camera_is_read_from_a_file(tmp_path):
    path = tmp_path / "camera.yml"
    path.write_text("""%YAML:1.0
---
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1000., 0., 640., 0., 1000., 480., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.1, 0.01, 0., 0., 0. ]
glass_window: { normal: [ 0., 0.6, 0.8 ], distance: 5., thickness: [ 20. ], index: [ 1.5 ], inner_index: 1.,
   outer_index: 1.33 }
""")
    for name in (str(path), path):      # os.PathLike too
        camera = refract.RefractiveCamera.read(name)
        np.testing.assert_array_equal(camera.cameraMatrix(), K)
        assert camera.window().outerIndex == 1.33 and camera.window().distance == 5.
    with pytest.raises(refract.error, match="missing.yml"):
        refract.RefractiveCamera.read(str(tmp_path / "missing.yml"))


def test_a_clone_is_a_camera_of_its_own():
    camera = refract.RefractiveCamera.create(K, None, refract.GlassWindow((0.3, 0., 0.4), 20., 1.5))
    copy = camera.clone()
    copy.setWindow(refract.GlassWindow())
    copy.setLensParameters(copy.lensParameters() + 1.)
    assert list(camera.window().thickness) == [20.]
    np.testing.assert_array_equal(camera.cameraMatrix(), K)


def test_a_camera_in_a_file_of_ones_own():
    camera = refract.RefractiveCamera.create(K, np.array([-0.1, 0.01, 0, 0]), refract.GlassWindow((0.3, 0., 0.4), 20., 1.5))
    storage = refract.FileStorage(".json", refract.FILE_STORAGE_WRITE | refract.FILE_STORAGE_MEMORY)
    camera.write(storage, "left")
    storage = refract.FileStorage(storage.releaseAndGetString(), refract.FILE_STORAGE_READ | refract.FILE_STORAGE_MEMORY)
    back = refract.RefractiveCamera.read(storage.getNode("left"))
    np.testing.assert_array_equal(back.lensParameters(), camera.lensParameters())
    assert back.window().normal == camera.window().normal
    with pytest.raises(refract.error, match="node is not a map"):
        refract.RefractiveCamera.read(storage.getNode("right"))


@pytest.mark.parametrize("value", [7, -7, 2**31 - 1, 2**31, -2**40, 0.5])
def test_numbers_in_a_file_of_ones_own(value):
    """What does not fit into an int is an integer of 64 bits where OpenCV has these (4.14), else a real number."""
    storage = refract.FileStorage(".json", refract.FILE_STORAGE_WRITE | refract.FILE_STORAGE_MEMORY)
    storage.write("number", value)
    storage = refract.FileStorage(storage.releaseAndGetString(), refract.FILE_STORAGE_READ | refract.FILE_STORAGE_MEMORY)
    assert storage.getNode("number").real() == value


def test_a_saved_camera_is_read_back(tmp_path):
    window = refract.GlassWindow((0.1, 0.05, 1), 20, 1.5437, 50)
    camera = refract.RefractiveCamera.create(K, np.array([-0.1, 0.01, 0, 0]), window)
    name = str(tmp_path / "camera.yml")
    camera.save(name)
    back = refract.RefractiveCamera.read(name)
    np.testing.assert_array_equal(back.lensParameters(), camera.lensParameters())
    assert back.window().normal == window.normal
    with pytest.raises(refract.error, match="no/camera.yml cannot be written"):
        camera.save(str(tmp_path / "no" / "camera.yml"))


def test_a_rig_is_read_back(tmp_path):
    windows = [refract.GlassWindow((0.1*i, 0.05, 1), 20, 1.5437, 50) for i in range(3)]
    cameras = [refract.RefractiveCamera.create(K, np.array([-0.1, 0.01, 0, 0]), window) for window in windows]
    Rs, Ts = [np.eye(3), np.array([0., 0.1, 0.]), np.array([0., -0.1, 0.])], [np.zeros(3), np.array([-9., 0, 1]), np.ones(3)]
    name = str(tmp_path / "rig.yml")
    refract.writeRig(name, cameras, Rs, Ts)
    back, R, T = refract.readRig(name)
    assert len(back) == len(R) == len(T) == 3 and R[1].shape == (3, 3) and T[1].shape == (3, 1)
    np.testing.assert_array_equal(back[2].lensParameters(), cameras[2].lensParameters())
    np.testing.assert_array_equal(np.ravel(T[1]), Ts[1])
    count = sum(len(camera.parameterNames()) for camera in cameras) + 12
    refract.writeRig(name, cameras, R, T, [0, 0, 1], np.eye(count))
    back, R, T, window_of_camera, covariance = refract.readRigExtended(name)
    assert list(window_of_camera) == [0, 0, 1] and covariance.shape == (count, count)
    with pytest.raises(refract.error, match="missing.yml"):
        refract.readRig(str(tmp_path / "missing.yml"))


@pytest.mark.parametrize("arguments", [
    ((0, 0, 1), -20., 1.5), ((0, 0, 0), 20., 1.5), ((0, np.nan, 1), 20., 1.5), ((0, 0, -1), 20., 1.5),
    ((0, 0, 1), np.nan, 1.5), ((0, 0, 1), 20., 0.5)])
def test_a_bad_window_is_refused_and_nothing_else_happens(arguments):
    for _ in range(50):         # what is freed twice shows sooner or later
        with pytest.raises(refract.error, match="normal|thickness|index"):
            refract.GlassWindow(*arguments)


@pytest.mark.parametrize("count", [3, 5])       # the bits that a type has for its depth, in OpenCV 4 and 5
def test_map_types_of_every_cv2(count):
    K = np.array([[1000., 0, 320], [0, 1000, 240], [0, 0, 1]])
    window = refract.GlassWindow((0.1, 0, 1), 20., 1.5)
    for depth, channels, dtype in ((3, 2, np.int16), (5, 2, np.float32), (5, 1, np.float32)):
        first = refract.initRefractiveUndistortRectifyMap(K, None, window, (0, 0, 1, 600), None, K, (64, 48),
                                                          depth + ((channels - 1) << count))[0]
        assert first.dtype == dtype and first.shape == ((48, 64, 2) if channels == 2 else (48, 64))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda made: pickle.loads(pickle.dumps(made))])
def test_windows_and_cameras_are_copied_and_pickled(copied):
    window = refract.GlassWindow((0.1, 0.05, 1), 20., 1.5437, 50., 1.333)
    window.wavelength, window.materials = 550., ["air", "N-BK7", "water"]
    for made in (window, refract.GlassWindow()):
        back = copied(made)
        for name in WINDOW_FIELDS:
            assert list(np.ravel(getattr(back, name))) == list(np.ravel(getattr(made, name)))
    for camera in (refract.RefractiveCamera.create(K, np.array([-0.1, 1/3, 0, 0]), window),
                   refract.RefractiveCamera.createFisheye(K, np.array([-0.1, 1/3, 0, 0]), window)):
        camera.setImageSize((1280, 960))
        back = copied(camera)
        assert back.lensModel() == camera.lensModel() and back.imageSize() == camera.imageSize()
        np.testing.assert_array_equal(back.lensParameters(), camera.lensParameters())
        assert back.window().normal == camera.window().normal and back.window().materials == camera.window().materials


@pytest.mark.parametrize("made", [refract.GlassWindow, refract.RefractiveCamera, refract.FileStorage, refract.FileNode])
def test_no_object_is_without_contents(made):
    with pytest.raises(TypeError, match="base type"):
        type("Derived", (made,), {})
    if made is refract.RefractiveCamera:
        with pytest.raises(TypeError, match="create"):
            made.__new__(made)
    elif made is refract.FileStorage:
        assert not made.__new__(made).isOpened()
    else:
        made.__new__(made)


def test_types_are_kept_by_their_objects_alone():
    before = sys.getrefcount(refract.GlassWindow)
    windows = [refract.GlassWindow((0, 0, 1), 20., 1.5) for _ in range(100)]
    camera = refract.RefractiveCamera.create(K, None, windows[0])
    del windows
    for _ in range(100):
        camera.window()
    assert sys.getrefcount(refract.GlassWindow) <= before + 1


def test_options_are_made_of_fields():
    options = refract.GlassRigOptions(refract.GLASS_ROBUST, criteria=(3, 50, 1e-9), cameraCovariances=[np.eye(8), None])
    assert options.flags == refract.GLASS_ROBUST and options.criteria == (3, 50, 1e-9)
    assert options.cameraCovariances[0].shape == (8, 8) and options.cameraCovariances[1] is None
    assert options.targetCovariance is None and options.computeCovariance
    options.cameraCovariances, options.targetCovariance = None, np.eye(7)
    assert options.cameraCovariances == () and options.targetCovariance.shape == (7, 7)
    options.targetCovariance = None
    assert options.targetCovariance is None
    flags = refract.GlassCalibrationFlags(3)
    assert refract.GlassRigOptions().flags == 0 and refract.BundleAdjustOptions(flags=flags).flags is flags
    options.flags |= refract.GLASS_FREE_INTRINSICS
    assert options.flags == refract.GLASS_ROBUST | refract.GLASS_FREE_INTRINSICS


def test_options_own_their_arrays():
    known, weights = np.eye(7), np.ones((5, 3))
    options = refract.GlassRigOptions(targetCovariance=known, pixelCovariancesDirect=[[weights]], cameraCovariances=[np.eye(8), np.eye(8)])
    known[:], weights[:] = 0, 0
    assert options.targetCovariance[0, 0] == 1 and options.pixelCovariancesDirect[0][0].min() == 1
    options.cameraCovariances = [2*np.eye(8), None]
    assert options.cameraCovariances[0][0, 0] == 2 and options.cameraCovariances[1] is None
    with pytest.raises(refract.error):
        options.cameraCovariances = [3*np.eye(8), "none"]
    assert options.cameraCovariances[0][0, 0] == 2


def test_options_and_results_are_pickled():
    options = refract.GlassRigOptions(refract.GLASS_ROBUST, targetCovariance=np.eye(7), criteria=(3, 20, 1e-6))
    result = refract.BundleAdjustResult(rms=0.5, covariance=np.eye(3), inliers=[np.ones((4, 1), np.uint8)])
    for same in (copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))):
        again = same(options)
        assert again.flags is options.flags and again.criteria == options.criteria and again.targetCovariance.shape == (7, 7)
        again = same(result)
        assert again.rms == 0.5 and again.covariance.shape == (3, 3) and again.inliers[0].all() and again.perViewErrors.shape == (0, 0)


def test_options_that_there_are_not_are_refused():
    for made in (refract.GlassRigOptions, refract.BundleAdjustOptions):
        name = made.__name__
        for wrong in (lambda: made(1, 2), lambda: made(cameraCovariance=[]), lambda: made(flags=1.5), lambda: made(flags=None),
                      lambda: made(16), lambda: made(refract.GLASS_ROBUST, flags=refract.GLASS_ROBUST),
                      lambda: made(criteria="many"), lambda: made(cameraCovariances=7)):
            with pytest.raises(refract.error, match=name):
                wrong()
        with pytest.raises(AttributeError):
            made().cameraCovariance = []
