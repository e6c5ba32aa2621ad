// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_VECTOR_HPP
#define REFRACT_TOOLS_RIG_VECTOR_HPP

#include "calibrate/rig_model.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include <Eigen/Core>
#include <opencv2/refract.hpp>

/* All numbers of a rig in one vector: lenses, windows, R (as rotation vectors) and T, as Fit::covariance. */
namespace tools {

int rigVectorSize(const RigModel& rig);

//! With the errors of the targets at its end, as Fit::withTargets.
VectorXd toVector(const RigModel& rig);

//! The same with these errors only if the rig has columns for them.
VectorXd parametersOf(const RigModel& rig);

//! The other way, whether or not windows are shared; normals get length 1.
void setParameters(RigModel& rig, const VectorXd& parameters);

//! The rig with all these numbers; cameras that look through another one's window get it from there.
RigModel withVector(const RigModel& rig, const VectorXd& numbers);

//! How withVector changes numbers that depend on others: the normal's length, a shared window. Derivatives, at the rig.
MatrixXd consistentChanges(const RigModel& rig);

/* The information in one view of the target, taken or only planned, about a calibrated rig, to first order:

    pixels = predicted + byParameters dp + byPose dpose,      p = the parameters of Fit::withTargets

The pose of the board is unknown, so that only the part of byParameters that no change of the pose can produce gives information. */

//! How the pixels of points move, u, v of each point; NaN where there is none.
struct PointDerivatives
{
    Eigen::MatrixXd byPose;             //!< rvec, tvec
    Eigen::MatrixXd byParameters;       //!< of lens and window
};

PointDerivatives differentiatePoints(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                     const std::vector<cv::Point3d>& points, const cv::Vec3d& rvec, const cv::Vec3d& tvec);

//! One image of a view: which camera, through its window or not, and the target's points in it.
struct ImageOfView
{
    int camera;
    bool glass;
    std::vector<int> points;            //!< indices into the target's points
};

//! Of one image, which depends on few parameters.
struct ImageDerivatives
{
    Eigen::VectorXd predicted;          //!< u, v of each point
    std::vector<int> columns;           //!< parameters that it depends on, as ViewDerivatives has them
    Eigen::MatrixXd byParameters;       //!< by these
    Eigen::MatrixXd byPose;             //!< rvec, tvec of board -> camera 1
};

ImageDerivatives differentiateImage(const RigModel& rig, const std::vector<cv::Point3d>& objectPoints, const cv::Vec3d& rvec,
                                    const cv::Vec3d& tvec, const ImageOfView& image);

struct ViewDerivatives
{
    Eigen::VectorXd predicted;          //!< u, v of each point, image by image
    Eigen::MatrixXd byParameters;
    Eigen::MatrixXd byPose;             //!< rvec, tvec of board -> camera 1
};

//! Points without an image are an error of the caller's: see pointsInImage.
ViewDerivatives differentiateView(const RigModel& rig, const std::vector<cv::Point3d>& objectPoints, const cv::Vec3d& rvec,
                                  const cv::Vec3d& tvec, const std::vector<ImageOfView>& images);

//! The points that a camera sees of a board at a pose.
ImageOfView pointsInImage(const RigModel& rig, const std::vector<cv::Point3d>& objectPoints, const cv::Vec3d& rvec,
                          const cv::Vec3d& tvec, int camera, bool glass);

//! Projects the rows of a view to the left null space of byPose: Q^T rows, Q an orthonormal basis of it.
class PoseNullSpace
{
public:
    explicit PoseNullSpace(const Eigen::MatrixXd& byPose);
    Eigen::MatrixXd operator()(const Eigen::MatrixXd& rows) const;

private:
    cv::refract::QR qr_;
    Eigen::Index columns_;
};

/** The covariance of the parameters when a view has been added.
@param byParameters free of the pose.
@param sigma of a pixel coordinate. */
Eigen::MatrixXd covarianceWith(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& byParameters, double sigma);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_VECTOR_HPP
