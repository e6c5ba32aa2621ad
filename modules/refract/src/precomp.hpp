// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PRECOMP_HPP
#define OPENCV_REFRACT_PRECOMP_HPP

#include "opencv2/refract.hpp"
#if CV_VERSION_MAJOR < 5
#include "opencv2/calib3d.hpp"
#else
#include "opencv2/geometry.hpp"     // the parts of calib3d that are used here
#include "opencv2/stereo.hpp"
#endif

#ifdef __OPENCV_BUILD
#include "opencv2/core/private.hpp"
#else
// OpenCV does not install private.hpp; the trace macro behind CV_INSTRUMENT_REGION is public.
#include "opencv2/core/utils/trace.hpp"
#define CV_INSTRUMENT_REGION() CV_TRACE_FUNCTION()
#endif

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#endif // OPENCV_REFRACT_PRECOMP_HPP
