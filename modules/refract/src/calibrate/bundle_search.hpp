// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_SEARCH_HPP
#define OPENCV_REFRACT_BUNDLE_SEARCH_HPP

#include "adjust/joint_fit.hpp"

namespace cv { namespace refract {

/** From a start of cameras, views and points to the least of the minima that points have beside the right one. What is not decided is not
in use then. Where views turn and hardly move, also from points at one distance.
@param another as fit */
FitOutcome searchBundle(Problem& problem, const SceneOutliers& outliers, JointFit& fit, JointFit& another);
/** The same with outliers. Before they are known, they turn windows of which images tell little, and what is left out then follows. So the
fit is made again where a window has turned, with the windows where the start has them until outliers are known, and the better one kept.
@param another as fit */
FitOutcome searchRobustBundle(Problem& problem, const SceneOutliers& outliers, JointFit& fit, JointFit& another);

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_SEARCH_HPP
