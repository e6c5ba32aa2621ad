// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SPLINE_SURFACE_HPP
#define OPENCV_REFRACT_SPLINE_SURFACE_HPP

#include "precomp.hpp"
#include "lens/spline_model.hpp"

namespace cv { namespace refract {

//! Control points over the stereographic plane, and the degrees across that they are for.
struct SplineGrid
{
    int order, nx, ny;
    double fovX;
};

//! The surface and its domain. What lenses that differ in fx, fy, cx, cy have in common.
class SplineSurface
{
public:
    SplineSurface(const SplineGrid& grid, const std::vector<double>& controls);
    const SplineGrid& grid() const { return grid_; }
    Mat controls() const { return Mat(2*grid_.nx*grid_.ny, 1, CV_64F, (void*)controls_.data()).clone(); }
    //! For the vector code; it points into this surface.
    SplineModel model(double fx, double fy, double cx, double cy) const;

    //! A point of the stereographic plane -> where it is seen, and by how much that moves; null: not asked for.
    Vec2d at(const Vec2d& p, Matx22d* slope) const;
    bool inRectangle(const Vec2d& p) const { return std::abs(p[0]) <= edge_[0] && std::abs(p[1]) <= edge_[1]; }
    bool inDomain(const Vec2d& p, const Matx22d& slope) const;
    //! In the domain whatever the slope is.
    bool inDomain(const Vec2d& p) const { return isMonotone_ || domain_(cellAt(p)) == CERTAIN; }
    //! The control points that a point of the plane needs, row by row, and what they weigh.
    void weigh(const Vec2d& p, int* which, double* weights) const;
    //! The point that is seen there; false if there is none.
    bool invert(const Vec2d& seen, Vec2d& p) const;

private:
    //! Where a search may begin: a point of the stereographic plane and where it is seen.
    struct Start { Vec2d at, seen; };

    enum { OUTSIDE, INSIDE, CERTAIN = CERTAIN_CELL };      // of the domain; CERTAIN: as far as the control points tell of all of the cell

    Vec2d gridAt(const Vec2d& p) const
    {
        return Vec2d(splineCoordinate(p[0], perUnit_, grid_.nx), splineCoordinate(p[1], perUnit_, grid_.ny));
    }
    template<int ORDER> void weigh(const Vec2d& g, int* which, double* weights) const;
    template<int ORDER, bool WITH_SLOPE> Vec2d added(const Vec2d& g, Vec2d& byX, Vec2d& byY) const;
    Vec2d intoRectangle(const Vec2d& p) const;
    Point cellAt(const Vec2d& p) const;
    bool isMonotone(const Rect& controls) const;
    void findDomain();
    void markCertain();
    bool search(const Vec2d& target, Vec2d& p) const;

    const SplineGrid grid_;
    std::vector<double> controls_;      //!< and two more numbers, see SplineModel
    const double perUnit_;
    const Vec2d edge_;          //!< the rectangle in the stereographic plane, about 0
    const bool isMonotone_;     //!< all of it is the domain
    Mat1b domain_;              //!< else what each of its cells is
    std::vector<Start> starts_;
};

}} // namespace

#endif // OPENCV_REFRACT_SPLINE_SURFACE_HPP
