#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0
"""Beside COLMAP: how far a floor in water is bent by pinholes, and by refract_bundle.

    bench/peers/run.sh [FOLDER]

makes what this needs (pycolmap in an environment of its own) and calls it. refract_simulate renders a textured, flat floor behind a flat
port in water, pycolmap reconstructs it with pinholes, refract_bundle starts from that. Both are held against the floor, which is flat:
sag is how far its middle is above its border. The same behind a dome."""

import csv
import os
import resource
import subprocess
import sys

import numpy as np
import pycolmap

TOOLS, FOLDER = sys.argv[1], sys.argv[2]
WIDTH, HEIGHT, FOCAL = 800, 600, 800.
NORMAL = np.array([0.05, -0.03, 1.])/np.linalg.norm([0.05, -0.03, 1.])
# of each window: as it is, as well as a ruler and a data sheet know it, and what the focal length seems to be
WINDOWS = {
    "flat port": ({"normal": NORMAL, "distance": 40., "thickness": [10.], "index": [1.49]},
                  {"normal": NORMAL, "distance": 41., "thickness": [10.], "index": [1.491]}, 1.33),
    "dome": ({"shape": "dome", "center": [3., -2., 4.], "radius": 50., "thickness": [6.], "index": [1.49]},
             {"shape": "dome", "center": [0., 0., 0.], "radius": 50., "thickness": [6.], "index": [1.491]}, 1.)}
WATER = 1.333
FLOOR, STEP_X, STEP_Y = 700., 110., 90.         # mm: how far it is, from image to image
POINTS = 600                                    # that most images show: for minutes in place of hours
GRID = 4                                        # images a side: refract_simulate has 16 cameras


def rotation(rvec):
    angle = np.linalg.norm(rvec)
    if angle == 0:
        return np.eye(3)
    x, y, z = rvec/angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle)*K + (1 - np.cos(angle))*K @ K


def camera_text(window, indent=""):
    def value(x):
        return x if isinstance(x, str) else f"{x:.17g}" if np.isscalar(x) else "[ " + ", ".join(f"{y:.17g}" for y in x) + " ]"

    glass = "".join(f"{name}: {value(x)}, " for name, x in window.items())
    matrix = f"[ {FOCAL}, 0., {(WIDTH - 1)/2}, 0., {FOCAL}, {(HEIGHT - 1)/2}, 0., 0., 1. ]"
    lines = [f"image_width: {WIDTH}", f"image_height: {HEIGHT}",
             f"camera_matrix: !!opencv-matrix {{ rows: 3, cols: 3, dt: d, data: {matrix} }}",
             "distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.1, 0.03, 0., 0. ] }",
             f"glass_window: {{ {glass}inner_index: 1, outer_index: {WATER} }}"]
    return "".join(indent + line + "\n" for line in lines)


