# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What a Python user may write, and what a call must not take for something else."""
import inspect
import multiprocessing
import pydoc
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import opencv_refract as refract
from conftest import rotation

ZERO = np.zeros(3)


# ---- a number is no output

def wrong_calls(rig, board):
    """Each was taken in silence by the generated bindings, which wrote the result into the number, as it were."""
    cameras, Rs, Ts = [rig.camera1, rig.camera2], [np.eye(3), rotation(rig.R)], [ZERO, rig.T]
    points, pixels, target, glass = rig.points, rig.pixels1, board.target[0], board.glass1[0]
    lengths = np.array([[0., 1., np.linalg.norm(points[0] - points[1]), 0.01]])
    return {
        "flags as options": lambda: refract.refractiveBundleAdjustExtended(
            [[rig.pixels1], [rig.pixels2]], cameras, [], Rs, Ts, [], [], points, lengths, refract.GLASS_FREE_EXTRINSICS),
        "options of rigs": lambda: refract.refractiveBundleAdjustExtended(
            [[rig.pixels1], [rig.pixels2]], cameras, [], Rs, Ts, [], [], points, lengths, refract.GlassRigOptions()),
        "flags as points3D": lambda: refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, rig.pixels1, rig.pixels2,
                                                                   refract.TRIANGULATE_MIDPOINT),
        "flags as points3D of many cameras": lambda: refract.triangulateRefractive(cameras, Rs, Ts, [rig.pixels1, rig.pixels2],
                                                                                   refract.TRIANGULATE_MIDPOINT),
        "useExtrinsicGuess as rvec": lambda: refract.refractiveSolvePnP(target, glass, rig.camera1, True),
        "iterations as rvec": lambda: refract.refractiveSolvePnPRansac(target, glass, rig.camera1, 300),
        "flags as rvecs": lambda: refract.calibrateGlass(board.target, board.direct1, board.glass1, rig.K1, rig.D1, rig.window1,
                                                         refract.GLASS_FREE_THICKNESS),
        "probability as R": lambda: refract.refractiveRecoverPose(rig.pixels1, rig.pixels2, rig.camera1, rig.camera2, 0.99),
        "whichImage as distances": lambda: refract.refractiveEpipolarDistance(rig.pixels1, rig.pixels2, rig.camera1, rig.camera2,
                                                                              rig.R, rig.T, 2),
        "P as dst": lambda: refract.refractiveUndistortPoints(pixels, rig.camera1, 600., 5),
        "plane's flags": lambda: refract.refractivePointsOnPlane(pixels, rig.camera1, (0, 0, 1, 600), 1),
        "tolerance as lines": lambda: refract.computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, (400, 900),
                                                                        0.1),
        "imagePoints": lambda: refract.refractiveProjectPoints(points, ZERO, ZERO, rig.camera1, False),
    }


def test_a_number_is_no_output(rig, board):
    accepted = []
    calls = wrong_calls(rig, board)
    for what, call in calls.items():
        try:
            call()
            accepted.append(what)
        except refract.error as error:
            assert " is " in str(error) and "must be" in str(error), what
    print(f"[numbers] wrong calls that are accepted in silence: {len(accepted)} of {len(calls)}")
    assert not accepted
    with pytest.raises(refract.error, match="points3D is .*; it must be an array.*Give flags by its name: flags="):
        calls["flags as points3D"]()
    with pytest.raises(refract.error, match="Give useExtrinsicGuess by its name"):
        calls["useExtrinsicGuess as rvec"]()


def test_flags_stand_where_cpp_has_them(rig):
    args = rig.camera1, rig.camera2, rig.R, rig.T, rig.pixels1, rig.pixels2 + 0.3
    named, _ = refract.triangulateRefractive(*args, flags=refract.TRIANGULATE_MIDPOINT)
    placed, _ = refract.triangulateRefractive(*args, None, None, refract.TRIANGULATE_MIDPOINT)
    best, _ = refract.triangulateRefractive(*args)
    np.testing.assert_array_equal(named, placed)
    assert np.abs(named - best).max() > 1e-6


# ---- any scalar is a depth

