// The paper's rig (Table 3) as the tools hold it, and a board before it.
#ifndef REFRACT_TEST_TOOLS_PAPER_RIG_HPP
#define REFRACT_TEST_TOOLS_PAPER_RIG_HPP

#include "assess/view_derivatives.hpp"
#include "calibrate/rig_data.hpp"
#include "scenes.hpp"
#include <opencv2/calib3d.hpp>

inline tools::RigModel paperRig(int cameras)
{
    using namespace cv;
    using namespace cv::refract;
    const Matx33d K(2438.07, 0, 643.98, 0, 2438.08, 500.01, 0, 0, 1);
    const Mat dist = (Mat_<double>(1, 4) << -0.4082, 0.4359, 0, 0);
    const Vec3d normals[2] = {Vec3d(-0.2483, 0.0961, 1), Vec3d(0.1823, -0.2809, 1)};
    tools::RigModel rig;
    for (int c = 0; c < cameras; c++)
    {
        rig.cameras.push_back(RefractiveCamera::create(Mat(K), dist, GlassWindow(normals[c], 20., 1.5437, 50.)));
        rig.cameras.back()->setImageSize(Size(1280, 1024));
    }
    Rodrigues(Vec3d(0.02, 0.29, 0.01), rig.R);
    rig.T = Vec3d(-211, 1.3, 53);
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
inline tools::Moment observe(const tools::RigModel& rig, const std::vector<cv::Point3d>& object, const cv::Vec3d& rvec,
                             const cv::Vec3d& tvec, bool direct, double sigma, scenes::Random& random)
{
    tools::Moment moment;
    moment.stem = "new";
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (bool glass : {false, true})
        {
            if (!glass && !direct)
                continue;
            cv::Vec3d r = rvec, t = tvec;
            tools::poseInCamera(rig, c, r, t);
            std::vector<cv::Point2d>& pixels = glass ? moment.glass[c] : moment.direct[c];
            cv::refract::refractiveProjectPoints(object, r, t,
                glass ? rig.cameras[c] : tools::copyWithWindow(rig.cameras[c], cv::refract::GlassWindow()), pixels);
            for (cv::Point2d& p : pixels)
                p += cv::Point2d(random.normal(sigma), random.normal(sigma));
        }
    return moment;
}

#endif // REFRACT_TEST_TOOLS_PAPER_RIG_HPP
