// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GUM_TABLE_HPP
#define REFRACT_TOOLS_GUM_TABLE_HPP

#include "accept/test_points.hpp"
#include "measure/joint_error.hpp"

/* The uncertainty budget of one quantity y as the GUM writes it (JCGM 100:2008, 5.1 and annex G, EA-4/02): rows of independent
sources i with the standard uncertainty u(x_i), the sensitivity c_i = dy/dx_i and the contribution c_i u(x_i), whose squares add up
to u(y)^2; then degrees of freedom, k and U = k u(y). */
namespace tools {

struct GumRow
{
    std::string source, given;          //!< given: u(x_i) as text with its unit
    double std, sensitivity;            //!< NaN where the source is of several values that differ
    double contribution, share;         //!< share of u(y)^2
    double dof;                         //!< infinite: not from these images
    bool isOfTest = false;              //!< of the test's own: what it measures with, not what it tests

    //! u(x_i) as text; empty: it is of several values, and nobody gave them. @param unit of lengths
    std::string knownTo(const std::string& unit) const;
};

struct GumTable
{
    std::string quantity;
    double value = 0.;
    std::vector<GumRow> rows;
    double u = 0., dof = 0., k = 0., U = 0.;        //!< NaN: not known
    double testU = 0.;                  //!< of the rows that are the test's own
};

//! One more source of a quantity that is a difference to what is certified.
struct CertifiedSource
{
    std::string name, given;
    double std, sensitivity;
};

//! A quantity to first order: y = value + sum of weight*dX over points.
struct LinearQuantity
{
    std::string name;
    double value;
    std::vector<std::pair<size_t, cv::Vec3d>> weights;      //!< index of a point, dy/dX
};

LinearQuantity coordinateOf(const TestPoints& points, size_t point, int axis);
LinearQuantity distanceOf(const TestPoints& points, size_t a, size_t b);

/** From the centre of camera 1 to the plane fitted to an image's points. No weights: it has no four points on one plane, as far as
their standard deviations tell. */
LinearQuantity planeDistanceOf(const TestPoints& points, const std::string& image);

/** What the points err by, together.
The noise of a point's own pixels has the shape that its cameras give it. Where there are pixels, it has their size, or what sx, sy, sz
leave after the calibration's part, if that is more. Of points without pixels sx, sy, sz say it, and where there are none the pixel
noise again; these count as seen by all cameras whose images they are in. */
class PointErrors
{
public:
    //! @param plane on which one camera saw them; a rig needs none. Throws Failure if the points are not of this calibration
    PointErrors(const Calibration& calibration, const TestPoints& points, double pixelSigma, const std::optional<cv::Vec4d>& plane);

    //! What sx, sy, sz of some points say beside what calibration and pixels do.
    struct Stated
    {
        bool more = false;              //!< a larger noise, which is taken
        bool lessThanPixels = false;    //!< a smaller one, or none: that of the pixels is taken
        bool lessThanCalibration = false;   //!< of points without pixels, less than the calibration's part, which is added
    };
    const Stated& stated() const { return stated_; }

    GumTable table(const LinearQuantity& quantity) const;
    //! Of a difference to what is certified: with its sources.
    GumTable table(const LinearQuantity& quantity, const std::vector<CertifiedSource>& certified) const;

private:
    void requireSamePoints(const TestPoints& points, const RigPixels& pixels, const std::optional<cv::Vec4d>& plane) const;
    double noiseVariance(const TestPoint& point, size_t i);

    const Calibration& calibration_;
    double pixelSigma_;
    bool havePixels_;
    MatrixXd covariance_;
    JointError joint_;
    std::vector<double> noise_;         //!< px^2, of each point
    Stated stated_;
};

} // namespace tools

#endif // REFRACT_TOOLS_GUM_TABLE_HPP
