# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Has a camera of a rig turned since its calibration, and how far? From one pair of images of any scene, without a board.

    turned_camera.py [BUMP]         # degrees about x by which camera 2 of the calibration is turned first (0.1): something to find
"""
import os
import sys

import cv2
import numpy as np
import opencv_refract as refract

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "scene")
DEPTHS = 430., 1250.            # of the scene: z in the frame of camera 1
CLEARLY = 0.8                   # more alike than all others, as Lowe has it
SEARCH = 6.                     # px from the epipolar curve: what a camera may have turned
MAY_TURN = np.radians(0.3)      # one standard deviation
OFFSET = 0.25                   # px, by which SIFT is off that doubles the image with cv::resize: all but with enable_precise_upscale


def features(folder):
    image = cv2.imread(os.path.join(DATA, folder, "scene.jpg"), cv2.IMREAD_GRAYSCALE)
    assert image is not None
    keys, descriptors = cv2.SIFT.create(4000).detectAndCompute(image, None)
    return np.array([key.pt for key in keys]) - OFFSET, descriptors


def turned(rvec, R, T):
    """A camera that turns about its own centre."""
    turn = cv2.Rodrigues(np.asarray(rvec, float))[0]
    return turn @ R, turn @ T


def covariance_of_turn(R, T, std, step=1e-3):
    """Of R, as a rotation vector, and T: one standard deviation of a turn about each axis. T turns with R."""
    def place(rvec):
        R_there, T_there = turned(rvec, R, T)
        return np.concatenate((cv2.Rodrigues(R_there)[0], T_there)).ravel()
    by_turn = np.array([place(rvec) - place(-rvec) for rvec in step*np.eye(3)]).T*std/(2*step)
    return by_turn @ by_turn.T


bump = float(sys.argv[1]) if len(sys.argv) > 1 else 0.1
cameras, Rs, Ts = refract.readRig(os.path.join(DATA, "truth.yml"))
before, T = turned((np.radians(bump), 0, 0), Rs[1], Ts[1])

# Pairs of features that are alike, clearly before all others; half of them may be wrong.
(left, descriptors1), (right, descriptors2) = features("glass1"), features("glass2")
alike = [two[0] for two in cv2.BFMatcher(cv2.NORM_L2).knnMatch(descriptors1, descriptors2, 2) if two[0].distance < CLEARLY*two[1].distance]
left, right = left[[m.queryIdx for m in alike]], right[[m.trainIdx for m in alike]]

# Only what is near the refracted epipolar curve, within the depths of the scene, can be right.
distances = refract.refractiveEpipolarDistance(left, right, cameras[0], cameras[1], before, T, depthRange=DEPTHS)[0].ravel()
near = np.abs(distances) < SEARCH               # false for nan

# All points, and R and T of camera 2 within what it may have turned; the rest stays. Wrong matches are left out.
place = sum(len(camera.parameterNames()) for camera in cameras)
known = np.zeros((place + 6, place + 6))
known[place:, place:] = covariance_of_turn(before, T, MAY_TURN)
options = refract.BundleAdjustOptions(refract.GLASS_FIX_NORMAL | refract.GLASS_ROBUST, rigCovariance=known)
result, Rs, *_ = refract.refractiveBundleAdjustExtended([[left[near]], [right[near]]], cameras, [], [Rs[0], before], [Ts[0], T], None,
                                                        None, None, None, options)
R = Rs[1]

print(f"{near.sum()} of {len(alike)} matches are near their curves, {np.count_nonzero(result.inliers[0])} agree; {result.rms:.3f} px RMS")
angles = np.degrees(cv2.Rodrigues(R @ before.T)[0]).ravel()
stds = np.degrees(np.sqrt(np.diag(result.covariance)[place:place + 3]))
for axis, angle, std, true in zip("xyz", angles, stds, (-bump, 0, 0)):
    print(f"camera 2 turned about {axis} by {angle:7.4f} +- {std:.4f} degrees (true: {true:.4f})")
    assert abs(angle - true) < 4*std