@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("depth", [700, 700., np.float32(700), np.float64(700), np.int64(700), np.uint8(250), np.array(700), [700],
                                   (700,), np.array([700])], ids=lambda depth: type(depth).__name__ + str(np.shape(depth)))
def test_any_scalar_is_a_depth(rig, depth, count):
    corners = rig.pixels1[:count]
    expected, _ = refract.refractiveUndistortPoints(corners, rig.camera1, float(np.ravel(depth)[0]))
    for call in (lambda d: refract.refractiveUndistortPoints(corners, rig.camera1, d),
                 lambda d: refract.refractiveUndistortPoints(corners, rig.camera1, depth=d),
                 lambda d: refract.refractiveUndistortPoints(corners, *rig.lens1, d)):
        np.testing.assert_array_equal(call(depth)[0], expected)
    K, _ = refract.getOptimalNewRefractiveCameraMatrix(rig.camera1, depth, (1280, 1024), 0)
    assert K.shape == (3, 3)


def test_a_number_for_the_depth_of_maps_and_points(rig):
    size = (64, 48)
    R1, R2, P1, P2 = refract.refractiveStereoRectify(rig.camera1, rig.camera2, rig.R, rig.T, (1280, 1024), (400, 900),
                                                     newImageSize=size)[1:5]
    disparity = np.full(size[::-1], 3, np.float32)
    args = disparity, rig.camera1, rig.camera2, rig.R, rig.T, R1, R2, P1, P2
    expected, _ = refract.refractiveReprojectImageTo3D(*args, np.full(size[::-1], 600.), np.full(size[::-1], 600.))
    both = np.isfinite(expected).all(axis=2)        # beyond the border of a map of depths there is none
    assert both.any()
    for depth in (600, 600., np.float32(600), np.array([600.])):
        found, _ = refract.refractiveReprojectImageTo3D(*args, depth, depth)
        np.testing.assert_allclose(found[both], expected[both], rtol=1e-4)
        refract.refractiveReprojectImageTo3DExtended(*args, depth, depth, False, -1, np.float32(0.3), None)


@pytest.mark.parametrize("depth", [True, "700", np.array(["700"]), object()])
def test_what_is_no_depth(rig, depth):
    with pytest.raises(refract.error, match="depth"):
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, depth)


# ---- no argument changes

LAYOUTS = {
    "as it is": lambda a: a.copy(),
    "transposed": lambda a: np.ascontiguousarray(a.T).T,
    "a column": lambda a: np.column_stack((a.ravel(), a.ravel()))[:, 1].reshape(a.shape),
    "float32": lambda a: a.astype(np.float32),
}


def read_only(a):
    a = a.copy()
    a.flags.writeable = False
    return a


@pytest.mark.parametrize("layout", [*LAYOUTS.values(), read_only], ids=[*LAYOUTS, "read-only"])
def test_no_argument_changes(rig, board, layout):
    tolerance = 1e-5 if layout(np.eye(3)).dtype == np.float32 else 1e-9
    R, T = layout(rotation(rig.R)), layout(rig.T + (1., 0, 0))
    Rs, Ts = (np.eye(3), R), (ZERO.copy(), T)
    scene = layout(rig.points + np.random.default_rng(5).normal(0, 0.5, rig.points.shape))
    rvec, tvec = layout(board.rvecs[0] + 0.01), layout(board.tvecs[0] + 1)
    inputs = [*Rs, *Ts, scene, rvec, tvec]
    before = [a.copy() for a in inputs]
    direct, glass = [board.direct1, board.direct2], [board.glass1, board.glass2]
    cameras = [rig.camera1.clone(), rig.camera2.clone()]
    lengths = np.array([[0., 1., np.linalg.norm(rig.points[0] - rig.points[1]), 0.01]])
    flags = refract.GLASS_FREE_EXTRINSICS
    options = refract.GlassRigOptions(flags)

    found = [refract.stereoCalibrateGlass(board.target, direct[0], glass[0], direct[1], glass[1], *cameras, R, T, options=options)[2],
             refract.calibrateGlassRig(board.target, direct, glass, cameras, [], Rs, Ts, flags=flags)[2][1],
             refract.calibrateGlassRigExtended(board.target, direct, glass, cameras, [], Rs, Ts, [], [], options)[2][1]]
    for moved in found:
        np.testing.assert_allclose(np.ravel(moved), rig.T, atol=1e-3)
    fixed = refract.refractiveBundleAdjust([rig.pixels1, rig.pixels2], cameras, [], Rs, (ZERO, rig.T), scene, lengths,
                                           flags=refract.GLASS_FIX_NORMAL)
    assert np.abs(np.squeeze(fixed[3]) - rig.points).max() < 0.1
    pose = refract.refractiveSolvePnP(board.target[0], glass[0][0], rig.camera1, rvec, tvec, True)
    np.testing.assert_allclose(pose[1].ravel(), board.rvecs[0], atol=max(tolerance, 1e-7))
    ransac = refract.refractiveSolvePnPRansac(board.target[0], glass[0][0], rig.camera1, rvec, tvec, useExtrinsicGuess=True)
    np.testing.assert_allclose(ransac[2].ravel(), board.tvecs[0], atol=1e-3)
    for after, kept in zip(inputs, before):
        np.testing.assert_array_equal(after, kept)


