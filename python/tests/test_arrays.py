# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""NumPy arrays of every layout and type give the same answers; what cannot be understood is refused by name."""
import numpy as np
import pytest

import opencv_refract as refract


def every_second(a):
    wide = np.full((2*len(a), *a.shape[1:]), np.nan if a.dtype.kind == "f" else -1, a.dtype)
    wide[::2] = a
    return wide[::2]


def columns_of_a_table(a):
    table = np.full((len(a), 2 + a.shape[1] + 3), np.nan, a.dtype)
    table[:, 2:2 + a.shape[1]] = a
    return table[:, 2:2 + a.shape[1]]


def column_stride(a):
    table = np.full((len(a), 2*a.shape[1]), np.nan, a.dtype)
    table[:, ::2] = a
    return table[:, ::2]


def read_only(a):
    copy = a.copy()
    copy.flags.writeable = False
    return copy


def record_fields(a):
    records = np.zeros(len(a), [("id", np.int16), ("xyz", a.dtype, a.shape[1])])
    records["xyz"] = a
    return records["xyz"]


LAYOUTS = {
    "C": np.ascontiguousarray,
    "Fortran": np.asfortranarray,
    "transposed": lambda a: np.ascontiguousarray(a.T).T,
    "reversed": lambda a: a[::-1].copy()[::-1],
    "columns reversed": lambda a: a[:, ::-1].copy()[:, ::-1],
    "every second": every_second,
    "columns of a table": columns_of_a_table,
    "every second column": column_stride,
    "read-only": read_only,
    "Nx1xC": lambda a: a[:, None, :],
    "1xNxC": lambda a: a[None],
    "1xNxC every second": lambda a: every_second(a)[None],
    "Nx1xC of a table": lambda a: columns_of_a_table(a)[:, None, :],
    "fields of packed records": record_fields,
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder(">")),
    "a buffer's bytes": lambda a: np.frombuffer(a.tobytes(), a.dtype).reshape(a.shape),
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS.keys())
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_layouts(rig, layout, dtype):
    points, pixels = rig.points.astype(dtype), rig.pixels1[:, 0].astype(dtype)
    zero = np.zeros(3)
    expected, _ = refract.refractiveProjectPoints(points, zero, zero, rig.camera1)
    assert expected.dtype == dtype
    found, _ = refract.refractiveProjectPoints(layout(points), zero, zero, rig.camera1)
    np.testing.assert_array_equal(found, expected)

    expected = refract.refractiveUnprojectPoints(pixels, rig.camera1)
    found = refract.refractiveUnprojectPoints(layout(pixels), rig.camera1)
    for a, b in zip(found, expected):
        np.testing.assert_array_equal(a, b)

    expected, _ = refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, pixels, pixels + dtype(0.1))
    found, _ = refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, layout(pixels),
                                             layout(pixels + dtype(0.1)))
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("layout", ["every second", "columns of a table", "Fortran", "reversed", "fields of packed records"])
def test_layouts_of_views(rig, board, layout):
    """Lists of arrays for calls with many views."""
    expected = refract.calibrateGlassNormal(board.direct1, board.glass1, rig.K1, rig.D1)
    direct, glass = ([LAYOUTS[layout](view[:, 0]) for view in views] for views in (board.direct1, board.glass1))
    found = refract.calibrateGlassNormal(direct, tuple(glass), rig.K1, rig.D1)
    for a, b in zip(found, expected):
        np.testing.assert_array_equal(a, b)


VECTOR_LAYOUTS = {name: LAYOUTS[name] for name in ("other byte order", "read-only")}
VECTOR_LAYOUTS["every second"] = every_second
VECTOR_LAYOUTS["of packed records"] = lambda a: np.array([(x, 1) for x in a], [("x", a.dtype), ("flag", np.int8)])["x"]


