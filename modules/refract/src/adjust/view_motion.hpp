// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEW_MOTION_HPP
#define OPENCV_REFRACT_VIEW_MOTION_HPP

#include "adjust/problem.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

typedef Eigen::Matrix<double, 6, 1> Vector6;

//! From a view to another one that sees the same.
struct ViewEdge
{
    int from, to;
};

/** A spanning tree of the views that see a point in common with others, from those that do not move, or from any: each edge is from one
that was reached before. */
std::vector<ViewEdge> treeOfViews(const Problem& problem);

/** How the views of a scene move by a step that is not small: the retraction of their poses. To first order it is a step of rvec and t.

A view turns about the middle of what it sees, so that one that is hardly tied to its points goes round them. Middles keep their places
to each other, turned by half of what either view turns: where a long strip bends by degrees, base lines and points bend with it, while
straight lines of the poses would stretch what is between them. Poses and steps: rvec, t; one a view. */
class ViewMotion
{
public:
    //! From where the problem is.
    ViewMotion(const Problem& problem, const std::vector<ViewEdge>& tree);

    std::vector<Vector6> posesAfter(const std::vector<Vector6>& steps);
    std::vector<Vector6> stepsTo(const std::vector<Vector6>& poses);
    //! Takes the points of a cluster along with a view that sees each, by what of the last motion is above first order.
    void bendPoints(const Problem& problem, int cluster, Eigen::Ref<Eigen::VectorXd> points) const;

private:
    struct View
    {
        Rotation rotation;
        Vec3d rvec, tvec;
        Matx33d turnByRvec;     //!< R(rvec + d) = R(rvec) exp(turnByRvec d), to first order
        Vec3d middle;           //!< of the points that it sees
        Matx33d after;          //!< R' of the last motion
        Matx33d bend;           //!< of its rotation about the middle, above first order
        Vec3d excess;           //!< of the middle's way, above first order
    };
    void turn(const std::vector<Vec3d>& turns);
    std::vector<ViewEdge> tree_;
    std::vector<View> views_;
    double sceneScale_;         //!< scene's units -> those of t, of middles and ways
};

}} // namespace

#endif // OPENCV_REFRACT_VIEW_MOTION_HPP