def test_a_rig_that_was_read_does_not_move(rig, tmp_path, board):
    name = tmp_path / "rig.yml"
    refract.writeRig(name, [rig.camera1, rig.camera2], [np.eye(3), rig.R], [ZERO, rig.T + 1])
    cameras, Rs, Ts = refract.readRig(name)
    kept = Ts[1].copy()
    refract.calibrateGlassRig(board.target, [board.direct1, board.direct2], [board.glass1, board.glass2], cameras, [], Rs, Ts,
                              flags=refract.GLASS_FREE_EXTRINSICS)
    np.testing.assert_array_equal(Ts[1], kept)


# ---- every view, integers where numbers are meant, lists for vectors

def test_every_view_is_taken_where_it_is_read(rig, board):
    R21 = rotation(rig.R).T
    T = np.hstack((np.eye(3), rig.T[:, None]))[:, 3]
    expected, _ = refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, rig.pixels1, rig.pixels2)
    found, _ = refract.triangulateRefractive(rig.camera1, rig.camera2, R21.T, T, rig.pixels1, rig.pixels2)
    np.testing.assert_allclose(found, expected, atol=1e-9)
    result = refract.stereoCalibrateGlass(board.target, board.direct1, board.glass1, board.direct2, board.glass2, rig.camera1.clone(),
                                          rig.camera2.clone(), read_only(R21).T, T)
    assert result[0].rms < 1e-5


def test_integers_and_lists(rig):
    expected = refract.GlassWindow((0., 0., 1.), 20., 1.5)
    for normal in ((0, 0, 1), [0, 0, 1], [0, 0, 1.], np.array([0, 0, 1]), np.array([[0], [0], [1]], np.int16), np.array([0, 0, 1.])):
        assert refract.GlassWindow(normal, 20, 1.5) == expected
    K = [np.array([[2000, 0, 640], [0, 2000, 512], [0, 0, 1]], dtype) for dtype in (np.int64, np.int32, np.uint16, np.float64)]
    camera = refract.RefractiveCamera.create(K[-1], None, expected)
    for integers in K:
        assert refract.RefractiveCamera.create(integers, [0, 0, 0, 0], expected) == refract.RefractiveCamera.create(
            K[-1], np.zeros(4), expected)
    for t in ([1, 2, 3], (1, 2, 3), np.array([1, 2, 3]), [1, np.float32(2), np.int8(3)]):
        found, _ = refract.refractiveProjectPoints(rig.points, [0, 0, 0], t, camera)
        np.testing.assert_array_equal(found, refract.refractiveProjectPoints(rig.points, ZERO, np.array([1., 2, 3]), camera)[0])
    for plane in ([0, 0, 1, 600], np.array([0, 0, 1, 600]), np.array([[0, 0, 1, 600]])):
        found, _ = refract.refractivePointsOnPlane(rig.pixels1, camera, plane)
        np.testing.assert_allclose(found[:, 0, 2], 600)
    for size in ([64, 48], np.array([64, 48]), (np.int64(64), np.int32(48)), np.zeros((48, 64)).shape[::-1]):
        assert refract.initRefractiveUndistortRectifyMap(camera, 600, None, K[0], size, 5)[0].shape == (48, 64)
        camera.setImageSize(size)
        assert camera.imageSize() == (64, 48)
    for cameras in ([camera, camera], (camera, camera)):
        with pytest.raises(refract.error, match="windowOfCamera"):
            refract.writeRig("no/rig.yml", cameras, [np.eye(3, dtype=int)]*2, [[0, 0, 0], [1, 0, 0]], [0.5, 1])