@pytest.mark.parametrize("layout", VECTOR_LAYOUTS.values(), ids=VECTOR_LAYOUTS.keys())
def test_vectors_in_every_layout(rig, layout, tmp_path):
    """Fields of windows, vectors of a fixed length, lists of numbers."""
    window = refract.GlassWindow(layout(np.array([0.3, 0., 0.4])), 20., 1.5)
    np.testing.assert_allclose(window.normal, (0.6, 0., 0.8))
    window.thickness, window.index = layout(np.array([20., 30.])), layout(np.array([1.5, 1.6]))
    assert list(window.thickness) == [20., 30.] and list(window.index) == [1.5, 1.6]
    calls = [refract.refractiveEpipolarDistance(rig.pixels1, rig.pixels2 + 3, rig.camera1, rig.camera2, rig.R, rig.T,
                                                depthRange=depths)[0]
             for depths in ((300., 1500.), layout(np.array([300., 1500.])))]
    np.testing.assert_array_equal(*calls)
    name = str(tmp_path / "rig.yml")
    refract.writeRig(name, [rig.camera1, rig.camera1], [np.eye(3)]*2, [np.zeros(3)]*2, layout(np.array([0, 0], np.int32)))
    assert list(refract.readRigExtended(name)[3]) == [0, 0]


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int32])
def test_a_number_is_no_list(rig, dtype, tmp_path):
    window = refract.GlassWindow((0, 0, 1), 20., 1.5)
    for field in ("thickness", "index"):
        with pytest.raises((TypeError, refract.error)):
            setattr(window, field, np.array(2, dtype))
        assert list(getattr(window, field)) == [20. if field == "thickness" else 1.5]
    with pytest.raises((TypeError, refract.error)):
        refract.writeRig(str(tmp_path / "rig.yml"), [rig.camera1], [np.eye(3)], [np.zeros(3)], np.array(0, dtype))


def test_arrays_that_are_written_to(rig):
    zero = np.zeros(3)
    points, expected = rig.points[:5], rig.pixels1[:5]
    mine = np.zeros((5, 1, 2))
    found, _ = refract.refractiveProjectPoints(points, zero, zero, rig.camera1, mine)
    assert found is mine or np.shares_memory(found, mine)
    np.testing.assert_array_equal(mine, expected)
    with pytest.raises(refract.error, match="imagePoints.*byte order"):
        refract.refractiveProjectPoints(points, zero, zero, rig.camera1, np.zeros((5, 1, 2), ">f8"))
    with pytest.raises(refract.error, match="imagePoints.*readonly"):
        refract.refractiveProjectPoints(points, zero, zero, rig.camera1, read_only(mine))


def test_matrices_in_every_layout(rig):
    points = rig.points
    rvec, tvec = np.array([0.1, 0.2, 0.3]), np.array([1., 2., 3.])
    expected, _ = refract.refractiveProjectPoints(points, rvec, tvec, *rig.lens1)
    big = np.zeros((6, 6))
    big[::2, ::2] = rig.K1
    for K in (np.asfortranarray(rig.K1), big[::2, ::2], rig.K1.T.copy().T):
        for D in (rig.D1[None], rig.D1[:, None], rig.D1[::-1].copy()[::-1], tuple(rig.D1)):
            for t in (tvec[None], tvec[:, None], tuple(tvec)):
                found, _ = refract.refractiveProjectPoints(points, rvec, t, K, D, rig.window1)
                np.testing.assert_array_equal(found, expected)


def test_none_is_nothing(rig):
    zero = np.zeros(3)
    plain, _ = refract.refractiveProjectPoints(rig.points, zero, zero, rig.K1, None, None)
    expected = rig.points @ rig.K1.T
    np.testing.assert_allclose(plain[:, 0], expected[:, :2]/expected[:, 2:], rtol=1e-13)
    empty, status = refract.refractiveProjectPoints(None, zero, zero, *rig.lens1)
    assert empty.shape == (0, 1, 2) and status.shape == (0, 1) and status.dtype == np.uint8
    far, _ = refract.refractiveUndistortPoints(rig.pixels1, rig.K1, rig.D1, None, depth=None, R=None, P=None)
    infinite, _ = refract.refractiveUndistortPoints(rig.pixels1, rig.K1, rig.D1, None, depth=np.inf)
    np.testing.assert_array_equal(far, infinite)


