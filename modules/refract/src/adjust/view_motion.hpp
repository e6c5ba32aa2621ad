// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEW_MOTION_HPP
#define OPENCV_REFRACT_VIEW_MOTION_HPP

#include "adjust/block_cholesky.hpp"
#include "adjust/problem.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

//! From a view to another one that sees the same.
struct ViewEdge
{
    int from, to;
    int shared = 0;             //!< points
};

//! Which views see the same.
class ViewGraph
{
public:
    explicit ViewGraph(const Problem& problem);
    /** A spanning tree, from the views that do not move, or from any: each edge is from a view that was reached before, to the one that
    shares most points with one of these. */
    std::vector<ViewEdge> tree;
    //! Those of the tree and others: of a point's views those that follow each other.
    std::vector<ViewEdge> edges;
    //! The tree does not lead to it: it does not move, or others move with it.
    std::vector<bool> isRoot;

    /** What each view has to be corrected by, so that what edges are off by is as little as may be (least squares, by shared points):
    a path that leads back to where it came from is off, as turns do not commute. Roots stay.
    @param off of each edge: what its second view has more than it should have beside the first */
    std::vector<Vector6> corrections(const std::vector<Vector6>& off) const;

private:
    void growTree(const Problem& problem);
    void factor();
    BlockCholesky laplacian_;   //!< factored
};

/** How the views of a scene move by a step that is not small: the retraction of their poses. To first order it is a step of rvec and t.

A view turns about the middle of what it sees, so that one that is hardly tied to its points goes round them. What a step changes between
two views is small, and is made in their own frame as it has turned: from view to view along a tree, then as all edges together have it.
So where a long strip or an area bends by degrees, all that is near to each other keeps its places; straight lines of the poses would tear
it apart. Poses and steps: rvec, t; one a view. */
class ViewMotion
{
public:
    //! From where the problem is. @param graph outlives it
    ViewMotion(const Problem& problem, const ViewGraph& graph);

    std::vector<Vector6> posesAfter(const std::vector<Vector6>& steps);
    //! The inverse, to second order, where edges lead back to where they came from; else as it is.
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
    void closeEdges();
    void findTurnsAndWays();
    const ViewGraph& graph_;
    std::vector<View> views_;
    double sceneScale_;         //!< scene's units -> those of t, of middles and ways
};

}} // namespace

#endif // OPENCV_REFRACT_VIEW_MOTION_HPP
