// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COVARIANCE_HPP
#define OPENCV_REFRACT_COVARIANCE_HPP

#include "adjust/outer_covariance.hpp"

namespace cv { namespace refract {

const int REQUIRE_ALL = GLASS_REQUIRE_WINDOW | GLASS_REQUIRE_INTRINSICS | GLASS_REQUIRE_EXTRINSICS;

//! What the data can and cannot tell of a solved problem.
struct Covariance
{
    /** UNDETERMINED, with the parameters' names, if the data do not determine what is free; POSE_UNDETERMINED.
    @param variance of a pixel coordinate
    @param required what must be determined by itself, GLASS_REQUIRE_...; of the rest it is enough that combinations are */
    FitOutcome compute(const Problem& problem, double variance, int required);

    /** Wider where a free distance, or a dome's centre, is known less well than its derivatives say (distance_profile.hpp). @param problem
    it was computed of; stays as it is */
    void widen(Problem& problem);

    //! Memory that those of poses and points take.
    size_t bytes() const;
    //! Which is given back: those of poses are NaN then, those of points are for known cameras and poses. Parameters have theirs.
    void forgetPoses();

    Eigen::MatrixXd ofParameters;       //!< of the public parameters, P x P; 0 where fixed
    Mat ofPoints();                     //!< deviations of a scene's points, one row each; NaN: not in use, infinite: undetermined
    std::vector<Mat> ofPoses();         //!< of a scene's views (rvec, tvec): 6x6; 0: known exactly, NaN: without an image

private:
    void setParameters();
    void invertPoses();
    const Problem* problem_ = nullptr;
    double variance_ = 0;
    Information information_;
    enum { FACTORED, INVERTED, FORGOTTEN } poses_ = FACTORED;
    OuterCovariance outer_;             //!< for unit pixel noise
    int cameras_ = 0;                   //!< its first columns: the parameters of cameras and targets
};

}} // namespace

#endif // OPENCV_REFRACT_COVARIANCE_HPP
