// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* What the long forms of calibrations take and return, before anything is set. */

#include "precomp.hpp"

namespace cv { namespace refract {

static TermCriteria usualCriteria() { return TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12); }

GlassRigOptions::GlassRigOptions(int flags_) : flags(flags_), criteria(usualCriteria()), computeCovariance(true) {}
GlassRigResult::GlassRigResult() : rms(0), pixelStd(0), degreesOfFreedom(0) {}

BundleAdjustOptions::BundleAdjustOptions(int flags_)
    : flags(flags_), criteria(usualCriteria()), lengthScaleStd(0), computePointDeviations(true), computeViewCovariances(true),
      covarianceMemory(0)
{
}
BundleAdjustResult::BundleAdjustResult() : rms(0), pixelStd(0), degreesOfFreedom(0) {}

}} // namespace
