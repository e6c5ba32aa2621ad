# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The published rig, simulated: boards, what cameras see of them with and without glass, how errors are counted.

Noise: the paper states none, but implies one. Its rectified rows differ by 0.2343 px RMS without glass (Figure 17); if
all of that is noise of two corners, each has 0.2343/sqrt(2) = 0.166 px.
"""
import cv2
import numpy as np
import opencv_refract as refract
import published

SIGMA = published.MATCHING_WITHOUT/np.sqrt(2)
SEED = 1
BOARD = published.SPACING*np.array([(column - (published.COLUMNS - 1)/2, row - (published.ROWS - 1)/2, 0)
                                    for row in range(published.ROWS) for column in range(published.COLUMNS)])
LENSES = (published.K1, published.D1), (published.K2, published.D2)

# The paper's rotation maps as X2 = M_R^T X1 + M_T; printed to four digits, it is made orthonormal.
_U, _, _Vt = np.linalg.svd(published.M_R.T)
R, T = _U @ _Vt, published.M_T
POSES = (np.eye(3), np.zeros(3)), (R, T)
HALF_CONVERGENCE = np.linalg.norm(cv2.Rodrigues(R)[0])/2
NO_WINDOW = refract.GlassWindow()


def make_window(normal):
    return refract.GlassWindow(tuple(normal), published.THICKNESS, published.INDEX)


def look(points, camera, window, rng=None):
    """Raw pixels (N, 2) of points in the frame of camera 1, seen by camera 0 (left) or 1; without rng no noise."""
    pixels, status = refract.refractiveProjectPoints(points, *POSES[camera], *LENSES[camera], window)
    assert not status.any()
    return pixels[:, 0] + (0 if rng is None else rng.normal(0, SIGMA, (len(points), 2)))


def in_view(points, cameras):
    for camera in cameras:
        pixels = look(points, camera, NO_WINDOW)
        if (pixels < 20).any() or (pixels > np.array(published.IMAGE_SIZE) - 20).any():
            return False
    return True


def board_points(rng, center, jitter, tilt, cameras=(0,), scale=1.):
    """Corners (30, 3) of a board in the frame of camera 1, wholly in view of the cameras.

    center +- jitter (3) mm; tilted by up to `tilt` degrees from facing them; scale: of the board's size.
    """
    facing = np.array([0, -HALF_CONVERGENCE if len(cameras) == 2 else 0., 0])
    for _ in range(1000):
        axis = np.append(rng.normal(size=2), 0)
        turn = cv2.Rodrigues(axis/np.linalg.norm(axis)*np.radians(rng.uniform(0, tilt)))[0] @ cv2.Rodrigues(facing)[0]
        points = scale*BOARD @ turn.T + center + rng.uniform(-1, 1, 3)*jitter
        if in_view(points, cameras):
            return points
    raise RuntimeError("no board position in view")


def calibration_boards(rng, cameras, count=25):
    """As the paper's Zhang calibration near the working distance: 560 to 660 mm, tilted by up to 30 degrees."""
    return [board_points(rng, (0, 0, published.BOARD_DISTANCE), (30, 30, 50), 30, cameras) for _ in range(count)]


def undistorted(pixels, lens):
    """Ideal pixels (N, 2): the lens undone, the window not."""
    return refract.refractiveUndistortPoints(pixels, *lens, NO_WINDOW, None, P=lens[0])[0][:, 0]


def calibrate_lens(views, flags=cv2.CALIB_ZERO_TANGENT_DIST + cv2.CALIB_FIX_K3):
    """OpenCV's calibration of one camera from views (30, 2) of the board: K, D."""
    boards = [BOARD.astype(np.float32)]*len(views)
    _, K, D, *_ = cv2.calibrateCamera(boards, [view.astype(np.float32) for view in views], published.IMAGE_SIZE, None,
                                      None, flags=flags)
    return K, D


def calibrate_extrinsics(lens1, lens2, views1, views2):
    """OpenCV's R, T of a pair of cameras whose lenses are known."""
    boards = [BOARD.astype(np.float32)]*len(views1)
    views = ([view.astype(np.float32) for view in views] for views in (views1, views2))
    return cv2.stereoCalibrate(boards, *views, *lens1, *lens2, published.IMAGE_SIZE, flags=cv2.CALIB_FIX_INTRINSIC)[5:7]


def rigid_motion(points, onto):
    """The function that moves points (N, 3) rigidly: what it was made from goes as near as possible onto the other."""
    p, q = points.mean(axis=0), onto.mean(axis=0)
    U, _, Vt = np.linalg.svd((onto - q).T @ (points - p))
    turn = U @ np.diag((1, 1, np.linalg.det(U @ Vt))) @ Vt
    return lambda others: (others - p) @ turn.T + q


def segment_lengths(points):
    """Figure 14's six segments: left column, top row, one diagonal; right column, bottom row, the other diagonal."""
    grid = points.reshape(published.ROWS, published.COLUMNS, 3)
    top_left, top_right, bottom_left, bottom_right = grid[0, 0], grid[0, -1], grid[-1, 0], grid[-1, -1]
    ends = ((top_left, bottom_left), (top_left, top_right), (top_left, bottom_right),
            (top_right, bottom_right), (bottom_left, bottom_right), (top_right, bottom_left))
    return np.array([np.linalg.norm(a - b) for a, b in ends])


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))


def norms(vectors):
    return np.linalg.norm(vectors, axis=-1)


def angle(a, b):
    """Degrees between two directions."""
    a, b = np.ravel(a), np.ravel(b)
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))
