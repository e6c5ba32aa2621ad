# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""A camera and a fringe projector, each behind its own window: images of fringes -> phases -> points with their covariance. The
projector is a camera that sees u of each point, and not v: (u, NaN)."""
import os

import cv2
import numpy as np
import opencv_refract as refract

DATA = os.path.join(os.path.dirname(__file__), "..", "data", "projector")
STEPS, CONTRAST, JUMP = 4, 40., 10.


def decode(first):
    """Phase, amplitude and noise of I_k = A + B cos(phase - 2 pi k/4)."""
    images = []
    for k in range(first, first + STEPS):
        image = cv2.imread(os.path.join(DATA, "fringes", f"scene_{k}.jpg"), cv2.IMREAD_GRAYSCALE)
        assert image is not None, f"cannot read image {k}"
        images.append(image.astype(float))
    step = np.arange(STEPS)
    wave = np.tensordot(np.exp(2j*np.pi*step/STEPS), np.array(images), 1)
    contradiction = np.tensordot((-1.)**step, np.array(images), 1)             # neither A nor B has a part in it
    return np.angle(wave), 2*np.abs(wave)/STEPS, contradiction.std()/np.sqrt(STEPS)


def distance_rms(points, covariances=None):
    """From the nearer of the scene's planes; with covariances over what they state."""
    distances, sigmas = [], []
    for shape in (scene.at(i) for i in range(scene.size())):
        vector = [np.array([shape.getNode(key).at(i).real() for i in range(3)]) for key in ("point", "normal")]
        normal = vector[1]/np.linalg.norm(vector[1])
        distances.append((points - vector[0]) @ normal)
        sigmas.append(np.sqrt(normal @ covariances.reshape(-1, 3, 3) @ normal) if covariances is not None else np.ones(len(points)))
    nearest = np.abs(distances).argmin(axis=0)[None]
    ratio = np.take_along_axis(np.array(distances), nearest, 0)/np.take_along_axis(np.array(sigmas), nearest, 0)
    return np.sqrt(np.nanmean(ratio**2))


rig = os.path.join(DATA, "rig.yml")
file = refract.FileStorage(rig, refract.FILE_STORAGE_READ)
device, scene = file.getNode("emitters").getNode("projector"), file.getNode("scene")
camera, projector = refract.RefractiveCamera.read(rig), refract.RefractiveCamera.read(device)
rvec, T = (np.array([device.getNode(key).at(i).real() for i in range(3)]) for key in ("rvec", "tvec"))
periods = [device.getNode("fringes").getNode("periods").at(i).real() for i in range(2)]

(coarse, _, _), (fine, amplitude, noise) = decode(1), decode(1 + STEPS)
part, whole = fine % (2*np.pi)*periods[1]/(2*np.pi), coarse % (2*np.pi)*periods[0]/(2*np.pi)
u = part + periods[1]*np.round((whole - part)/periods[1])
u[amplitude < CONTRAST] = -1e3                                     # in shadow
around = np.ones((5, 5))
even = cv2.dilate(u, around) - cv2.erode(u, around) < JUMP          # at an edge a pixel sees two surfaces
y, x = np.nonzero(even & (amplitude >= CONTRAST))
seen, halves = np.column_stack((x, y)).astype(float), np.column_stack((u[y, x], np.full(len(x), np.nan)))

# Of camera pixels the position is known; of u the variance is that of the phase. uu, uv, vv.
variance = (periods[1]/(2*np.pi))**2*2*noise**2/(STEPS*amplitude[y, x]**2)
exact = np.tile((1e-6, 0., 1e-6), (len(x), 1))
covariances = [exact, np.column_stack((variance, np.zeros(len(x)), np.ones(len(x))))]

Rs, Ts = [np.eye(3), cv2.Rodrigues(rvec)[0]], [np.zeros(3), T]
points, status, point_covariances, _ = refract.triangulateRefractiveExtended(
    [camera, projector], Rs, Ts, [seen, halves], 0, 1., None, pixelCovariances=covariances)

# Beside it: windows forgotten, all of them or that of the projector only, as if its sheets were planes.
bare, bare_projector = (refract.RefractiveCamera.create(c.cameraMatrix(), c.distCoeffs()) for c in (camera, projector))
ignored, half = (refract.triangulateRefractive(cameras, Rs, Ts, [seen, halves])[0].reshape(-1, 3)
                 for cameras in ([bare, bare_projector], [camera, bare_projector]))
points = points.reshape(-1, 3)
print(f"{len(points)} points; RMS distance from the surfaces: windows ignored {distance_rms(ignored):.2f}, the projector's ignored "
      f"{distance_rms(half):.2f}, corrected {distance_rms(points):.3f} mm, {distance_rms(points, point_covariances):.2f} times the "
      "stated uncertainty")
