// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/joint_error.hpp"
#include "calibrate/parameter_columns.hpp"
#include "math/dense.hpp"
#include "measure/rig_vector.hpp"
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! What a camera tells of all points.
struct CameraDerivatives
{
    PointDerivatives derivatives;
    MatrixXd R;                     //!< camera 1 -> camera
    int column, place;              //!< of its parameters; of R and T, if it is not the first
};

std::vector<CameraDerivatives> differentiateCameras(const Calibration& calibration, const std::vector<Point3d>& points)
{
    const RigModel rig = modelOf(calibration);
    std::vector<CameraDerivatives> cameras;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const RigidTransform& cam_from_cam1 = calibration.extrinsics[c];
        cameras.push_back({differentiatePoints(calibration.cameras[c].camera, points, rotationVector(cam_from_cam1.R), cam_from_cam1.t),
                           toEigen(Mat(cam_from_cam1.R)), columnsOf(rig, (int)c).lens, c ? extrinsicsColumn(rig, (int)c) : 0});
    }
    return cameras;
}

//! Directions in which a point may be: all, or those of a plane.
MatrixXd directionsOf(const std::optional<Vec4d>& plane)
{
    if (!plane)
        return MatrixXd::Identity(3, 3);
    const Eigen::RowVector3d normal((*plane)[0], (*plane)[1], (*plane)[2]);
    return SingularValues(normal).V.rightCols(2);
}

} // namespace

JointError jointErrorOf(const Calibration& calibration, const std::vector<Point3d>& points, const RigPixels& pixels,
                        const std::optional<Vec4d>& plane)
{
    const std::vector<CameraDerivatives> cameras = differentiateCameras(calibration, points);
    const int parameters = columnCount(modelOf(calibration));
    const MatrixXd B = directionsOf(plane);
    JointError result;
    for (size_t i = 0; i < points.size(); i++)
    {
        std::vector<size_t> views;
        for (size_t c = 0; c < (plane ? 1 : cameras.size()); c++)
            if (seen(pixels[c][i]))
                views.push_back(c);
        MatrixXd J = MatrixXd::Zero(2*views.size(), B.cols()), A = MatrixXd::Zero(2*views.size(), parameters);
        for (size_t k = 0; k < views.size(); k++)
        {
            const CameraDerivatives& camera = cameras[views[k]];
            const PointDerivatives& d = camera.derivatives;
            J.middleRows(2*k, 2) = product(product(d.byPose.block(2*i, 3, 2, 3), camera.R), B);
            A.block(2*k, camera.column, 2, d.byParameters.cols()) = d.byParameters.middleRows(2*i, 2);
            if (views[k] > 0)
                A.block(2*k, camera.place, 2, 6) = d.byPose.middleRows(2*i, 2);
        }
        const bool determined = J.rows() >= J.cols() && J.allFinite();
        const MatrixXd C = determined ? inverse(transposeTimes(J, J))
                                      : MatrixXd::Constant(B.cols(), B.cols(), std::numeric_limits<double>::quiet_NaN());
        result.noise.push_back(timesTranspose(product(B, C), B));
        result.byCalibration.push_back(-transposeTimes(timesTranspose(J, product(B, C)), A));
    }
    return result;
}

} // namespace tools