def cameras():
    """Camera 1 -> each: the rig's frame is the first one's."""
    random = np.random.default_rng(5)
    places = []
    for i in range(GRID*GRID):
        turn = random.normal(0, 0.08, 3) if i else np.zeros(3)
        centre = np.array([STEP_X*(i % GRID), STEP_Y*(i//GRID), 0.]) + (random.normal(0, 12, 3) if i else 0)
        R = rotation(turn)
        places.append((R, centre))
    return places


def matrix_text(name, M):
    data = ", ".join(f"{x:.17g}" for x in np.ravel(M))
    return f"{name}: !!opencv-matrix {{ rows: 3, cols: {np.size(M)//3}, dt: d, data: [ {data} ] }}\n"


def render(window, places):
    if os.path.exists(f"images/{len(places):02d}.png"):
        return                      # of the last time
    text = "%YAML:1.0\n---\n"
    for i, (R, centre) in enumerate(places):
        text += f"camera{i + 1}:\n" + camera_text(window, "   ")
        if i:
            name = "" if i == 1 else str(i + 1)
            text += matrix_text("R" + name, R) + matrix_text("T" + name, -R @ centre)
    text += (f"scene:\n   - {{ shape: plane, point: [ 0., 0., {FLOOR} ], normal: [ 0., 0., -1. ] }}\n"
             "texture: { size: 60., contrast: 0.9, octaves: 6 }\n"
             "exposure: { dark: 35., light: 205., background: 110., blur: 0.7, noise: 2., vignetting: 0.2 }\n"
             "seed: 3\nsets:\n   water: { window: 1, scene: 1 }\n")
    write("rig.yml", text)
    run("refract_simulate", "rig.yml", "--out-dir=rendered", "--quiet")
    os.makedirs("images", exist_ok=True)
    for i in range(len(places)):
        os.replace(f"rendered/water{i + 1}/scene.png", f"images/{i + 1:02d}.png")


def write(name, text):
    with open(name, "w", encoding="ascii") as file:
        file.write(text)


def run(tool, *arguments):
    """Processor seconds; what the tool says goes on."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([os.path.join(TOOLS, tool), *arguments], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def reconstruct(magnification):
    reader = pycolmap.ImageReaderOptions(camera_model="OPENCV",
                                         camera_params=f"{magnification*FOCAL},{magnification*FOCAL},"
                                                       f"{WIDTH/2},{HEIGHT/2},0,0,0,0")
    features = pycolmap.FeatureExtractionOptions()
    features.sift.max_num_features = 1200
    if os.path.exists("database.db"):
        os.remove("database.db")
    pycolmap.extract_features("database.db", "images", camera_mode=pycolmap.CameraMode.SINGLE, reader_options=reader,
                              extraction_options=features)
    pycolmap.match_exhaustive("database.db")
    os.makedirs("sparse", exist_ok=True)
    models = pycolmap.incremental_mapping("database.db", "images", "sparse")
    model = max(models.values(), key=lambda one: one.num_reg_images())
    keep = sorted(model.points3D, key=lambda i: -model.points3D[i].track.length())[:POINTS]
    for i in set(model.points3D) - set(keep):
        model.delete_point3D(i)
    os.makedirs("pinholes", exist_ok=True)
    model.write_binary("pinholes")
    return model


def similarity(a, b):
    """s, R, t of b = s R a + t."""
    ma, mb = a.mean(0), b.mean(0)
    U, w, V = np.linalg.svd((b - mb).T @ (a - ma))
    S = np.diag([1, 1, np.sign(np.linalg.det(U @ V))])
    R = U @ S @ V
    s = np.trace(np.diag(w) @ S)/((a - ma)**2).sum()
    return s, R, mb - s*R @ ma


def sag(points):
    """Of a floor that lies across z: its middle against its border, by a paraboloid through all points, and that border."""
    middle = np.median(points, 0)
    x, y, z = (points - middle).T
    r = np.quantile(np.hypot(x, y), 0.95)
    good = np.ones(len(x), bool)
    for _ in range(5):
        A = np.c_[np.ones_like(x), x, y, x*x + y*y]
        p = np.linalg.lstsq(A[good], z[good], rcond=None)[0]
        off = np.abs(z - A @ p)
        good = off < 4*1.4826*np.median(off[good])
    return -p[3]*r*r, r, np.sqrt(np.mean((z - A @ p)[good]**2))


def bent_floor(name):
    window, thought, magnification = WINDOWS[name]
    places = cameras()
    render(window, places)
    model = reconstruct(magnification)
    write("positions.csv", "image,x,y,z,std\n" + "".join(
        f"{i + 1:02d}.png,{c[0]:.6f},{c[1]:.6f},{c[2]:.6f},0.5\n" for i, (_, c) in enumerate(places)))
    images = [image for image in model.images.values() if image.has_pose]
    s, R, t = similarity(np.array([image.projection_center() for image in images]),
                         np.array([places[int(image.name[:2]) - 1][1] for image in images]))
    pinholes = np.array([s*R @ point.xyz + t for point in model.points3D.values()])
    write("calib.yml", "%YAML:1.0\n---\n" + camera_text(thought))
    run("refract_bundle", "calib.yml", "--colmap=pinholes", "--positions=positions.csv", "--out=again.yml", "--colmap-out=refracted",
        "--points-out=points.csv", "--summary=summary.json", "--unit=mm")
    with open("points.csv", encoding="ascii") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "0"]
    ours = np.array([[float(row[c]) for c in "xyz"] for row in rows])
    sz = np.array([float(row["sz"]) for row in rows])
    by_pinholes, _, rest = sag(pinholes)
    by_us, radius, our_rest = sag(ours)
    border = np.hypot(*(ours - np.median(ours, 0))[:, :2].T) > 0.8*radius
    print(f"\n{name}: floor of {2*radius:.0f} mm at {FLOOR:.0f} mm, {len(images)} images, {len(pinholes)} points (mm)\n"
          "                        sag   beside it, RMS   off the true floor, RMS")
    for by, points, value, left in (("pinholes in water", pinholes, by_pinholes, rest), ("refract_bundle", ours, by_us, our_rest)):
        print(f"  {by:18s}{value:9.3f}{left:17.2f}{np.sqrt(np.mean((points[:, 2] - FLOOR)**2)):26.2f}")
    print(f"refract_bundle states +- {np.median(sz[border]):.2f} of a point at the border; all points' error over stated, RMS: "
          f"{np.sqrt(np.mean(((ours[:, 2] - FLOOR)/sz)**2)):.2f}")
    run("refract_undistort", "again.yml", "--colmap=refracted", "--image-dir=images", "--out-dir=dense")


def readers_agree():
    """What COLMAP reads of ours, and we of COLMAP's, as text and as bytes."""
    ours = pycolmap.Reconstruction("refracted")
    for folder, form in (("as_text", "write_text"), ("as_bytes", "write_binary")):
        os.makedirs(folder, exist_ok=True)
        getattr(ours, form)(folder)
        run("refract_bundle", "again.yml", f"--colmap={folder}", "--positions=positions.csv", "--free=none", f"--out={folder}.yml",
            f"--points-out={folder}.csv", "--quiet")
    with open("as_text.csv", encoding="ascii") as a, open("as_bytes.csv", encoding="ascii") as b:
        same = a.read() == b.read()
    dense = pycolmap.Reconstruction("dense/sparse")
    dense.update_point_3d_errors()
    errors = [point.error for point in dense.points3D.values()]
    print(f"\nCOLMAP reads our model: {ours.num_reg_images()} images, {ours.num_points3D()} points, {ours.compute_num_observations()} "
          f"observations; what it writes of it as text and as bytes gives {'the same' if same else 'NOT the same'} points here")
    print(f"COLMAP's own error of the images without a window, median over points: {np.median(errors):.2f} px")


def main():
    pycolmap.logging.minloglevel = 2
    for name in WINDOWS:
        folder = os.path.join(FOLDER, name.replace(" ", "_"))
        os.makedirs(folder, exist_ok=True)
        os.chdir(folder)
        bent_floor(name)
        readers_agree()


if __name__ == "__main__":
    main()
