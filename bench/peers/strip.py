#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0
"""Beside COLMAP: what an iteration of bundle adjustment costs, on one network without a window, with as many threads.

    bench/peers/run.sh [FOLDER]

calls it. A camera moves along a strip of a floor, as in refract_bench --surveys; poses and points begin beside the truth. The lens is
known to both. COLMAP's seconds are those of its solver, ours those that the library says of its own (OPENCV_LOG_LEVEL=INFO); both without
files and covariances."""

import os
import re
import subprocess
import sys
import time

import numpy as np
import pycolmap

from bent_floor import rotation, matrix_text

TOOLS, FOLDER = sys.argv[1], sys.argv[2]
WIDTH, HEIGHT, FOCAL = 1280, 1024, 1200.
RANGE, STEP, ACROSS, RELIEF = 1500., 110., 1000., 150.      # mm
PER_VIEW = 200                                              # new points
THREADS = 2


def quaternion(R):
    """w, x, y, z of a small rotation."""
    w = np.sqrt(1 + np.trace(R))/2
    return np.array([w, (R[2, 1] - R[1, 2])/(4*w), (R[0, 2] - R[2, 0])/(4*w), (R[1, 0] - R[0, 1])/(4*w)])


def write_network(views):
    """COLMAP's text, and two points with their distance.
    @return observations"""
    random = np.random.default_rng(views)
    count = PER_VIEW*views
    points = np.c_[(STEP*views + 700)*np.sort(random.random(count)) - 350, ACROSS*(random.random(count) - 0.5),
                   RELIEF*(random.random(count) - 0.5)]
    tracks, images = [[] for _ in range(count)], []
    for view in range(views):
        R, centre = rotation(random.normal(0, 0.05, 3)), np.array([STEP*view, 0, -RANGE]) + random.normal(0, 30, 3)
        near = np.flatnonzero(np.abs(points[:, 0] - STEP*view) < 1100)
        X = (points[near] - centre) @ R.T
        pixels = FOCAL*X[:, :2]/X[:, 2:] + [WIDTH/2, HEIGHT/2] + random.normal(0, 0.3, (len(near), 2))
        inside = ((pixels > 0) & (pixels < [WIDTH, HEIGHT])).all(1)
        for k, point in enumerate(near[inside]):
            tracks[point].append((view + 1, k))
        off = rotation(random.normal(0, 0.005, 3)) @ R if view else R
        where = centre + (random.normal(0, 10, 3) if view else 0)
        images.append((quaternion(off), -off @ where, pixels[inside], near[inside]))
    usable = {i for i, track in enumerate(tracks) if len(track) >= 3}
    os.makedirs("network", exist_ok=True)
    with open("network/cameras.txt", "w", encoding="ascii") as file:
        file.write(f"1 PINHOLE {WIDTH} {HEIGHT} {FOCAL} {FOCAL} {WIDTH/2} {HEIGHT/2}\n")
    with open("network/images.txt", "w", encoding="ascii") as file:
        for i, (q, t, pixels, ids) in enumerate(images):
            file.write(f"{i + 1} {' '.join(map(repr, map(float, q)))} {' '.join(map(repr, map(float, t)))} 1 {i + 1:05d}.png\n")
            file.write(" ".join(f"{u:.6f} {v:.6f} {p + 1 if p in usable else -1}" for (u, v), p in zip(pixels, ids)) + "\n")
    with open("network/points3D.txt", "w", encoding="ascii") as file:
        for i in sorted(usable):
            x, y, z = points[i] + random.normal(0, 5, 3)
            file.write(f"{i + 1} {x:.6f} {y:.6f} {z:.6f} 0 0 0 0 " + " ".join(f"{a} {b}" for a, b in tracks[i]) + "\n")
    a, b = [i for i in sorted(usable) if tracks[i][0][0] == 1][:2]
    with open("network.csv", "w", encoding="ascii") as file:
        file.write(f"id1,id2,length,std\n{a + 1},{b + 1},{np.linalg.norm(points[a] - points[b]):.6f},0.1\n")
    return sum(len(tracks[i]) for i in usable)


def theirs():
    """Iterations, seconds by the clock."""
    model = pycolmap.Reconstruction("network")
    options = pycolmap.BundleAdjustmentOptions(refine_focal_length=False, refine_principal_point=False, refine_extra_params=False,
                                               print_summary=False)
    options.ceres.solver_options.num_threads = THREADS
    config = pycolmap.BundleAdjustmentConfig()
    for image in model.images:
        config.add_image(image)
    config.fix_gauge(pycolmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    adjuster = pycolmap.create_default_bundle_adjuster(options, config, model)
    begin = time.perf_counter()
    summary = adjuster.solve()
    return int(re.search(r"terations: (\d+)", summary.brief_report()).group(1)), time.perf_counter() - begin


def ours():
    matrix = matrix_text("camera_matrix", np.array([[FOCAL, 0, (WIDTH - 1)/2], [0, FOCAL, (HEIGHT - 1)/2], [0, 0, 1]]))
    with open("air.yml", "w", encoding="ascii") as file:
        file.write(f"%YAML:1.0\n---\nimage_width: {WIDTH}\nimage_height: {HEIGHT}\n{matrix}"
                   "distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ 0., 0., 0., 0. ] }\n")
    done = subprocess.run([os.path.join(TOOLS, "refract_bundle"), "air.yml", "--no-window", "--free=none", "--colmap=network",
                           "--lengths=network.csv", "--no-robust", "--out=again.yml", "--quiet"], check=True, capture_output=True,
                          encoding="utf-8", env=dict(os.environ, OPENCV_LOG_LEVEL="INFO", OPENCV_FOR_THREADS_NUM=str(THREADS)))
    fits = re.findall(r"refract: (\d+) iterations of (\d+) equations in ([0-9.e+-]+) s", done.stdout + done.stderr)
    largest = max(fits, key=lambda fit: int(fit[1]))
    return int(largest[0]), float(largest[2])


def main():
    os.makedirs(FOLDER, exist_ok=True)
    os.chdir(FOLDER)
    pycolmap.logging.minloglevel = 2
    print(f"\nadjusting a strip without a window, {THREADS} threads, seconds by the clock\n"
          " views   pixels   pycolmap: iterations   s   s each   ours: iterations   s   s each   each: ours over pycolmap")
    for views in (20, 100, 300):
        pixels = write_network(views)
        (n, s), (own_n, own_s) = theirs(), ours()
        print(f"{views:6d} {pixels:8d} {n:22d} {s:5.1f} {s/n:7.3f} {own_n:18d} {own_s:5.1f} {own_s/own_n:7.3f} "
              f"{own_s/own_n/(s/n):20.2f}", flush=True)


if __name__ == "__main__":
    main()
