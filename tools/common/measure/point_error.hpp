// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_ERROR_HPP
#define REFRACT_TOOLS_POINT_ERROR_HPP

#include "measure/eigen_matrix.hpp"
#include "measure/measurement.hpp"
#include <optional>

/* The expected error of a measured point, from pixel noise and from the calibration's covariance: one standard deviation, the root
mean square of the 3-D distance from the truth. Several cameras: triangulation by those that see the point; one camera: a point on
a plane perpendicular to the camera's axis. */
namespace tools {

//! At one range, over a grid of pixels of camera 1 that reaches the image's borders.
struct ErrorMap
{
    double range = 0.;                  //!< z in the frame of camera 1
    std::vector<cv::Point2d> pixels;    //!< row by row
    cv::Size grid;
    std::vector<double> total;          //!< NaN where a point is not seen
    std::vector<double> pixelNoise;     //!< the part that is due to pixel noise

    bool seen() const;                  //!< anything at all
    double best() const;                //!< NaN if nothing is seen
    double worst() const;
    double percentile95() const;        //!< of what is seen: the worst may be a single point at a border
    double median() const;
    double seenShare() const;           //!< of the grid
    double worstPixelNoise() const;
};

//! Sums over the points of maps that are seen: squared errors, in the two parts that add up to the total.
struct ErrorSquares
{
    double calibration = 0., pixelNoise = 0.;
    int count = 0;

    void add(const ErrorMap& map);
};

const int ERROR_MAP_COLUMNS = 25;       //!< of all maps whose worst point is reported, as it depends on the grid

/** @param columns of the grid. */
ErrorMap mapErrors(const Calibration& calibration, double range, double pixelSigma, int columns);

//! What the cameras see of the points where camera 1's rays through some pixels meet the plane z = range.
struct PointsAtRange
{
    std::vector<cv::Point3d> points;            //!< NaN: not seen by camera 1 and another one, if there is one
    RigPixels pixels;                           //!< exact; NaN where a camera does not see the point
};

//! A grid over an image, borders included.
std::vector<cv::Point2d> gridOver(cv::Size image, int columns, cv::Size& grid);

/* How several points of one calibration err together. To first order

    dX = (J^T J)^-1 J^T (du - A dp),        J: pixels by point, A: pixels by the parameters p of the rig

where the noise du of each point's pixels is its own and dp, the error of the calibration, is the same for all: a length between two
points has less of it than their covariances alone would say, or more. */

struct JointError
{
    std::vector<MatrixXd> byCalibration;    //!< dX/dp of each point, 3 rows
    std::vector<MatrixXd> noise;            //!< 3x3, covariance of each point for pixels with a standard deviation of 1
};

/** Of points seen by the cameras whose pixel is not NaN.
@param plane on which they lie, a x + b y + c z = d: camera 1 alone sees them
A point that its cameras do not determine has NaN. */
JointError jointErrorOf(const Calibration& calibration, const std::vector<cv::Point3d>& points, const RigPixels& pixels,
                        const std::optional<cv::Vec4d>& plane);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_ERROR_HPP
