// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEW_MOTION_HPP
#define OPENCV_REFRACT_VIEW_MOTION_HPP

#include "adjust/problem.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

//! From a view to another one that sees the same.
struct ViewEdge
{
    int from, to;
};

/** A spanning tree of the views that see a point in common with others, from those that do not move, or from any: each edge is from one
that was reached before. */
std::vector<ViewEdge> treeOfViews(const Problem& problem);

/** How the views of a scene move by a step that is not small: the retraction of their poses. To first order it is a step of rvec and t.

A view turns about the middle of what it sees, so that one that is hardly tied to its points goes round them. What a step changes between
two views is small, and is made in their own frame as it has turned: from view to view along a tree. So where a long strip bends by
degrees, all that is near to each other keeps its places; straight lines of the poses would tear it apart. Poses and steps: rvec, t; one
a view. */
class ViewMotion
{
public:
    //! From where the problem is.
    ViewMotion(const Problem& problem, const std::vector<ViewEdge>& tree);

    std::vector<Vector6> posesAfter(const std::vector<Vector6>& steps);
    std::vector<Vector6> stepsTo(const std::vector<Vector6>& poses);
    //! Moves the points of a cluster in the frame of a view that sees each, as the last motion turned it. @param change to first order
    void movePoints(const Problem& problem, int cluster, const Eigen::VectorXd& change, Eigen::Ref<Eigen::VectorXd> points) const;

private:
    struct View
    {
        Rotation rotation;
        Vec3d rvec, tvec;
        Matx33d turnByRvec;     //!< R(rvec + d) = R(rvec) exp(turnByRvec d), to first order
        Vec3d middle;           //!< of the points that it sees
        // The last motion
        Vec3d turn, way;        //!< of the scene about it (a rotation vector) and of the middle, to first order
        Matx33d turned;         //!< of the scene
        Vec3d moved;            //!< the middle
    };
    std::vector<ViewEdge> tree_;
    std::vector<bool> isRoot_;
    std::vector<View> views_;
    double sceneScale_;         //!< scene's units -> those of t, of middles and ways
};

}} // namespace

#endif // OPENCV_REFRACT_VIEW_MOTION_HPP