def test_a_laminate_in_one_line():
    window = refract.GlassWindow([0, 0, 1.], [4, .76, 4], [1.52, 1.49, 1.52])
    assert window.thickness == [4, .76, 4] and window.index == [1.52, 1.49, 1.52] and window.normal == [0, 0, 1]
    same = refract.GlassWindow()
    same.normal, same.thickness, same.index = (0, 0, 1), np.array([4, .76, 4]), (1.52, 1.49, 1.52)
    assert same == window
    full = refract.GlassWindow((0, 0, 1), 10, 1.5, 40, 1.33, innerIndex=1.01, wedge=[(1e-3, 0)], wavelength=550.,
                               materials=["air", "N-BK7", "water"])
    assert full.innerIndex == 1.01 and full.wedge == [(1e-3, 0)] and full.materials == ["air", "N-BK7", "water"]
    assert eval(repr(full), {"GlassWindow": refract.GlassWindow}) == full
    for wrong in (dict(thickness=[4, 4], index=[1.5]), dict(thickness=4, index="glass"), dict(thickness=4), dict(index=1.5)):
        with pytest.raises(refract.error, match="thickness|index"):
            refract.GlassWindow((0, 0, 1), **wrong)


# ---- empty is an empty array

def test_empty_is_an_empty_array(rig, board):
    none = np.zeros((0, 2))
    for points in (none, none.astype(np.float32), np.zeros((0, 1, 2)), None):
        ideal, status = refract.refractiveUndistortPoints(points, rig.camera1, 600)
        assert ideal.shape == (0, 1, 2) and status.shape == (0, 1) and status.dtype == np.uint8
    for points, origins in [(none, refract.refractiveUnprojectPoints(none, rig.camera1)[0]),
                            (none, refract.refractivePointsOnPlane(none, rig.camera1, (0, 0, 1, 600))[0]),
                            (none, refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, none, none)[0])]:
        assert origins.shape == (0, 1, 3) and origins.reshape(-1, 3).shape == (0, 3)
    assert refract.refractiveProjectPoints(np.zeros((0, 3)), ZERO, ZERO, rig.camera1)[0].reshape(-1, 2).shape == (0, 2)
    lines, status = refract.computeRefractiveEpilines(np.array([[np.nan, 1]]), 1, rig.camera1, rig.camera2, rig.R, rig.T, (400, 900))
    assert lines[0].shape == (0, 1, 2) and status[0] == refract.REFRACT_NOT_FINITE
    assert refract.RefractiveCamera.create(rig.K1, None).distCoeffs().shape == (0, 1)
    unseen = np.full_like(board.glass1[0], np.nan)
    found, rvec, tvec, error = refract.refractiveSolvePnP(board.target[0], unseen, rig.camera1)
    assert found is False and rvec.size == tvec.size == error.size == 0
    found, rvec, tvec, inliers = refract.refractiveSolvePnPRansac(board.target[0], unseen, rig.camera1)
    assert found is False and rvec.size == tvec.size == 0 and inliers.shape == (0, 1) and inliers.dtype == np.int32
    count, R, T, mask = refract.refractiveRecoverPose(none, none, rig.camera1, rig.camera2)
    assert count == 0 and R.size == T.size == mask.size == 0 and isinstance(mask, np.ndarray)
    result = refract.refractiveSolvePnPExtended(board.target[0], unseen, rig.camera1, False)
    assert result[0] is False and all(isinstance(a, np.ndarray) for a in result[1:])


# ---- one exception class

