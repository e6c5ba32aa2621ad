# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The parts of aquacal.sh: writes a scenario of aquacal as refract_calib takes it, runs aquacal on it, compares both with the truth."""
import json
import os
import resource
import subprocess
import sys

import cv2
import numpy as np
from aquacal.core.board import BoardGeometry
from aquacal.datasets import create_scenario
from aquacal.datasets.pipelines import calibrate_synthetic
from aquacal.datasets.synthetic import generate_synthetic_detections

MM = 1000.


def detections_of(scenario, seed):
    return generate_synthetic_detections(
        intrinsics=scenario.intrinsics, extrinsics=scenario.extrinsics, water_zs=scenario.water_zs,
        board=BoardGeometry(scenario.board_config), board_poses=scenario.board_poses, noise_std=scenario.noise_std,
        seed=seed, n_air=scenario.n_air, n_water=scenario.n_water)


def write(name, seed, folder):
    """A points.csv and a lens of each camera, and refract_calib's options; lengths in mm."""
    os.makedirs(folder)
    scenario = create_scenario(name, seed=seed)
    detections = detections_of(scenario, seed)
    corners = BoardGeometry(scenario.board_config).corner_positions
    options = ['--unpaired', '--exact', '--shared-window', f'--outer-index={scenario.n_water}']
    for number, camera in enumerate(scenario.intrinsics, 1):
        lens = scenario.intrinsics[camera]
        suffix = '' if number == 1 else str(number)
        with open(f'{folder}/{camera}.csv', 'w') as table:
            table.write('view,x,y,z,u,v\n')
            for frame, of_frame in sorted(detections.frames.items()):
                seen = of_frame.detections.get(camera)
                if seen is None:
                    continue
                for corner, (u, v) in zip(seen.corner_ids, seen.corners_2d):
                    x, y, z = MM*np.asarray(corners[int(corner)])
                    table.write(f'{frame:03d},{x:.6f},{y:.6f},{z:.6f},{u:.9g},{v:.9g}\n')
        with open(f'{folder}/{camera}.json', 'w') as file:
            json.dump({'K': lens.K.tolist(), 'D': np.ravel(lens.dist_coeffs).tolist(), 'image_width': lens.image_size[0],
                       'image_height': lens.image_size[1]}, file)
        options += [f'--glass{suffix}={folder}/{camera}.csv', f'--camera{suffix}={folder}/{camera}.json']
    options.append('--image-size={}x{}'.format(*lens.image_size))
    with open(f'{folder}/options', 'w') as file:
        file.write('\n'.join(options))


def time(path, *command):
    """Runs a command; the processor time that it took goes into a file."""
    code = subprocess.run(command).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(path, 'w') as file:
        file.write(str(used.ru_utime + used.ru_stime))
    sys.exit(code)


def solve(name, seed, folder):
    """aquacal, the lenses held at the truth."""
    scenario = create_scenario(name, seed=seed)
    before = resource.getrusage(resource.RUSAGE_SELF)
    result, _ = calibrate_synthetic(scenario, n_water=scenario.n_water, refine_intrinsics=False, seed=seed, normal_fixed=False)
    after = resource.getrusage(resource.RUSAGE_SELF)
    cameras = {camera: {'R': c.extrinsics.R.tolist(), 'T': (MM*np.ravel(c.extrinsics.t)).tolist(), 'surface': MM*float(c.water_z)}
               for camera, c in result.cameras.items()}
    with open(f'{folder}/aquacal.json', 'w') as file:
        json.dump(cameras, file)
    with open(f'{folder}/aquacal.time', 'w') as file:
        file.write(str(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime))


def refract_cameras(scenario, folder):
    """calib.yml, R and T from the first camera; the surface's distance from it."""
    storage = cv2.FileStorage(f'{folder}/calib.yml', cv2.FILE_STORAGE_READ)
    cameras = {}
    for number, camera in enumerate(scenario.extrinsics, 1):
        suffix = '' if number == 2 else str(number)
        R = np.eye(3) if number == 1 else storage.getNode('R' + suffix).mat()
        T = np.zeros(3) if number == 1 else storage.getNode('T' + suffix).mat().ravel()
        cameras[camera] = {'R': R, 'T': T}
    cameras[next(iter(cameras))]['surface'] = storage.getNode('camera1').getNode('glass_window').getNode('distance').real()
    return cameras


def compare(name, seed, folder, who):
    scenario = create_scenario(name, seed=seed)
    if who == 'refract' and not os.path.exists(f'{folder}/calib.yml'):
        print(f'| {name} | refract_calib | no answer | | | |', flush=True)
        return
    if who == 'aquacal':
        with open(f'{folder}/aquacal.json') as file:
            cameras = json.load(file)
    else:
        cameras = refract_cameras(scenario, folder)
    first = next(iter(scenario.extrinsics))
    rotations, centres = [], []
    R1, T1 = np.asarray(cameras[first]['R']), np.asarray(cameras[first]['T'])
    for camera, true in scenario.extrinsics.items():
        R = np.asarray(cameras[camera]['R']) @ R1.T
        T = np.asarray(cameras[camera]['T']) - R @ T1
        true_R = true.R @ scenario.extrinsics[first].R.T
        true_T = MM*(np.ravel(true.t) - true_R @ np.ravel(scenario.extrinsics[first].t))
        rotations.append(np.degrees(np.linalg.norm(cv2.Rodrigues(R @ true_R.T)[0])))
        centres.append(np.linalg.norm(R.T @ T - true_R.T @ true_T))
    surface = abs(cameras[first]['surface'] - MM*scenario.water_zs[first])
    with open(f'{folder}/{who}.time') as file:
        seconds = float(file.read())
    ratio = ''
    if who == 'aquacal' and os.path.exists(f'{folder}/refract.time'):
        with open(f'{folder}/refract.time') as file:
            ratio = f' ({seconds/float(file.read()):.3g} x)'
    label = 'refract_calib' if who == 'refract' else 'aquacal'
    print(f'| {name} | {label} | {max(rotations):.3g} | {max(centres):.3g} | {surface:.3g} | {seconds:.3g}{ratio} |', flush=True)


if __name__ == '__main__':
    command, arguments = sys.argv[1], sys.argv[2:]
    if command == 'time':
        time(*arguments)
    else:
        {'write': write, 'solve': solve, 'compare': compare}[command](arguments[0], int(arguments[1]), *arguments[2:])
