#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0
"""What better hardware or more images gain on the bundled rig: renders it so, calibrates, and prints one line for each.

    doc/gains.py [DIRECTORY_OF_THE_PROGRAMS]        build/release/bin if not said; five minutes
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RIG = (ROOT/"samples/data/stereo/rig.yml").read_text(encoding="utf-8")


def replaced(rig, pattern, by, times=1):
    changed, count = re.subn(pattern, by, rig)
    if count != times:
        sys.exit(f"samples/data/stereo/rig.yml has '{pattern}' {count} times, not {times}")
    return changed


def without_wedge(rig):
    return replaced(rig, r"      wedge: .*\n", "", 2)


def without_motion(rig):
    return replaced(rig, r", motion: \{.*?\} \}", " }")


def with_ranges(rig):
    return replaced(rig, r"(pair: \{ count: 6, distance: )\[ 540\., 680\. \]", r"\1[ 520., 1100. ]")


def with_images(rig):
    """Ten boards more, through the window only."""
    more = "   more: { count: 10, distance: [ 540., 680. ], tilt_deg: [ 5., 30. ], roll_deg: 20., margin: 20. }\n"
    rig = replaced(rig, r"(?m)^(?=   z600_:)", more)
    return replaced(rig, r"(glass: \{ window: 1, poses: \[ pair) \]", r"\1, more ]")


FLAT, MOUNT = ["--wedge-std=0.02"], ["--placement-std=0.001"]
CASES = [
    ("as bundled: 6 pairs, 540 to 680 mm", lambda rig: rig, []),
    ("pairs from 520 to 1100 mm", with_ranges, []),
    ("10 images more, through the window only", with_images, []),
    ("a fixed mount: nothing moves between the two images of a pair", without_motion, MOUNT),
    ("optical flats: faces parallel within 1 arc second", without_wedge, FLAT),
    ("optical flats and a fixed mount", lambda rig: without_motion(without_wedge(rig)), FLAT + MOUNT),
]


def angle(a, b):
    """Degrees, to the last digit of small ones too."""
    cross = [a[i - 2]*b[i - 1] - a[i - 1]*b[i - 2] for i in range(3)]
    return math.degrees(math.atan2(math.hypot(*cross), sum(x*y for x, y in zip(a, b))))


def calibrate(programs, rig, options):
    """The summary of a calibration of the rig's rendered images."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path/"rig.yml").write_text(rig, encoding="utf-8")
        subprocess.run([programs/"refract_simulate", path/"rig.yml", f"--out-dir={path}", "--quiet"], check=True)
        subprocess.run([programs/"refract_calib", "--pattern=chessboard", "--size=6x5", "--square=39", "--square-std=0.002",
                        "--thickness=20", "--index=1.5437", f"--direct={path}/direct1/*", f"--glass={path}/glass1/*",
                        f"--direct={path}/direct2/*", f"--glass={path}/glass2/*", f"--out={path}/calib.yml",
                        f"--summary={path}/summary.json", "--no-cross-validation", "--quiet", *options], check=True,
                       stdout=subprocess.DEVNULL)
        return json.loads((path/"summary.json").read_text(encoding="utf-8"))


def main():
    programs = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT/"build/release/bin").resolve()
    truth = [[float(x) for x in found.split(",")] for found in re.findall(r"normal: \[(.*?)\]", RIG)]
    print("case: normals +- (stated) / off, degrees; worst point of the working volume +- mm, the square known to 0.002 %")
    for name, change, options in CASES:
        summary = calibrate(programs, change(RIG), options)
        windows = [camera["window"] for camera in summary["cameras"]]
        stated = max(max(window["normal_std_deg"]) for window in windows)
        off = max(angle(window["normal"], normal) for window, normal in zip(windows, truth))
        worst = max(row["worst"] for row in summary["point_error"] if row["worst"] and row["z"] < 1200)
        print(f"{name}: {stated:.3f} / {off:.3f}; {worst:.3f}", flush=True)


if __name__ == "__main__":
    main()
