// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"

// The maps for cv::remap.

using namespace cv::refract;
using namespace fuzz;

void fuzz::tryInput(Bytes& bytes)
{
    const int most = bytes.rarely() ? 700 : 40;
    cv::Size size(bytes.below(most), bytes.below(most));
    if (bytes.rarely())
        size = cv::Size(bytes.below(3) - 2, bytes.below(3) - 1);
    static const int types[] = {CV_32FC1, CV_32FC2, CV_16SC2, 0, -1, CV_64FC1, CV_8UC1, CV_16UC1};
    const int type = types[bytes.rarely() ? bytes.below(8) : bytes.below(3)];
    const int numbers = bytes.below(5);
    const Input depth = Input::matrix(bytes, numbers, 1, [&](int i, int) {
        return numbers < 4 || i == 3 ? bytes.about(100, 2000) : i == 2 ? bytes.about(0.5, 1.) : bytes.about(-0.5, 0.5); });
    const Input R = bytes.maybe() ? rotation(bytes, 0.3) : Input();
    const Input P = bytes.maybe() ? Input::matrix(bytes, 3, bytes.maybe() ? 3 : 4, [&](int r, int c) {
        return c == 2 ? r == 2 ? 1. : bytes.about(0, 1000) : r == c ? bytes.about(300, 2000) : 0.; }) : Input();
    Output map1(bytes, 2), map2(bytes, 2);
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        initRefractiveUndistortRectifyMap(lens.cameraMatrix, lens.distCoeffs, lens.window, depth, R, P, size, type, map1, map2);
    }
    else
        initRefractiveUndistortRectifyMap(cameraOf(bytes), depth, R, P, size, type, map1, map2);
    for (const cv::Mat& map : {map1.mat(), map2.mat()})
    {
        promise(map.empty() || (int)map.total() == size.area(), "a map has the size that was asked for");
        if (map.depth() == CV_32F)
            promise(countNaN(map, 0, map.rows) == 0, "a map holds no NaN");
    }
}
