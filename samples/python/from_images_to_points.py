# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# %% [markdown]
# # From images to measured points
# Two cameras, each behind its own tilted window. Images of a chessboard give first the cameras, then the windows,
# then points in space; on the way, pictures of what the glass does.
#
# Run it as a notebook (VS Code, Jupytext), cell by cell, or as a program:
#
#     from_images_to_points.py [DIRECTORY [OUTPUT]]     # images as in samples/data/stereo; pictures go to OUTPUT (out)

# %%
import glob
import os
import sys

import cv2
import matplotlib
import numpy as np
import opencv_refract as refract

if __name__ == "__main__" and "ipykernel" not in sys.modules:
    matplotlib.use("Agg")       # as a program it opens no window
import matplotlib.pyplot as plt

HERE = os.path.dirname(os.path.abspath(globals().get("__file__", "samples/python/.")))
ARGUMENTS = [] if "ipykernel" in sys.modules else sys.argv[1:]
DATA = ARGUMENTS[0] if ARGUMENTS else os.path.join(HERE, "..", "data", "stereo")
OUTPUT = ARGUMENTS[1] if len(ARGUMENTS) > 1 else "out"
SIZE, SQUARE = (6, 5), 39.
BOARD = np.array([(SQUARE*x, SQUARE*y, 0) for y in range(SIZE[1]) for x in range(SIZE[0])])
THICKNESS, INDEX = 20., 1.5437      # of both windows, from the data sheet


def finish(figure, name):
    os.makedirs(OUTPUT, exist_ok=True)
    figure.savefig(os.path.join(OUTPUT, name), dpi=110, bbox_inches="tight")
    plt.show() if "ipykernel" in sys.modules else plt.close(figure)


# %% [markdown]
# ## Corners
# In `direct1`, `direct2` the windows are taken away; in `glass1`, `glass2` they are there. A board that was not moved
# in between has the same name in both.

# %%
def find_corners(folder):
    """Corners of every image of a folder, by name."""
    corners = {}
    for path in sorted(glob.glob(os.path.join(DATA, folder, "*.*"))):
        image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
        if image is None:
            sys.exit("cannot read " + path)
        found, points = cv2.findChessboardCornersSB(image, SIZE, flags=cv2.CALIB_CB_ACCURACY)
        if not found:
            sys.exit("no chessboard found in " + path)
        corners[os.path.splitext(os.path.basename(path))[0]] = points
    return corners


direct, glass, measure = ([find_corners(f"{folder}{camera}") for camera in (1, 2)]
                          for folder in ("direct", "glass", "measure"))
print(f"{len(direct[0])} views without the windows, {len(glass[0])} of them also through the windows, "
      f"{len(measure[0])} to measure")

# %% [markdown]
# ## The cameras, without the windows: OpenCV as always

# %%
boards = [BOARD.astype(np.float32)]*len(direct[0])
views = [[points.astype(np.float32) for points in camera.values()] for camera in direct]
lenses = [cv2.calibrateCamera(boards, v, (1280, 1024), None, None, flags=cv2.CALIB_FIX_K3)[1:3] for v in views]
(K1, D1), (K2, D2) = lenses
stereo = cv2.stereoCalibrate(boards, views[0], views[1], K1, D1, K2, D2, (1280, 1024), flags=cv2.CALIB_FIX_INTRINSIC)
rms, R, T = stereo[0], stereo[5], stereo[6]
print(f"two cameras, {np.linalg.norm(T):.2f} mm apart, {rms:.3f} px RMS")

# %% [markdown]
# ## The windows
# The normal straight from the pairs, then the maximum-likelihood fit with its uncertainty.

# %%
windows = []
for (K, D), without, through in zip(lenses, direct, glass):
    pairs = [without[name] for name in through], list(through.values())
    normal = refract.calibrateGlassNormal(*pairs, K, D)[1]
    start = refract.GlassWindow(normal, THICKNESS, INDEX)
    fit = refract.calibrateGlassExtended([BOARD]*len(through), *pairs, K, D, start)
    rms, window, deviations = fit[0], fit[1], fit[4]
    at = 4 + D.size     # the normal's place among the parameters
    print(f"normal {np.round(window.normal, 4)}, {np.degrees(np.arccos(window.normal[2])):.2f} degrees from the axis, "
          f"+- {np.degrees(np.linalg.norm(deviations[at:at + 3])/np.sqrt(2)):.3f} degrees; {rms:.3f} px RMS")
    windows.append(window)
