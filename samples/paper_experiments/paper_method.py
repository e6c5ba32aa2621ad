# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The paper's own method, written down from its equations (numbers in brackets); nothing here calls cv::refract.

Pixels are ideal ones: the lens is undone before. The image plane stands in front of the camera, at z = f, as in (16);
(8) and (12) have it behind, which changes two signs and nothing else. As the equations need the paper's f and d in one
unit, f = 1 mm here: the ray that comes out does not depend on it.

(6) as printed turns w into n; the text below (8) needs the opposite turn (it has w1 = [-n1, -n2, n3]), and so does a
virtual camera that looks along n. That one is used.
"""
import numpy as np

F = 1.


def distortion_center(direct, refracted):
    """The point nearest to the lines through direct and refracted points (N, 2) by linear least squares: (1), (2)."""
    (u, v), (ug, vg) = direct.T, refracted.T
    lines = np.column_stack((vg - v, u - ug))
    offset = v*ug - u*vg
    length = np.linalg.norm(lines, axis=1)
    return np.linalg.lstsq(lines/length[:, None], -offset/length, rcond=None)[0]


def normal_of_center(center, K):
    """(3), made a unit vector."""
    n = np.array([(center[0] - K[0, 2])/K[0, 0], (center[1] - K[1, 2])/K[1, 1], 1])
    return n/np.linalg.norm(n)


def calibrate_normal(direct, refracted, K):
    return normal_of_center(distortion_center(direct, refracted), K)


def rotation_to_virtual_camera(n):
    """Camera -> virtual camera, which looks along the unit normal n: (4), (5), (6) as a matrix."""
    w = np.array([0., 0., 1.])
    axis = np.cross(w, n)
    sine, cosine = np.linalg.norm(axis), w @ n
    if sine == 0:
        return np.eye(3)
    x, y, z = axis/sine
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return -sine*cross + (1 - cosine)*np.outer(axis, axis)/sine**2 + cosine*np.eye(3)


def virtual_rays(pixels, K, n, thickness, index):
    """Lines L behind the window in the virtual camera: points Q3 (N, 3) and directions OQ2 (N, 3) of (14)."""
    bearings = np.column_stack(((pixels - K[:2, 2])/K[[0, 1], [0, 1]], np.ones(len(pixels))))
    q = bearings @ rotation_to_virtual_camera(n).T                                              # (6)
    q2 = F*q/q[:, 2:]                                                                           # (7), (8)
    r2 = np.linalg.norm(q2[:, :2], axis=1)
    angle = np.arctan(r2/F)                                                                     # (12), three lines
    d_w = thickness*np.sin(angle)*(1 - np.sqrt(1 - np.sin(angle)**2)/np.sqrt(index**2 - np.sin(angle)**2))
    r3 = r2 - d_w/np.cos(angle)
    q3 = np.column_stack((q2[:, :2]*(r3/r2)[:, None], np.full(len(q2), F)))                     # (13)
    return q3, q2


def measure_on_plane(pixels, K, n, thickness, index, plane):
    """Points (N, 3) of the plane w.x = plane[3], camera frame: (9) to (11), (14), (15)."""
    q3, direction = virtual_rays(pixels, K, n, thickness, index)
    to_virtual = rotation_to_virtual_camera(n)
    w1 = to_virtual @ plane[:3]
    q1 = q3 + ((plane[3] - q3 @ w1)/(direction @ w1))[:, None]*direction
    return q1 @ to_virtual                                                                      # (15)


def rays(pixels, K, n, thickness, index):
    """The lines L in the camera frame: points (N, 3) and unit directions (N, 3)."""
    q3, direction = virtual_rays(pixels, K, n, thickness, index)
    to_virtual = rotation_to_virtual_camera(n)
    return q3 @ to_virtual, direction @ to_virtual/np.linalg.norm(direction, axis=1)[:, None]


def triangulate(rays1, rays2):
    """Section 3.3 wants the two rays coplanar; with noise they are not: the middle of their gap, and the gap (N)."""
    (p1, d1), (p2, d2) = rays1, rays2
    across = np.cross(d1, d2)
    across /= np.linalg.norm(across, axis=1)[:, None]
    gap = np.sum((p2 - p1)*across, axis=1)
    # p1 + s1 d1 + gap across = p2 + s2 d2
    side1 = np.cross(d2, across)
    s1 = np.sum((p2 - p1)*side1, axis=1)/np.sum(d1*side1, axis=1)
    return p1 + s1[:, None]*d1 + (gap/2)[:, None]*across, gap
