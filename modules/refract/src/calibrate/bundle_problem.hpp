// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_PROBLEM_HPP
#define OPENCV_REFRACT_BUNDLE_PROBLEM_HPP

#include "calibrate/rig_problem.hpp"

namespace cv { namespace refract {

//! A distance of two scene points that is known with a standard deviation.
struct KnownLength
{
    int a, b;
    double length, sigma;
};

//! One point in one image: which of the image's points it is.
struct Sighting
{
    int image, row;
    int at;                             //!< where the point stands in its cluster
};

/** Points that known lengths tie together, the two ends of a wand for example, or one point alone. They are eliminated
together. */
struct Cluster
{
    std::vector<int> points;            //!< indices into the scene
    std::vector<KnownLength> lengths;   //!< a and b count within the cluster
    std::vector<Sighting> sightings;
    Eigen::Map<Eigen::VectorXd> values; //!< x, y, z of each point, kept by the problem

    int size() const { return (int)values.size(); }
    //! Length minus the known one, in its standard deviations, and its derivatives by values.
    double residual(const KnownLength& length, Eigen::RowVectorXd& byValues) const;
};

/** The joint problem without a target: RigProblem's cameras and poses, whose views are of one scene that is not known. Points
are in use or not; those in use have sightings in at least two images. */
class BundleProblem : private ceres::EvaluationCallback
{
public:
    //! @param pixels per camera, per view: one per scene point, or none
    BundleProblem(const Rig& rig, const std::vector<PixelViews>& pixels, int pointCount, const std::vector<Pose>& poses,
                  const std::vector<PoseKnowledge>& known, const std::vector<KnownLength>& lengths, int flags);
    BundleProblem(const BundleProblem&) = delete;
    BundleProblem& operator=(const BundleProblem&) = delete;

    RigProblem& rig() { return rig_; }
    const RigProblem& rig() const { return rig_; }

    /** Which points are in use, and where they are. What is not in use has no weight in any image.
    @param points NaN: not in use
    @param isInlier per image, per point of it: 0 is left out; empty: all are used */
    void setPoints(const std::vector<Point3d>& points, const std::vector<std::vector<uchar> >& isInlier);
    std::vector<Point3d> points() const;    //!< of the whole scene; NaN: not in use
    const std::vector<Cluster>& clusters() const { return clusters_; }
    //! Of a point in use: its cluster, and where it stands there; -1: not in use.
    int clusterOf(int point) const { return clusterOf_[point]; }
    int placeInCluster(int point) const { return at_[point]; }
    //! What setPoints() said, where a point is in use.
    bool isInlier(int image, int row) const { return isInlier_[image][row] != 0; }

    //! As RigProblem::solve().
    bool solve(const TermCriteria& criteria);

    int lengthCount() const;                //!< between points in use
    int equationCount() const;
    int freedom() const;
    double squaredError() const;            //!< weighted; of images, lengths and what is known of poses
    //! Whether poses or lengths are weighed against the pixels' noise.
    bool hasPriors() const { return rig_.hasPriors() || lengthCount() > 0; }

    /** Residuals and derivatives of all images at the current values, and of the points' places in the scene's frame.
    False where a point has no image. */
    bool evaluate(bool wantsDerivatives);
    /** Derivatives as if every observation of a point in use had a weight of one, also those that are left out, but for those
    without an image.
    @param hasImage per image, per point of it: 0 for what has no derivatives */
    void evaluateAll(std::vector<std::vector<uchar> >& hasImage);
    struct ImageState
    {
        RigProblem::Derivatives derivatives;
        RowMajorMatrix byPoint;             //!< rows as derivatives.residuals, 3 columns
        bool isPossible;
    };
    const ImageState& state(int image) const { return states_[image]; }

private:
    void PrepareForEvaluation(bool wantsDerivatives, bool isNewPoint) override;
    void solveInside(TrustRegion& region);
    bool isAtMinimum();

    RigProblem rig_;
    const int pointCount_;
    const std::vector<KnownLength> lengths_;
    std::vector<double> values_;            //!< of all clusters, one after the other
    std::vector<Cluster> clusters_;
    std::vector<int> clusterOf_, at_;       //!< per point
    std::vector<std::vector<uchar> > isInlier_;
    std::vector<ImageState> states_;
    bool hasDerivatives_;
};

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_PROBLEM_HPP
