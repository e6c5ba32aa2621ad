// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_PROBLEM_HPP
#define OPENCV_REFRACT_RIG_PROBLEM_HPP

#include "poses.hpp"
#include "residual.hpp"
#include "views.hpp"
#include <Eigen/Core>
#include <array>

namespace cv { namespace refract {

typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMajorMatrix;

//! One image of the problem.
struct RigImage
{
    int view, camera;
    bool refracted;
    ImagePoints points;
};

//! A block of parameters that the poses do not contain.
struct RigBlock
{
    enum Kind { LENS, NORMAL, MEDIA, EXTRINSICS };
    Kind kind;
    int camera;
    std::vector<double> values;
    std::vector<bool> isFree;       //!< per coordinate; a normal is free or fixed as a whole
    std::vector<double> lower;      //!< bounds
    std::vector<bool> isHeld;       //!< on its bound while solving

    //! d values / d free coordinates; orthonormal. A normal moves on the sphere.
    Eigen::MatrixXd tangentBasis() const;
    //! What a coordinate is called in messages.
    String nameOf(int coordinate) const;
};

/** The joint problem: one or two cameras, each behind its own window or both behind one, a pose (object -> camera 1) for
each view, every observed point of every image, through the window or direct. Maximum likelihood under equal isotropic
pixel noise; Ceres eliminates the poses.

The public parameters are, per camera, those of Camera::parameters(), then rvec and T of camera 2. What is free is said
by GlassCalibrationFlags. */
class RigProblem
{
public:
    RigProblem(const std::vector<Camera>& cameras, const Pose& extrinsics, const RigViews& views,
               const std::vector<Pose>& poses, int flags);

    //! Empty, or which point has no image at the start.
    String startFault() const;

    /** False if criteria.maxCount iterations did not reach the change that the criteria ask for (EPS). Throws StsBadArg that
    names a point without image at the start. */
    bool solve(const TermCriteria& criteria);

    int viewCount() const { return (int)poses_.size(); }
    bool isStereo() const { return cameras_.size() == 2; }
    const std::vector<RigImage>& images() const { return images_; }
    const std::vector<RigBlock>& blocks() const { return blocks_; }

    Camera camera(int c) const;         //!< with the current parameters
    Pose pose(int view) const;
    Pose extrinsics() const;

    int pointCount() const;
    int freeCount() const;              //!< without the poses
    double squaredError(const RigImage& image) const;
    double squaredError() const;

    //! One image's residuals and their derivatives: by its pose, and by all coordinates of the blocks that it depends on.
    struct Derivatives
    {
        std::vector<int> blocks;                    //!< indices into blocks()
        std::vector<RowMajorMatrix> byBlock;        //!< of the same
        RowMajorMatrix byPose;
        Eigen::VectorXd residuals;
    };
    Derivatives derivatives(const RigImage& image) const;

    /** d public parameters / d free coordinates of all blocks, in the order of blocks(). The window of camera 2 follows
    from the shared one. */
    Eigen::MatrixXd publicBasis() const;
    int publicCount() const;

private:
    void addBlock(RigBlock::Kind kind, int camera, const std::vector<double>& values, const std::vector<bool>& isFree);
    void addImages(const RigViews& views);
    int blockOf(RigBlock::Kind kind, int camera) const;
    std::vector<int> blocksOf(const RigImage& image) const;
    std::vector<const double*> valuesOf(const RigImage& image) const;
    ceres::CostFunction* makeCost(const RigImage& image) const;
    int publicRow(const RigBlock& block) const;
    void addSharedWindow(Eigen::MatrixXd& basis) const;
    //! A ceres::TerminationType. iterations: in the limit, out how many were made.
    int solveInside(double change, int& iterations, double& radius);
    bool holdAtBounds();            //!< true if that changes what is held

    std::vector<Camera> cameras_;       //!< lens models and numbers of layers
    bool shared_;
    std::vector<RigImage> images_;
    std::vector<RigBlock> blocks_;
    std::vector<std::array<double, 6> > poses_;
};

}} // namespace

#endif // OPENCV_REFRACT_RIG_PROBLEM_HPP
