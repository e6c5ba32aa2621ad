# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Has a camera of a rig turned since its calibration, and how far? From one pair of images of any scene, without a board.

    turned_camera.py [LEFT RIGHT]       # samples/data/scene's by default

Camera 2 of the calibration is turned by 0.1 degrees first, so that there is something to find.
"""
import os
import sys

import cv2
import numpy as np
import opencv_refract as refract

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "scene")
LEFT, RIGHT = sys.argv[1:] or [os.path.join(DATA, f"glass{i}", "scene.jpg") for i in (1, 2)]
DEPTH = 430, 1250           # z of the scene in the frame of camera 1
SEARCH = 6                  # px from the epipolar curve: what a camera may have turned
MAY_TURN = np.radians(0.3)  # one standard deviation
TOGETHER = 0.03             # px: by which all features of an image may be off together; no number of matches averages it
BUMP = np.radians((0.1, 0, 0))
OFFSET = 0.25               # px, by which SIFT is off that doubles the image with cv2.resize: all but with enable_precise_upscale

left, right = cv2.imread(LEFT, cv2.IMREAD_GRAYSCALE), cv2.imread(RIGHT, cv2.IMREAD_GRAYSCALE)
if left is None or right is None:
    sys.exit(f"cannot read {LEFT} and {RIGHT}")
cameras, (one, R), (zero, T) = refract.readRig(os.path.join(DATA, "truth.yml"))
bumped = cv2.Rodrigues(BUMP)[0]
R, T = bumped @ R, bumped @ T

# Features that are alike, clearly before all others; half of them may be wrong.
sift = cv2.SIFT_create(4000)
keys1, descriptors1 = sift.detectAndCompute(left, None)
keys2, descriptors2 = sift.detectAndCompute(right, None)
pairs = [first for first, second in cv2.BFMatcher(cv2.NORM_L2).knnMatch(descriptors1, descriptors2, 2)
         if first.distance < 0.8*second.distance]
points1 = np.array([keys1[pair.queryIdx].pt for pair in pairs]) - OFFSET
points2 = np.array([keys2[pair.trainIdx].pt for pair in pairs]) - OFFSET

# Only what is near the refracted epipolar curve, within the depths of the scene, can be right.
distances = refract.refractiveEpipolarDistance(points1, points2, *cameras, R, T, whichImage=1, depthRange=DEPTH)[0].ravel()
near = np.abs(distances) < SEARCH           # False for NaN

# All points, and R of camera 2 within what it may have turned; the rest stays. Wrong matches are left out.
turn = sum(len(camera.parameterNames()) for camera in cameras)
known = np.zeros((turn + 6, turn + 6))
known[turn:turn + 3, turn:turn + 3] = MAY_TURN**2*np.eye(3)
result = refract.refractiveBundleAdjustExtended(
    [[points1[near]], [points2[near]]], cameras, [], [one, R], [zero, T], None, None, None, None,
    flags=refract.GLASS_FIX_NORMAL | refract.GLASS_ROBUST, rigCovariance=known)
rms, Rs, covariance, inliers = result[0], result[1], result[7], result[10]
turned = np.degrees(cv2.Rodrigues(Rs[1] @ R.T)[0].ravel())
std = np.degrees(np.sqrt(np.diag(covariance)[turn:turn + 3] + (TOGETHER/cameras[1].lensParameters().ravel()[0])**2))

print(f"{near.sum()} of {len(near)} matches are near their curves, {np.count_nonzero(inliers[0])} agree; {rms:.3f} px RMS")
for axis, found, sigma, true in zip("xyz", turned, std, -np.degrees(BUMP)):
    print(f"camera 2 turned about {axis} by {found:7.4f} +- {sigma:.4f} degrees (true: {true:.4f})")
