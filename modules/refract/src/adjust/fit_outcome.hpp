// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FIT_OUTCOME_HPP
#define OPENCV_REFRACT_FIT_OUTCOME_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** How a fit ended. Nothing below the public functions throws because of what the data say: they make a CalibrationError of this
(calibrate/failure.hpp). */
struct FitOutcome
{
    enum Status
    {
        CONVERGED,
        MAX_ITERATIONS,         //!< count: so many; isStuck; point and view: one that touches the window of the camera
        NO_IMAGE,               //!< the point of the view has none in the camera at the start
        LOOKS_AWAY,             //!< the camera does not see the shared window's outside; point: its normal
        BEYOND_WINDOW,          //!< the camera lies behind the shared window; distance
        NO_POSE,                //!< of the view; count: points of its best image
        TOO_FEW_EQUATIONS,      //!< count equations for expected unknowns
        NO_SCALE,               //!< nothing that is left tells it
        TOO_FEW_INLIERS,        //!< count of expected observations fit
        UNDETERMINED,           //!< parameters
        POSE_UNDETERMINED       //!< of the view, by a scene's points
    };
    //! A parameter that takes part in what is not determined.
    struct Parameter
    {
        String name;
        double value, sigma;    //!< NaN: not a number of its own, or not known
    };

    Status status = CONVERGED;
    int view = -1, camera = -1, pointIndex = -1;
    bool refracted = false;
    Point3d point;
    double distance = 0;
    uchar imageStatus = REFRACT_OK;         //!< RefractiveStatus
    int count = 0, expected = 0;
    std::vector<Parameter> parameters;
    bool isStuck = false;                   //!< more iterations would not help
    double varianceFactor = 1;              //!< of a robust fit's variance: what the cut at its outliers takes away
    double opticalThickness = 0;            //!< of thickness and index that only show together; 0: they are no such
    int dimension = 0;                      //!< of what is undetermined

    FitOutcome() {}
    explicit FitOutcome(Status s) : status(s) {}
    bool converged() const { return status == CONVERGED; }
    //! An answer, whether at a minimum or not.
    bool isUsable() const { return status == CONVERGED || status == MAX_ITERATIONS; }
};

}} // namespace

#endif // OPENCV_REFRACT_FIT_OUTCOME_HPP
