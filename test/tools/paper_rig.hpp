// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The paper's rig (Table 3) as the tools hold it, and a board before it.
#ifndef REFRACT_TEST_TOOLS_PAPER_RIG_HPP
#define REFRACT_TEST_TOOLS_PAPER_RIG_HPP

#include "measure/rig_vector.hpp"
#include "calibrate/rig_data.hpp"
#include "scenes.hpp"
#include <opencv2/calib3d.hpp>

//! @param cameras up to 4: those after the paper's two stand below and beside them
inline tools::RigModel paperRig(int cameras)
{
    using namespace cv;
    using namespace cv::refract;
    const Vec3d normals[] = {paper::NORMAL1, paper::NORMAL2, {0.05, 0.2, 1}, {-0.1, -0.15, 1}};
    const Vec3d rvecs[] = {{}, {0.02, 0.29, 0.01}, {0.25, -0.02, 0.02}, {-0.05, -0.3, 0.03}};
    const Vec3d tvecs[] = {{}, {-211, 1.3, 53}, {10, -170, 40}, {190, 30, 45}};
    tools::RigModel rig;
    for (int c = 0; c < cameras; c++)
    {
        Matx33d R;
        Rodrigues(rvecs[c], R);
        rig.add(RefractiveCamera::create(paper::K1, paper::D1, paper::pane(50, normals[c])), {R, tvecs[c]});
        rig.cameras.back()->setImageSize(Size(1280, 1024));
    }
    return rig;
}

inline std::vector<cv::Point3d> board(int columns, int rows, double square = 39.)
{
    std::vector<cv::Point3d> points;
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++)
            points.emplace_back(square*(column - 0.5*(columns - 1)), square*(row - 0.5*(rows - 1)), 0);
    return points;
}

//! What the rig sees of a board, with noise; points outside the images too.
inline tools::View observe(const tools::RigModel& rig, const std::vector<cv::Point3d>& object, const cv::Vec3d& rvec,
                           const cv::Vec3d& tvec, bool direct, double sigma, scenes::Random& random)
{
    tools::View view;
    view.stem = "new";
    view.objectPoints = object;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (bool glass : {false, true})
        {
            if (!glass && !direct)
                continue;
            cv::Vec3d r = rvec, t = tvec;
            tools::poseInImage(rig, c, glass, r, t);
            std::vector<cv::Point2d>& pixels = glass ? view.glass[c] : view.direct[c];
            cv::refract::refractiveProjectPoints(tools::pointsOfTarget(rig, object), r, t,
                glass ? rig.cameras[c] : tools::copyWithWindow(rig.cameras[c], cv::refract::GlassWindow()), pixels);
            for (cv::Point2d& p : pixels)
                p += cv::Point2d(random.normal(sigma), random.normal(sigma));
        }
    return view;
}

#endif // REFRACT_TEST_TOOLS_PAPER_RIG_HPP
