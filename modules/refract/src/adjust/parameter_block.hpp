// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PARAMETER_BLOCK_HPP
#define OPENCV_REFRACT_PARAMETER_BLOCK_HPP

#include "camera/camera.hpp"
#include "window/parameters.hpp"
#include <Eigen/Core>
#include <memory>

namespace ceres { class Manifold; }

namespace cv { namespace refract {

typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMajorMatrix;
typedef Eigen::Matrix<double, 6, 1> Vector6;        //!< a pose or a step of it: rvec, t

//! Parameters of the problem that belong together.
struct ParameterBlock
{
    enum Kind { LENS, PLACE, MEDIA, EXTRINSICS, TARGETS, POSE };        //!< PLACE: of a window, see window/place.hpp
    Kind kind;
    int index;                      //!< the camera (of a window: its owner); of a pose the view; 0 of TARGETS
    WindowLayout at;                //!< of the camera's window
    Eigen::Map<Eigen::VectorXd> values;     //!< kept by the problem
    std::vector<bool> isFree;       //!< per coordinate; a normal or a line is free or fixed as a whole
    std::vector<String> names;      //!< in messages
    std::vector<double> lower;      //!< bounds
    std::vector<bool> isHeld;       //!< on its bound while solving
    Eigen::VectorXd priorMean;
    Eigen::MatrixXd sqrtInformation;        //!< W, W (values - priorMean) has unit covariance; no rows: there is no prior

    //! The values are a normal or a line. On which manifold they move; null of others.
    bool isOnManifold() const;
    std::unique_ptr<ceres::Manifold> manifold() const;
    //! d values / d free coordinates; orthonormal.
    Eigen::MatrixXd tangentBasis(bool withHeld = true) const;
    //! What a coordinate of MEDIA is.
    WindowParameter windowParameter(int coordinate) const { return kindOf(at, at.media + coordinate); }

    /** Takes the part of a covariance (math/covariance_matrix.hpp) that belongs to this block as its prior. What has a variance is
    free from now on; a lens parameter with none is fixed; NaN: nothing is known, so that what all targets share is free. */
    void setPrior(const Eigen::MatrixXd& covariance);
};

//! GlassCalibrationFlags -> which lens parameters are free.
std::vector<bool> freeLens(const Camera& camera, int flags);

//! Focal lengths stay above a small part of their start.
double lowerBoundOfLens(int coordinate, double start);

}} // namespace

#endif // OPENCV_REFRACT_PARAMETER_BLOCK_HPP
