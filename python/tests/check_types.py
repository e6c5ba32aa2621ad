# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""mypy and pyright over the samples, the Python of doc/, right calls (none may be flagged) and wrong ones (all must be).

Usage: check_types.py      in an environment with both, the package, cv2 and matplotlib; test/python.sh makes it"""
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# Names that the lines below use.
HEAD = """
import numpy as np
import opencv_refract as refract
from opencv_refract import GlassWindow, RefractiveCamera
K, points, pixels, status = np.eye(3), np.zeros((5, 3)), np.zeros((5, 2)), np.zeros((5, 1), np.uint8)
window = GlassWindow((0, 0, 1), 20, 1.5)
camera = RefractiveCamera.create(K, None, window)
R, T, image = np.eye(3), np.zeros(3), np.zeros((48, 64, 3), np.uint8)
"""
RIGHT = """
GlassWindow([0, 0, 1.], [4, .76, 4], [1.52, 1.49, 1.52], innerIndex=1, materials=["air", "N-BK7"])
GlassWindow(np.array([0, 0, 1]), np.float32(20), np.int64(2), outerIndex=1.33)
window.thickness = [4, 0.76]; window.normal = np.array([0, 0, 1.]); window.wedge = [(1e-3, 0)]; x: float = window.thickness[0]
window.normal == [0, 0, 1]; repr(window); window == camera.window(); window.materials = ["air", "N-BK7", "water"]
RefractiveCamera.create(K, [0.1, 0, 0, 0]); RefractiveCamera.create(K, D) if (D := np.zeros(5)) is not None else None
camera.setImageSize((640, 480)); camera.setImageSize(image.shape[1::-1]); width: int = camera.imageSize()[0]
refract.refractiveProjectPoints(points, (0, 0, 0), [0, 0, 0], camera)[0].reshape(-1, 2)
refract.refractiveProjectPoints(points, R, T, K, None, None)
refract.refractiveUndistortPoints(pixels, camera, 600); refract.refractiveUndistortPoints(pixels, camera, depth=np.float32(6.5))
refract.refractiveUndistortPoints(pixels, K, None, window, points[:, 2], P=K); refract.refractiveUndistortPoints(pixels, camera, None)
lines, lines_status = refract.computeRefractiveEpilines(pixels, 1, camera, camera, R, T, (400., np.inf)); lines[0][:, 0].T
X, s = refract.triangulateRefractive(camera, camera, R, T, pixels, pixels, flags=refract.TRIANGULATE_MIDPOINT); X[s.ravel() == 0]
refract.triangulateRefractive([camera, camera], (R, R), [T, [1, 0, 0]], [pixels, pixels])
refract.refractivePointsOnPlane(pixels, camera, [0, 0, 1, 600]); refract.refractivePointsOnPlane(pixels, camera, np.array([0, 0, 1, 6]))
cameras, Rs, Ts = refract.readRig("calib.yml"); refract.triangulateRefractive(cameras, Rs, Ts, [pixels, pixels])
import pathlib; refract.readRigExtended(pathlib.Path("calib.yml"))[4].shape; RefractiveCamera.read(pathlib.Path("c.yml"), "camera2")
refract.calibrateGlass([points]*3, None, [pixels]*3, K, None, window)[1].normal
rms, w, rvecs, tvecs = refract.calibrateGlass([points], [pixels], [pixels], K, None, window, flags=refract.GLASS_FREE_INDEX); rvecs[0] + 1
refract.calibrateGlass([points], [pixels], [pixels], camera, flags=refract.GLASS_ROBUST | refract.GLASS_FIX_K1)[0] < 0.1
flags, scores = refract.selectLensCoefficients([points], [[pixels]], [], [camera], [], [], []); flags | refract.GLASS_ROBUST
refract.selectLensCoefficientsExtended([points], [[pixels]], [], [camera], [], [], [], 0)[2][0].shape
refract.refractiveBundleAdjust([pixels], [camera], [], [], [], None, None, refract.GLASS_FIX_NORMAL)[3].shape
options = refract.GlassRigOptions(refract.GLASS_ROBUST, cameraCovariances=[K], computeCovariance=True); options.targetCovariance = None
options.flags |= refract.GLASS_FREE_INDEX; options.criteria = (3, 50, 1e-9); options.pixelCovariancesDirect = [[np.ones((5, 3))]]
r, *_ = refract.calibrateGlassRigExtended([points], [], [[pixels]], [camera], [], [], [], [], [], options); np.diag(r.covariance)
refract.refractiveBundleAdjustExtended([[pixels]], [camera], [], [], [], [], [], None, None, refract.BundleAdjustOptions())[0].inliers[0]
found, rvec, tvec, e = refract.refractiveSolvePnP(points, pixels, camera, (0, 0, 0), [0, 0, 600], True); rvec.ravel()
map1, map2 = refract.initRefractiveUndistortRectifyMap(camera, 600, None, None, (64, 48), 5); map1[0, 0]
K2, roi = refract.getOptimalNewRefractiveCameraMatrix(camera, 600, (64, 48), 0); left: int = roi[0]
(a, b), R1, R2, P1, P2, Q, roi1, roi2 = refract.refractiveStereoRectify(camera, camera, R, T, (64, 48), (400, 900)); R1 @ T
refract.RefractiveStatus(status[0, 0]).name; n: refract.GlassCalibrationFlags = refract.GLASS_FREE_INDEX | refract.GLASS_FREE_WEDGE
import copy; copy.deepcopy(camera).lensParameters().size; index: float = refract.refractiveIndex("N-BK7")
try: window.check()\nexcept refract.error as error: print(error.code, error.err)
"""
WRONG = """
window.thickness[0] = 99
GlassWindow("normal", 20, 1.5)
GlassWindow((0, 0, 1), 20, 1.5, distanc=5)
refract.refractiveUndistortPoints(pixels, camera)
refract.refractiveUndistortPoints(pixels, camera, "600")
refract.triangulateRefractive(camera, camera, R, T, pixels, pixels, refract.TRIANGULATE_MIDPOINT)
refract.calibrateGlass([points], [pixels], [pixels], camera, flags=16)
refract.calibrateGlass([points], [pixels], [pixels], K, None, window, refract.GLASS_FREE_INDEX)
refract.refractiveSolvePnP(points, pixels, camera, True)
refract.GlassRigOptions(cameraCovariance=[K])
refract.BundleAdjustOptions(flags=16)
refract.calibrateGlassRigExtended([points], [], [[pixels]], [camera], [], [], [], [], [], refract.BundleAdjustOptions())
refract.refractiveProjectPoints(points, R, T, window)
refract.refractiveProjectPoints([[1., 2., 3.]], R, T, camera)
refract.triangulateRefractive(camera, R, T, [pixels])
RefractiveCamera(K)
camera.window().thicknes
refract.refractiveIndex(1.5)
refract.GLASS_FREE_NOTHING
"""


def lines_of(text):
    return [line.replace("\\n", "\n") for line in text.strip().split("\n")]


def write_blocks(folder):
    """The blocks of a page as one file: names of one are known in the next."""
    for page in sorted((ROOT / "doc").glob("*.md")):
        blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
        if blocks:
            (folder / f"doc_{page.stem}.py").write_text("\n".join(blocks))
    (folder / "right.py").write_text(HEAD + "\n".join(lines_of(RIGHT)))
    for i, line in enumerate(lines_of(WRONG)):
        (folder / f"wrong_{i:02}.py").write_text(HEAD + line + "\n")


def flagged(checker, files):
    """{file: errors}"""
    if checker == "mypy":
        command = ["-m", "mypy", "--no-incremental", "--hide-error-context", "--no-error-summary", "--check-untyped-defs"]
    else:
        command = ["-m", "pyright", "--pythonpath", sys.executable]
    result = subprocess.run([sys.executable, *command, *map(str, files)], capture_output=True, text=True)
    if result.returncode not in (0, 1):
        sys.exit(f"{checker} did not run:\n{result.stdout}{result.stderr}")
    errors = {file: [] for file in files}
    for line in result.stdout.split("\n"):
        for file in files:
            if str(file) in line and re.search(r"error:| - error", line):
                errors[file].append(line)
    return errors


def errors_of_stubs(folder):
    """What mypy says of the package's own types: as an installed package it would be silent."""
    package = Path(importlib.util.find_spec("opencv_refract").origin).parent
    copy = folder / "own" / package.name
    copy.mkdir(parents=True)
    for name in ("__init__.pyi", "typing.py"):
        shutil.copy(package / name, copy)
    result = subprocess.run([sys.executable, "-m", "mypy", "--no-incremental", "--no-error-summary", "--strict", "-p", package.name],
                            capture_output=True, text=True, cwd=copy.parent)
    return [line for line in result.stdout.split("\n") if "error:" in line] + [result.stderr]*(result.returncode > 1)


def main():
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        write_blocks(folder)
        right = sorted((ROOT / "samples" / "python").glob("*.py")) + sorted(folder.glob("doc_*.py")) + [folder / "right.py"]
        wrong = sorted(folder.glob("wrong_*.py"))
        for checker in ("mypy", "pyright"):
            errors = flagged(checker, right + wrong)
            false = [line for file in right for line in errors[file]]
            missed = [file.read_text().strip().split("\n")[-1] for file in wrong if not errors[file]]
            print(f"[numbers] {checker}: {len(false)} errors in {len(right) - 1} samples and pages of doc/ and "
                  f"{len(lines_of(RIGHT))} lines of right calls; {len(wrong) - len(missed)} of {len(wrong)} wrong calls flagged")
            for line in false + [f"not flagged: {line}" for line in missed]:
                print(line)
            failed = failed or bool(false or missed)
        own = errors_of_stubs(folder)
    print(f"[numbers] mypy --strict: {len(own)} errors in the package's types")
    for line in own:
        print(line)
    return 1 if failed or own else 0


if __name__ == "__main__":
    sys.exit(main())