def test_one_exception_class(rig, board, tmp_path):
    """Every call of the package, with too few arguments, too many, an unknown name and wrong types."""
    calls = [getattr(refract, name) for name in dir(refract) if inspect.isbuiltin(getattr(refract, name))]
    methods = [getattr(made, name) for made in (rig.camera1, rig.window1) for name in dir(made)
               if not name.startswith("_") and callable(getattr(made, name)) and name != "save"]
    assert len(calls) > 40 and len(methods) > 15
    for call in calls + methods:
        for args, keywords in (((object(),), {}), ((object(),)*25, {}), ((), dict(nonsense=1)), ((1.5,)*3, {}), (("text",)*5, {})):
            try:
                call(*args, **keywords)
                raise AssertionError(f"{call.__name__} takes {args}, {keywords}")
            except refract.error as error:
                text = str(error)
                assert call.__name__ in text or call.__name__ == "refractiveIndex", text
                for bad in ("/work", "OpenCV(", "in function", "Overload resolution", "\0", ".cpp"):
                    assert bad not in text
    with pytest.raises(refract.error, match="window is 'glass'; it must be a GlassWindow"):
        refract.RefractiveCamera.create(rig.K1, None, "glass")
    for field, value in (("distance", "far"), ("distance", None), ("thickness", 3), ("normal", (1, 2)), ("materials", 5), ("wedge", "x")):
        with pytest.raises(refract.error, match=f"GlassWindow.{field}"):
            setattr(rig.window1, field, value)


def test_messages_are_about_the_form_that_was_meant(rig):
    with pytest.raises(refract.error) as caught:
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1)
    assert "depth is missing" in str(caught.value) and "cameraMatrix is" not in str(caught.value)
    with pytest.raises(refract.error) as caught:
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, -600.)
    assert str(caught.value) == caught.value.err == "depth is -600; it must be positive"
    assert caught.value.code < 0 and caught.value.line > 0 and "/" not in caught.value.file
    with pytest.raises(refract.error, match=r"Rs\[1\]"):
        refract.triangulateRefractive([rig.camera1]*2, [np.eye(3), "R"], [ZERO, ZERO], [rig.pixels1]*2)


def test_interruptions_are_not_arguments(rig):
    class Interrupting:
        def __fspath__(self):
            raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        refract.RefractiveCamera.read(Interrupting())


def test_refusals_leak_nothing(rig):
    refused = [lambda: refract.refractiveProjectPoints(rig.points, ZERO, ZERO, rig.camera1, 5),
               lambda: refract.refractiveProjectPoints(object(), ZERO, ZERO, rig.camera1),
               lambda: refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, -600.),
               lambda: refract.refractiveProjectPoints(rig.points, ZERO, ZERO, rig.camera1, nonsense=5),
               lambda: refract.GlassWindow((0, 0, 1), "thick", 1.5), lambda: setattr(rig.window1, "distance", "far")]

    def run(count):
        for _ in range(count):
            for call in refused:
                with pytest.raises(refract.error):
                    call()

    run(500)
    before = sys.getallocatedblocks()
    run(1000)
    assert sys.getallocatedblocks() - before < 100


# ---- the reference in Python

def test_every_name_has_its_text():
    for name in refract.__all__:
        thing = getattr(refract, name)
        if inspect.isbuiltin(thing) or (inspect.isclass(thing) and thing is not refract.error):      # cv2's has none
            assert thing.__doc__ and len(thing.__doc__) > 20, name
    for made in (refract.GlassWindow, refract.RefractiveCamera):
        for name, thing in vars(made).items():
            if not name.startswith("_"):
                assert thing.__doc__ and thing.__doc__ != name and len(thing.__doc__) > len(name) + 4, (made, name)
    for enumeration in (refract.RefractiveStatus, refract.GlassCalibrationFlags, refract.GlassImageStatus, refract.TriangulateFlags):
        for member in enumeration:
            assert member.__doc__ or member == 0, member
            assert getattr(refract, member.name) is member and member.name in enumeration.__doc__


