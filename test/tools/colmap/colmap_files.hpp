// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_COLMAP_FILES_HPP
#define REFRACT_TEST_COLMAP_FILES_HPP

#include "formats/foreign_files.hpp"

/* A small model, as COLMAP 3.12 and later write it. */

const char CAMERAS_TXT[] = R"(# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 2
1 SIMPLE_RADIAL 1024 768 1280 512 384 0.05
2 EQUIRECTANGULAR 1024 768 1024 768
)";

const char IMAGES_TXT[] = R"(# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
#   POINTS2D[] as (X, Y, POINT3D_ID)
# Number of images: 3, mean observations per image: 1
1 0.5 -0.5 0.5 0.5 0.125 -2 5.000000000000002 1 left/a.png
924.0049441902713 470.75 -1 0.5 0.5 7
2 1 0 0 0 0 0 0 2 right/a.png

3 0 0 0 0 0 0 0 1 left/b.png
10 20 7
)";

const char POINTS_TXT[] = R"(# 3D point list with one line of data per point:
#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)
7 0.25 -1.5 0.001 255 0 9 0.75 1 1 3 0
)";

const char RIGS_TXT[] = R"(# Rig calib list with one line of data per calib:
1 3 CAMERA 1 CAMERA 2 1 1 0 0 0 0.25 0 0 IMU 4 0
)";

const char FRAMES_TXT[] = R"(# Frame list with one line of data per frame:
1 1 0.5 -0.5 0.5 0.5 0.125 -2 5 2 CAMERA 1 1 CAMERA 2 2
)";

inline void saveText(const TemporaryFolder& f)
{
    saved(f, "cameras.txt", CAMERAS_TXT);
    saved(f, "images.txt", IMAGES_TXT);
    saved(f, "points3D.txt", POINTS_TXT);
    saved(f, "rigs.txt", RIGS_TXT);
    saved(f, "frames.txt", FRAMES_TXT);
}

#endif // REFRACT_TEST_COLMAP_FILES_HPP
