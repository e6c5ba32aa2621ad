# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What the paper prints: Sensors 2024, 24(1), 66, doi 10.3390/s24010066, section 4 and 5.2. Millimetres and pixels."""
import numpy as np

IMAGE_SIZE = 1280, 1024
THICKNESS, INDEX = 20., 1.5437
COLUMNS, ROWS, SPACING = 6, 5, 39.
BOARD_DISTANCE = 610.
BASELINE_STATED = 205.

# Table 3. The row of the focal lengths is headed "/mm" there; they are pixels (12.5 mm lens).
K1 = np.array([[2438.07, 0, 643.98], [0, 2438.08, 500.01], [0, 0, 1]])
K2 = np.array([[2443.13, 0, 647.83], [0, 2443.13, 487.49], [0, 0, 1]])
D1 = np.array([-0.4082, 0.4359, 0, 0, 0])
D2 = np.array([-0.4100, 0.4389, 0, 0, 0])
M_R = np.array([[0.9572, 0.0008, -0.2893], [-0.0087, 0.9996, -0.0262], [0.2892, 0.0275, 0.9569]])
M_T = np.array([-211.4756, 1.3306, 53.3775])

# Name, camera (0 left, 1 right), normal, distortion centre (None: not printed).
ATTITUDE_1 = "attitude 1", 0, (0.1268, -0.0284, 1), (953.07, 432.1)
ATTITUDE_2 = "attitude 2", 0, (-0.2262, -0.0431, 1), (92.2, 395.81)
TABLE_3_LEFT = "Table 3, left", 0, (-0.2483, 0.0961, 1), (38.21, 735.40)
TABLE_3_RIGHT = "Table 3, right", 1, (0.1823, -0.2809, 1), (1092.19, -196.90)
POSITION_2_LEFT = "position 2, left", 0, (-0.1181, -0.2283, 1), None
POSITION_2_RIGHT = "position 2, right", 1, (0.0063, -0.2396, 1), None

# Figure 10: smallest and largest deviation of the image points; Figure 13: RMSE and largest error of the positions on
# the plane, before and after correction.
DEVIATION = (0.5, 9.2), (2.3, 12.1)
POSITION_BEFORE, POSITION_BEFORE_MAX = (1.3441, 1.9937), (2.2707, 3.1139)
POSITION_AFTER, POSITION_AFTER_MAX = (0.1135, 0.1484), (0.2428, 0.3394)

# Tables 1 and 2: (real value, pinhole model, refraction model, error before, error after) of each segment, and the RMSE
# that the text states for each experiment (before, after).
SEGMENTS = "L1", "L2", "L3", "R1", "R2", "R3"
TABLE_1 = (
    ((156.6668, 158.5312, 156.8691, 1.8645, 0.2023), (194.8575, 197.1360, 195.0896, 2.2785, 0.2321),
     (249.9980, 252.8859, 250.2325, 2.8978, 0.2445), (155.6221, 157.3648, 155.6632, 1.7427, 0.0411),
     (194.9240, 197.2314, 195.1439, 2.3074, 0.2199), (249.0547, 251.9907, 249.3145, 2.9360, 0.2598)),
    ((156.5188, 158.2746, 156.4472, 1.7558, 0.0716), (194.7974, 197.1148, 195.0683, 2.3175, 0.2710),
     (249.9564, 252.8827, 250.1399, 2.9263, 0.1835), (155.7484, 157.6053, 155.9255, 1.8569, 0.1770),
     (194.8289, 197.1602, 195.0612, 2.3313, 0.2323), (249.9526, 252.9136, 250.2288, 2.9610, 0.2762)))
TABLE_1_RMSE = (2.3821, 0.2130), (2.4037, 0.2136)
TABLE_2 = (
    ((156.0000, 158.5312, 156.8691, 2.5312, 0.8691), (195.0000, 197.1360, 195.0896, 2.1360, 0.0896),
     (249.7218, 252.8859, 250.2325, 3.1641, 0.5107), (156.0000, 157.3648, 155.6632, 1.3648, 0.3368),
     (195.0000, 197.2314, 195.1439, 2.2314, 0.1439), (249.7218, 251.9907, 249.3145, 2.2689, 0.4073)),
    ((156.0000, 158.2746, 156.4472, 2.2746, 0.4472), (195.0000, 197.1148, 195.0683, 2.1148, 0.0683),
     (249.7218, 252.8827, 250.1399, 3.1609, 0.4181), (156.0000, 157.6053, 155.9255, 1.6053, 0.0745),
     (195.0000, 197.1602, 195.0612, 2.1602, 0.0612), (249.7218, 252.9136, 250.2288, 3.1918, 0.5070)))
TABLE_2_RMSE = (2.2827, 0.3929), (2.4179, 0.2627)

# Figure 17, matching error: without glass, position 1, position 2. Figure 18: depth and position before, after.
MATCHING_WITHOUT, MATCHING_1, MATCHING_2 = 0.2343, 11.1107, 0.7573
DEPTH_BEFORE, DEPTH_AFTER = 2.9902, 0.3187
POSITION_3D_BEFORE, POSITION_3D_AFTER = 3.5661, 0.3465

# Table 4: unit normal without pollution, with pollution A, with pollution B; cosine similarity of the last two.
TABLE_4 = {
    "left": (((-0.0500, -0.0475, 0.9976), (-0.0478, -0.0466, 0.9973), (-0.0475, -0.0463, 0.9977)),
             (0.9999972, 0.9999961)),
    "right": (((-0.0036, -0.0235, 1.0000), (-0.0040, -0.0238, 0.9998), (-0.0043, -0.0212, 1.0006)),
              (0.9999999, 0.9999972))}
