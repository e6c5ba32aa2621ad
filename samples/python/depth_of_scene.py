# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The depth of a scene from a pair of images that were taken through windows.

    depth_of_scene.py | depth_of_scene_behind_glass.py [LEFT RIGHT]      # samples/data/scene's by default

depth_of_scene.py is the ordinary OpenCV script, which knows nothing of the windows; depth_of_scene_behind_glass.py is the same
script made right. doc/drop_in.md shows what changed.
"""
import os
import sys

import cv2
import numpy as np

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "scene")
LEFT, RIGHT = sys.argv[1:] or [os.path.join(DATA, f"glass{i}", "scene.jpg") for i in (1, 2)]

rig = cv2.FileStorage(os.path.join(DATA, "truth.yml"), cv2.FILE_STORAGE_READ)
K1, D1 = (rig.getNode("camera1").getNode(key).mat() for key in ("camera_matrix", "distortion_coefficients"))
K2, D2 = (rig.getNode("camera2").getNode(key).mat() for key in ("camera_matrix", "distortion_coefficients"))
R, T = rig.getNode("R").mat(), rig.getNode("T").mat()
left, right = cv2.imread(LEFT), cv2.imread(RIGHT)
if left is None or right is None:
    sys.exit(f"cannot read {LEFT} and {RIGHT}")
size = left.shape[1], left.shape[0]

R1, R2, P1, P2, Q, _, _ = cv2.stereoRectify(K1, D1, K2, D2, size, R, T, flags=0)
matcher = cv2.StereoSGBM.create(minDisparity=-112, numDisparities=272, blockSize=5, P1=200, P2=800, disp12MaxDiff=1,
                                preFilterCap=31, uniquenessRatio=10, speckleWindowSize=100, speckleRange=2,
                                mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY)
maps1 = cv2.initUndistortRectifyMap(K1, D1, R1, P1, size, cv2.CV_16SC2)
maps2 = cv2.initUndistortRectifyMap(K2, D2, R2, P2, size, cv2.CV_16SC2)
rectified1, rectified2 = cv2.remap(left, *maps1, cv2.INTER_LINEAR), cv2.remap(right, *maps2, cv2.INTER_LINEAR)
disparity = matcher.compute(rectified1, rectified2)/np.float32(16)
points = cv2.reprojectImageTo3D(disparity, Q, handleMissingValues=True)

# The back wall of the scene, frame of camera 1.
on_wall, normal = np.array((0., 0., 1100.)), np.array((0.1, 0., -1.))/np.hypot(0.1, 1)
points = points.reshape(-1, 3) @ R1
distances = (points - on_wall) @ normal
near = distances[np.abs(distances) < 20]
share = np.mean((points[:, 2] > 0) & (points[:, 2] < 2000))
print(f"{100*share:.0f} % of the pixels have a point; {len(near)} are of the back wall, {np.sqrt(np.mean(near**2)):.2f} mm RMS from it")
