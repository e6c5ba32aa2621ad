// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/calibration_error.hpp"

namespace cv { namespace refract {

//! Whether the fit came to no good end; else it cannot begin, or its arguments are wrong.
static bool isOfFit(CalibrationError::Cause cause)
{
    return cause == CalibrationError::NOT_CONVERGED || cause == CalibrationError::UNDETERMINED ||
           cause == CalibrationError::POSE_UNDETERMINED || cause == CalibrationError::TOO_FEW_INLIERS;
}

CalibrationError::CalibrationError(Cause cause_, const String& err_, const String& reason_)
    : Exception(isOfFit(cause_) ? Error::StsNoConv : Error::StsBadArg, err_, String(), String(), 0),
      cause(cause_), reason(reason_), view(-1), camera(-1), point(-1) {}

CalibrationError::~CalibrationError() {}

void raise(CalibrationError error)
{
    try
    {
        CV_Error(error.code, error.err);
    }
    catch (const Exception& raised)     // a copy, without what the class adds
    {
        static_cast<Exception&>(error) = raised;
    }
    throw error;
}

}} // namespace