def test_outputs_may_be_given(rig):
    out = np.empty_like(rig.pixels1)
    returned, _ = refract.refractiveProjectPoints(rig.points, np.zeros(3), np.zeros(3), *rig.lens1, out)
    assert np.shares_memory(returned, out)
    np.testing.assert_array_equal(out, rig.pixels1)


def test_a_point_without_an_answer(rig):
    points = rig.points.copy()
    points[3] = 0., 0., -100.
    points[5] = np.nan
    pixels, status = refract.refractiveProjectPoints(points, np.zeros(3), np.zeros(3), rig.camera1)
    assert np.isnan(pixels[[3, 5]]).all() and np.isfinite(np.delete(pixels, [3, 5], axis=0)).all()
    assert status[3, 0] in (refract.REFRACT_BEHIND_CAMERA, refract.REFRACT_BEHIND_WINDOW)
    assert status[5, 0] == refract.REFRACT_NOT_FINITE


@pytest.mark.parametrize("bad, text", [
    (np.zeros((5, 2)), "objectPoints"),
    (np.zeros((5, 3), np.int32), "objectPoints"),
    (np.zeros((5, 3), np.int64), "objectPoints"),
    (np.zeros((5, 3), complex), "objectPoints"),
    (np.zeros((2, 2, 2, 3)), "objectPoints"),
    ([[1., 2., 3.]], "objectPoints"),
    ("points", "objectPoints"),
])
def test_bad_points_are_named(rig, bad, text):
    with pytest.raises(refract.error, match=text):
        refract.refractiveProjectPoints(bad, np.zeros(3), np.zeros(3), *rig.lens1)


def test_bad_arguments_are_named(rig):
    zero = np.zeros(3)
    with pytest.raises(refract.error, match="cameraMatrix"):
        refract.refractiveProjectPoints(rig.points, zero, zero, np.eye(2), None, rig.window1)
    with pytest.raises(refract.error, match="distCoeffs"):
        refract.refractiveProjectPoints(rig.points, zero, zero, rig.K1, np.zeros(3), rig.window1)
    with pytest.raises(refract.error, match="tvec"):
        refract.refractiveProjectPoints(rig.points, zero, np.zeros(2), *rig.lens1)
    with pytest.raises(refract.error, match="depth is -600"):
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, depth=-600.)
    with pytest.raises(refract.error, match="depth has 3"):
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, depth=np.full(3, 600.))
    with pytest.raises(refract.error, match="whichImage"):
        refract.computeRefractiveEpilines(rig.pixels1, 3, rig.camera1, rig.camera2, rig.R, rig.T, (400., 900.))
    with pytest.raises(refract.error, match="points2"):
        refract.triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, rig.pixels1, rig.pixels2[:-1])
    with pytest.raises(refract.error, match="(?i)camera"):
        refract.refractiveUndistortPoints(rig.pixels1, None, 600.)
    with pytest.raises(refract.error, match="GLASS_FREE_DISTANCE|distance"):
        refract.calibrateGlass([rig.points], [rig.pixels1], [rig.pixels1], rig.K1, rig.D1, rig.window1,
                               flags=refract.GLASS_FREE_DISTANCE)


def test_the_error_has_opencvs_attributes(rig):
    with pytest.raises(refract.error) as caught:
        refract.refractiveUndistortPoints(rig.pixels1, rig.camera1, depth=-600.)
    assert "depth" in caught.value.err and caught.value.code < 0 and caught.value.line > 0