camera1, camera2 = (refract.RefractiveCamera.create(K, D, window) for (K, D), window in zip(lenses, windows))
bare1, bare2 = (refract.RefractiveCamera.create(K, D) for K, D in lenses)

# %% [markdown]
# ## What the window does to an image: displacement of points at 600 mm

# %%
u, v = (a.ravel().astype(float) for a in np.meshgrid(np.linspace(40, 1240, 13), np.linspace(40, 984, 11)))
rays = cv2.undistortPoints(np.column_stack((u, v)), K1, D1)[:, 0]
on_plane = 600.*np.column_stack((rays, np.ones(len(rays))))
seen = refract.refractiveProjectPoints(on_plane, np.zeros(3), np.zeros(3), camera1)[0][:, 0]
unseen = refract.refractiveProjectPoints(on_plane, np.zeros(3), np.zeros(3), bare1)[0][:, 0]
shift = seen - unseen
figure, axes = plt.subplots(figsize=(8, 6))
arrows = axes.quiver(*unseen.T, *shift.T, np.linalg.norm(shift, axis=1), angles="xy", scale_units="xy", scale=0.25,
                     width=0.003)
figure.colorbar(arrows, label="displacement, px (arrows four times as long)")
axes.set(xlim=(0, 1280), ylim=(1024, 0), aspect="equal", xlabel="u, px", ylabel="v, px",
         title="Camera 1: displacement by the window at 600 mm")
finish(figure, "displacement.png")

# %% [markdown]
# ## Epipolar curves against straight lines
# Without a window the partner of a point lies on a line (bent a little by the lens). Behind the window it does not.

# %%
name = "z600_1"
chosen = [0, 8, 16, 21, 29]
left, right = (camera[name] for camera in measure)
curves, _ = refract.computeRefractiveEpilines(left[chosen], 1, camera1, camera2, R, T, (400., 1500.))
lines, _ = refract.computeRefractiveEpilines(left[chosen], 1, bare1, bare2, R, T, (400., 1500.))
figure, (whole, close) = plt.subplots(1, 2, figsize=(13, 5))
image = glob.glob(os.path.join(DATA, "measure2", name + ".*"))[0]
for axes in (whole, close):
    axes.imshow(cv2.imread(image, cv2.IMREAD_GRAYSCALE), cmap="gray", vmin=0, vmax=255)
    for curve, line, partner in zip(curves, lines, right[chosen]):
        axes.plot(*line[:, 0].T, "--", color="tab:orange", lw=1, label="window ignored")
        axes.plot(*curve[:, 0].T, color="tab:cyan", lw=1, label="through the windows")
        axes.plot(*partner[0], "o", color="tab:red", ms=4, mfc="none", label="partner")
x, y = right[chosen[2], 0]
whole.set(xlim=(0, 1280), ylim=(1024, 0), title="image 2")
close.set(xlim=(x - 40, x + 40), ylim=(y + 30, y - 30), title="one partner, close up")
close.legend(*(column[:3] for column in close.get_legend_handles_labels()))
finish(figure, "epipolar_curves.png")

# %% [markdown]
# ## Points, and what they are worth: lengths on the board, window ignored and with it

# %%
def length_errors(cameras, name):
    first, second = cameras
    points, status = refract.triangulateRefractive(first, second, R, T, measure[0][name], measure[1][name])
    from_first = np.linalg.norm(points[1:, 0] - points[0, 0], axis=1)
    return from_first - np.linalg.norm(BOARD[1:] - BOARD[0], axis=1)


def rms_of(errors):
    return np.sqrt(np.mean(np.square(errors)))


names = list(measure[0])
before = [rms_of(length_errors((bare1, bare2), name)) for name in names]
after = [rms_of(length_errors((camera1, camera2), name)) for name in names]
print("view        window ignored   with the window   (RMS error of lengths from the first corner, mm)")
for row in zip(names, before, after):
    print("{:10s} {:13.3f} {:15.3f}".format(*row))
print(f"all        {rms_of(before):13.3f} {rms_of(after):15.3f}")

figure, axes = plt.subplots(figsize=(8, 4))
places = np.arange(len(names))
axes.bar(places - 0.2, before, 0.4, color="tab:orange", label="window ignored")
axes.bar(places + 0.2, after, 0.4, color="tab:cyan", label="with the window")
axes.set(yscale="log", ylim=(None, 4.), ylabel="RMS error of lengths, mm",
         title="The name says the distance: z600 = about 600 mm")
axes.set_xticks(places, names, rotation=60)
axes.legend()
finish(figure, "errors.png")