def test_help_tells_fields_and_their_order():
    text = pydoc.render_doc(refract.GlassWindow, renderer=pydoc.plaintext)
    for part in ("GlassWindow(", "normal=[0.0, 0.0, 1.0]", "unit, camera coordinates", "from the camera outwards", "radians along e1",
                 "atWavelength"):
        assert part in text, part
    text = pydoc.render_doc(refract.RefractiveCamera, renderer=pydoc.plaintext)
    for part in ("create(cameraMatrix, distCoeffs, window=None)", "a copy: see setWindow", "What the rows of stdDeviations", "0x0 where"):
        assert part in text, part
    text = pydoc.render_doc(refract.GlassCalibrationFlags, renderer=pydoc.plaintext)
    assert "GLASS_FREE_WEDGE = 16777216: wedge of every layer" in text


def test_stubs_name_what_there_is():
    stub = Path(refract.__file__).with_suffix(".pyi").read_text()
    named = eval(stub[stub.rindex("__all__ = ") + len("__all__ = "):])
    assert sorted(named) == sorted(refract.__all__)
    for name in named:
        assert hasattr(refract, name), name


def test_signatures(rig):
    for name in refract.__all__:
        thing = getattr(refract, name)
        if inspect.isbuiltin(thing):
            assert str(inspect.signature(thing)).startswith("("), name
    bound = inspect.signature(refract.refractiveProjectPoints).bind(rig.points, ZERO, ZERO, rig.camera1)
    assert list(bound.arguments)[:3] == ["objectPoints", "rvec", "tvec"]
    signature = inspect.signature(refract.refractiveBundleAdjust)
    assert signature.parameters["flags"].default == 0 and signature.parameters["criteria"].default == (3, 1000, 1e-12)
    signature = inspect.signature(refract.GlassRigOptions)
    assert list(signature.parameters)[0] == "flags" and signature.parameters["criteria"].default == (3, 1000, 1e-12)
    assert inspect.signature(refract.GlassWindow).parameters["outerIndex"].default == 1


def test_repr_shows_values(rig):
    window = refract.GlassWindow((0, 0, 1), 20, 1.5, 50)
    assert repr(window) == "GlassWindow(normal=(0.0, 0.0, 1.0), thickness=[20.0], index=[1.5], distance=50.0)"
    assert repr(refract.GlassWindow()) == "GlassWindow()"
    text = repr(rig.camera1)
    assert "opencv" in text and "fx=2438.07" in text and "GlassWindow(normal=" in text


def test_equal_windows_and_cameras_are_equal(rig):
    assert refract.GlassWindow((0, 0, 2), 20, 1.5) == refract.GlassWindow((0, 0, 1), [20], [1.5])
    assert refract.GlassWindow((0, 0, 1), 20, 1.5) != refract.GlassWindow((0, 0, 1), 20, 1.5, 1)
    assert refract.GlassWindow() != "window"
    camera = rig.camera1.clone()
    assert camera == rig.camera1 and camera != rig.camera2
    camera.setImageSize((1280, 1024))
    assert camera != rig.camera1
    with pytest.raises(TypeError):
        hash(camera)


def test_a_field_is_not_changed_in_a_copy_of_it():
    window = refract.GlassWindow((0, 0, 1), [4, 4], [1.5, 1.5])
    with pytest.raises(TypeError):
        window.thickness[0] = 99
    window.thickness = [*window.thickness[:1], 99]
    assert window.thickness == [4, 99] == [*window.thickness] and window.thickness == (4, 99) and window.thickness != [4]
    assert np.sum(window.thickness) == 103 and isinstance(window.thickness, tuple)


# ---- flags and statuses

