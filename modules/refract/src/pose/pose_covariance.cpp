// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/pose_covariance.hpp"
#include "arrays/arrays.hpp"
#include "math/covariance_matrix.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

Mat readCameraCovariance(InputArray covariance_, const Camera& camera, const String& name)
{
    const Mat given = covariance_.getMat();
    if (given.empty())
        return Mat();
    const int lens = camera.lensCount(), both = camera.parameterCount(), side = given.rows;
    if (given.channels() != 1 || given.cols != side || (side != lens && side != both))
        CV_Error_(Error::StsBadSize, ("%s is %dx%d with %d channels; it must be %dx%d (lens), %dx%d (lens and window) or empty",
                                      name.c_str(), side, given.cols, given.channels(), lens, lens, both, both));
    Mat all = Mat::zeros(both, both, CV_64F);
    given.convertTo(all(Rect(0, 0, side, side)), CV_64F);
    checkCovariance(all, name);
    return all;
}

PoseNoise readPoseNoise(double sigma, InputArray cameraCovariance, const Camera& camera)
{
    if (!(sigma >= 0) || !std::isfinite(sigma))
        CV_Error_(Error::StsOutOfRange, ("sigma is %g; it must be positive, or 0: estimated from the residuals", sigma));
    return { sigma, readCameraCovariance(cameraCovariance, camera, "cameraCovariance") };
}

Matx66d poseCovariance(const Camera& camera, const ImagePoints& points, const Pose& pose, const PoseNoise& noise)
{
    const int parameters = camera.parameterCount(), count = (int)points.pixel.size();
    const Rotation rotation(pose.rvec.val);
    SumOfSquares<6> sum;
    Mat JtK = Mat::zeros(6, parameters, CV_64F);
    std::vector<double> byPoint(6), byCamera(2*parameters);
    for (int i = 0; i < count; i++)
    {
        const Vec3d X(points.object[i]);
        Vec2d pixel;
        if (camera.projectJacobian(rotation.R*X + pose.tvec, pixel, byPoint.data(), byCamera.data()) != REFRACT_OK)
            return Matx66d::all(std::numeric_limits<double>::quiet_NaN());
        const Matx33d byRvec = rotation.derivativeOf(X);
        const Vec2d error = points.error(i, pixel[0], pixel[1]);
        for (int c = 0; c < 3 && !points.whitening.empty(); c++)
            points.whitening[i].apply(byPoint[c], byPoint[3 + c]);
        for (int c = 0; c < parameters && !points.whitening.empty(); c++)
            points.whitening[i].apply(byCamera[c], byCamera[parameters + c]);
        for (int r = 0; r < 2; r++)
        {
            const Matx13d row(&byPoint[3*r]), turned = row*byRvec;
            const double byPose[6] = { turned(0), turned(1), turned(2), row(0), row(1), row(2) };
            sum.add(error[r], byPose);
            for (int k = 0; k < 6; k++)
                for (int c = 0; c < parameters; c++)
                    JtK.at<double>(k, c) += byPose[k]*byCamera[r*parameters + c];
        }
    }
    const Matx66d inverse = inverseOfPositive(sum.curvature);
    const double freedom = points.rows() - 6;         // none: 0/0
    Matx66d covariance = (noise.sigma > 0 ? noise.sigma*noise.sigma : freedom > 0 ? sum.value/freedom
                          : std::numeric_limits<double>::quiet_NaN())*inverse;
    if (!noise.camera.empty())
    {
        const Mat G = Mat(inverse)*JtK;
        covariance += Matx66d(Mat(G*noise.camera*G.t()).ptr<double>());
    }
    return covariance;
}

Matx66d poseCovariance(const Camera& camera, const ImagePoints& points, const NearOrigin& origin, const Pose& pose,
                       const PoseNoise& noise)
{
    const Matx66d covariance = poseCovariance(camera, points, pose, noise);
    if (!origin.isMoved())
        return covariance;
    const Matx66d derivatives = origin.farByNear(pose);
    return derivatives*covariance*derivatives.t();
}

}} // namespace
