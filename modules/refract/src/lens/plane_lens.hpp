// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PLANE_LENS_HPP
#define OPENCV_REFRACT_PLANE_LENS_HPP

#include "lens/models.hpp"

namespace cv { namespace refract {

/** A lens without a vector form: a model says where in a plane (a, b) a direction is seen, and u = fx a + cx, v = fy b + cy.
One direction after the other. */
class PlaneLens : public Lens
{
public:
    void project(int n, const double* x, const double* y, const double* z, double* u, double* v,
                 uchar* status) const CV_OVERRIDE;
    void unproject(int n, const double* u, const double* v, double* x, double* y, double* z,
                   uchar* status) const CV_OVERRIDE;
    using Lens::projectJacobian;
    void projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                         const Columns& byDirection, const Columns& byParameters, uchar* status) const CV_OVERRIDE;

    int parameterCount() const CV_OVERRIDE { return 4 + (int)coefficients_.size(); }
    String model() const CV_OVERRIDE { return model_; }
    Mat cameraMatrix() const CV_OVERRIDE { return Mat(Matx33d(fx_, 0, cx_, 0, fy_, cy_, 0, 0, 1), true); }
    Mat distCoeffs() const CV_OVERRIDE { return columnOf(coefficients_); }
    std::vector<double> parameters() const CV_OVERRIDE;
    std::vector<String> parameterNames() const CV_OVERRIDE;
    Ptr<Lens> withParameters(const std::vector<double>& p) const CV_OVERRIDE { return makeLens(model_, p); }

protected:
    //! All of its coefficients are parameters.
    explicit PlaneLens(const LensSpec& spec);
    //! @param parameters fx, fy, cx, cy and those coefficients that are parameters
    PlaneLens(const String& model, const std::vector<double>& parameters);

    //! The pixel of one direction.
    uchar projectOne(const Vec3d& direction, double& u, double& v) const;
    //! Where in the plane, and its derivatives by the direction and by each coefficient; both may be null.
    virtual uchar bend(const Vec3d& direction, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const = 0;
    //! The unit direction that is seen there.
    virtual uchar unbend(const Vec2d& plane, Vec3d& direction) const = 0;
    static Mat columnOf(const std::vector<double>& values);     //!< empty if there are none
    virtual std::vector<String> coefficientNames() const { return std::vector<String>(); }

    const String model_;
    const double fx_, fy_, cx_, cy_;
    const std::vector<double> coefficients_;
};

}} // namespace

#endif // OPENCV_REFRACT_PLANE_LENS_HPP
