// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEW_MOTION_HPP
#define OPENCV_REFRACT_VIEW_MOTION_HPP

#include "adjust/problem.hpp"

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
straight lines of the poses would stretch what is between them. */
class ViewMotion
{
public:
    //! From where the problem is.
    ViewMotion(const Problem& problem, const std::vector<ViewEdge>& tree);

    //! First: by how much the rvec of each view changes.
    void turn(const std::vector<Vec3d>& turns);
    //! The pose of a view after a step, rvec and tvec, of which the turn was said; and the step to a pose.
    Vector6 poseAfter(int view, const Vector6& step) const;
    Vector6 stepTo(int view, const Vector6& pose) const;
    //! Takes the points of a cluster along with a view that sees each, by what is above first order.
    void bendPoints(const Problem& problem, int cluster, Eigen::Ref<Eigen::VectorXd> points) const;

private:
    struct View
    {
        Vec3d rvec, tvec;
        Vec3d middle;           //!< of the points that it sees
        Matx33d bend;           //!< of the rotation about it, above first order, in the scene
        Vec3d way;              //!< of the middle, above first order
    };
    std::vector<ViewEdge> tree_;
    std::vector<View> views_;
};

}} // namespace

#endif // OPENCV_REFRACT_VIEW_MOTION_HPP
