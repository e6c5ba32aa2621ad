# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The package beside cv2, alone, and with its types."""
import importlib.util
import subprocess
import sys

import numpy as np
import pytest

import opencv_refract as refract

HAVE_CV2 = importlib.util.find_spec("cv2") is not None
CALLS = ["calibrateGlass", "calibrateGlassExtended", "calibrateGlassNormal", "computeRefractiveEpilines",
         "initRefractiveUndistortRectifyMap", "refractivePointsOnPlane", "refractiveProjectPoints",
         "refractiveProjectPointsExtended", "refractiveEpipolarDistance", "refractiveEpipolarDistanceExtended",
         "refractiveRecoverPose", "refractiveRecoverPoseExtended", "refractiveSolvePnP", "refractiveSolvePnPRansac",
         "refractiveSolvePnPExtended", "refractiveSolvePnPGenericExtended", "refractiveSolvePnPRansacExtended",
         "refractiveSolveP3P",
         "refractiveUndistortPoints", "readRig", "readRigExtended", "refractiveUnprojectPoints", "stereoCalibrateGlass",
         "triangulateRefractive", "triangulateRefractiveExtended", "writeRig", "refractiveBundleAdjust",
         "refractiveBundleAdjustExtended", "refractiveBundleAdjustSparse", "refractiveIndex"]


def test_every_call_is_here_with_its_docstring():
    for name in CALLS:
        call = getattr(refract, name)
        assert call.__module__ == "opencv_refract" and name in call.__doc__ and len(call.__doc__) > 300
    assert refract.GlassWindow.__module__ == refract.RefractiveCamera.__module__ == "opencv_refract"
    assert refract.__version__


@pytest.mark.skipif(not HAVE_CV2, reason="cv2 is not installed")
@pytest.mark.parametrize("imports", ["import cv2, opencv_refract", "import opencv_refract, cv2"])
def test_cv2_refract(imports):
    """In a fresh process, in both orders; OpenCV's own calls go on to work beside these."""
    subprocess.run([sys.executable, "-c", f"""
{imports}
import numpy as np
import cv2.refract
from cv2.refract import GlassWindow
assert cv2.refract.refractiveProjectPoints is opencv_refract.refractiveProjectPoints
assert cv2.error is opencv_refract.error
K, X = np.array([[1000., 0, 640], [0, 1000, 480], [0, 0, 1]]), np.array([[10., 20., 600.]])
D = np.array([-0.1, 0.02, 0.001, 0.002, 0.])
ours, _ = cv2.refract.refractiveProjectPoints(X, np.zeros(3), np.zeros(3), K, D, GlassWindow())
theirs, _ = cv2.projectPoints(X, np.zeros(3), np.zeros(3), K, D)
assert abs(ours.ravel() - theirs.ravel()).max() < 1e-9
try:
    cv2.refract.refractiveProjectPoints(X, np.zeros(3), np.zeros(3), K, np.zeros(3), GlassWindow())
except cv2.error as error:
    assert 'distCoeffs' in str(error)
else:
    raise AssertionError('no cv2.error')
try:
    cv2.undistortPoints(None, None, None)
except cv2.error:
    pass
"""], check=True)


@pytest.mark.skipif(not HAVE_CV2, reason="cv2 is not installed")
def test_an_opencv_with_the_module_keeps_its_own():
    subprocess.run([sys.executable, "-c", """
import cv2, types
own = cv2.refract = types.ModuleType('cv2.refract')
import opencv_refract
assert cv2.refract is own and opencv_refract.GlassWindow
"""], check=True)


def test_without_cv2():
    subprocess.run([sys.executable, "-c", """
import sys
sys.modules['cv2'] = None       # as if it were not installed
import numpy as np, opencv_refract
assert opencv_refract.error.__module__ == 'opencv_refract'
try:
    opencv_refract.RefractiveCamera.create(np.eye(2), None)
except opencv_refract.error as error:
    assert error.code < 0
else:
    raise AssertionError('no error')
"""], check=True)


def test_stubs_name_every_call():
    folder = importlib.util.find_spec("opencv_refract").submodule_search_locations[0]
    with open(f"{folder}/__init__.pyi") as file:
        stubs = file.read()
    for name in CALLS + ["class GlassWindow", "class RefractiveCamera", "GLASS_FREE_THICKNESS"]:
        assert name in stubs
    compile(stubs, "__init__.pyi", "exec")
    for argument in ("distCoeffs: Numbers | None", "depth: Numbers | Number | None"):
        assert argument in stubs
    import opencv_refract.typing as types
    assert types.Array and types.Numbers


def test_a_million_points_leak_nothing(rig):
    """Memory of inputs, views and results comes back."""
    import resource
    points = np.tile(rig.points, (5000, 1))
    zero = np.zeros(3)

    def run():
        for view in (points, points[::2], np.asfortranarray(points)):
            refract.refractiveProjectPoints(view, zero, zero, rig.camera1)
        for bad in (np.zeros((5, 2)), [1], "x"):
            with pytest.raises(refract.error):
                refract.refractiveProjectPoints(bad, zero, zero, rig.camera1)
        rig.camera1.window().normal

    run()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(20):
        run()
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before     # in kB
    assert grown < 20e3