def test_flags_and_statuses_are_enumerations(rig, board):
    flags = refract.GLASS_FREE_THICKNESS | refract.GLASS_FREE_INDEX
    assert isinstance(flags, refract.GlassCalibrationFlags) and flags == 3 and refract.GLASS_FREE_INDEX in flags
    assert refract.GLASS_FREE_THICKNESS + refract.GLASS_FREE_INDEX == flags and flags & ~refract.GLASS_FREE_INDEX == 1
    accumulated = 0
    accumulated |= refract.GLASS_ROBUST
    assert isinstance(accumulated, refract.GlassCalibrationFlags)
    _, status = refract.refractiveProjectPoints(np.array([[0., 0, -1]]), ZERO, ZERO, rig.camera1)
    assert refract.RefractiveStatus(status[0, 0]) is refract.REFRACT_BEHIND_WINDOW
    lens = refract.RefractiveCamera.create(rig.K1, rig.D1)
    chosen, scores = refract.selectLensCoefficients(board.target, [board.direct1], [], [lens], [], [], [])
    assert isinstance(chosen, refract.GlassCalibrationFlags) and scores.shape[1] == 4
    again, _, covariances = refract.selectLensCoefficientsExtended(board.target, [board.direct1], [], [lens], [], [], [], 0)
    assert isinstance(again, refract.GlassCalibrationFlags) and covariances[0].shape == (lens.lensParameters().size,)*2


def test_flags_of_cv2_are_refused(rig, board):
    start = refract.GlassWindow((0, 0, 1), 20, 1.5437, 50.)
    CALIB_FIX_FOCAL_LENGTH, CALIB_FIX_K3 = 16, 128
    camera = refract.RefractiveCamera.create(rig.K1, rig.D1, start)
    before = camera.lensParameters()
    for flags in (CALIB_FIX_FOCAL_LENGTH, np.int32(16), True):
        with pytest.raises(refract.error, match="flags"):
            refract.calibrateGlass(board.target, board.direct1, board.glass1, camera, flags=flags)
    np.testing.assert_array_equal(camera.lensParameters(), before)
    with pytest.raises(refract.error, match="128 is no GlassCalibrationFlags"):
        refract.GLASS_FREE_INTRINSICS | CALIB_FIX_K3
    with pytest.raises(refract.error, match="16 is no GlassCalibrationFlags"):
        CALIB_FIX_FOCAL_LENGTH | refract.GLASS_FREE_INTRINSICS
    own = refract.GlassCalibrationFlags(1)
    assert refract.calibrateGlass(board.target, board.direct1, board.glass1, rig.K1, rig.D1, start, flags=own)[0] < 1e-5


def test_a_fixed_lens_that_is_not_free_is_said(rig, board):
    start = refract.GlassWindow((0, 0, 1), 20, 1.5437, 50.)
    with pytest.warns(UserWarning, match="GLASS_FIX_K1.*GLASS_FREE_INTRINSICS"):
        refract.calibrateGlass(board.target, board.direct1, board.glass1, rig.K1, rig.D1, start, flags=refract.GLASS_FIX_K1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        camera = refract.RefractiveCamera.create(rig.K1, rig.D1, start)
        refract.calibrateGlass(board.target, board.direct1, board.glass1, camera,
                               flags=refract.GLASS_FIX_K1 | refract.GLASS_FREE_INTRINSICS)


# ---- two writers and a reader

def write(name, seconds, failed):
    camera = refract.RefractiveCamera.create(np.diag([1000., 1000, 1]), np.zeros(8), refract.GlassWindow((0, 0, 1), 20, 1.5))
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            camera.save(name)
        except refract.error:
            failed.value += 1


def test_two_writers_and_a_reader(tmp_path):
    name, seconds = str(tmp_path / "camera.yml"), 10.
    spawn = multiprocessing.get_context("spawn")
    write(name, 0.01, spawn.Value("i", 0))
    counts = [spawn.Value("i", 0) for _ in range(2)]
    writers = [spawn.Process(target=write, args=(name, seconds, count)) for count in counts]
    for writer in writers:
        writer.start()
    reads = failed = 0
    while any(writer.is_alive() for writer in writers):
        try:
            refract.RefractiveCamera.read(name)
        except refract.error:
            failed += 1
        reads += 1
    for writer in writers:
        writer.join()
    written = sum(count.value for count in counts)
    print(f"[numbers] two writers and a reader of one file, {seconds:.0f} s: {failed} of {reads} reads failed, {written} writes")
    assert reads > 100 and failed == 0 and written == 0 and all(writer.exitcode == 0 for writer in writers)
    assert [path.name for path in tmp_path.iterdir()] == ["camera.yml"]
