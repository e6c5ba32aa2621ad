// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_PROBLEM_HPP
#define OPENCV_REFRACT_RIG_PROBLEM_HPP

#include "calibrate/residual.hpp"
#include "window/parameters.hpp"
#include <ceres/evaluation_callback.h>
#include <ceres/types.h>

namespace ceres { class Problem; }

namespace cv { namespace refract {

struct TrustRegion;

typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMajorMatrix;
typedef Eigen::Matrix<double, 6, 1> Vector6;

//! The cameras: lens and window of each, and where they are.
struct Rig
{
    std::vector<Camera> cameras;
    std::vector<int> owner;             //!< the first camera that looks through the same window, whose frame describes it
    std::vector<Pose> extrinsics;       //!< camera 1 -> camera; the first is the identity

    int count() const { return (int)cameras.size(); }
    bool owns(int c) const { return owner[c] == c; }
};

//! What is known of a view's pose from outside.
struct PoseKnowledge
{
    enum Kind { UNKNOWN, EXACT, UNCERTAIN };
    Kind kind = UNKNOWN;
    Matrix6 inverseRoot;                //!< W, W^T W = inverse of the covariance; UNCERTAIN only
};

/** What an earlier step knows of a camera's parameters, in the order of Camera::parameters(): lens, or lens and window. A
parameter with a variance is estimated, within it. A lens parameter with none is exact; NaN or empty: nothing is known. */
struct CameraKnowledge
{
    Eigen::MatrixXd covariance;
};

//! One image of the problem.
struct RigImage
{
    int view, camera;
    bool refracted;
    ImagePoints points;
    std::vector<double> rootWeights;    //!< one per point; 0: left out

    int usedCount() const { return (int)std::count_if(rootWeights.begin(), rootWeights.end(),
                                                      [](double w) { return w > 0; }); }
};

//! A block of parameters that the poses do not contain.
struct RigBlock
{
    enum Kind { LENS, NORMAL, MEDIA, EXTRINSICS };
    Kind kind;
    int camera;                     //!< of a window: its owner
    WindowLayout at;                //!< of the camera's window
    Eigen::Map<Eigen::VectorXd> values;     //!< kept by the problem
    std::vector<bool> isFree;       //!< per coordinate; a normal is free or fixed as a whole
    std::vector<String> names;      //!< in messages
    std::vector<double> lower;      //!< bounds
    std::vector<bool> isHeld;       //!< on its bound while solving
    Eigen::VectorXd known;          //!< values known from an earlier step
    Eigen::MatrixXd priorRows;      //!< W, W (values - known) has unit covariance; no rows: nothing is known

    //! d values / d free coordinates; orthonormal. A normal moves on the sphere.
    Eigen::MatrixXd tangentBasis(bool withHeld = true) const;
    //! What a coordinate of MEDIA is.
    WindowParameter windowParameter(int coordinate) const { return kindOf(at, at.media + coordinate); }
};

//! With its manifold and bounds; constant if nothing of it is free or all is held.
void addToProblem(ceres::Problem& problem, RigBlock& block);

//! GlassCalibrationFlags -> which lens parameters are free.
std::vector<bool> freeLens(const Camera& camera, int flags);

/** The joint problem: cameras, each behind its own window or several behind one, a pose (object -> camera 1) for each view,
every observed point of every image, through the window or direct. Maximum likelihood under equal isotropic pixel noise;
Ceres eliminates the poses.

The public parameters are, per camera, those of Camera::parameters(), then rvec and T of each camera but the first. What is
free is said by GlassCalibrationFlags. */
class RigProblem : private ceres::EvaluationCallback
{
public:
    /** The start of what is known is the known value.
    @param known one per view, or empty
    @param knownCameras one per camera, or empty */
    RigProblem(const Rig& rig, const RigViews& views, const std::vector<Pose>& poses,
               const std::vector<PoseKnowledge>& known, const std::vector<CameraKnowledge>& knownCameras, int flags);
    RigProblem(const RigProblem&) = delete;
    RigProblem& operator=(const RigProblem&) = delete;

    /** False if criteria.maxCount iterations did not reach the change that the criteria ask for (EPS), or no minimum. Throws
    StsBadArg that names a point without image at the start. */
    bool solve(const TermCriteria& criteria);

    int viewCount() const { return (int)poses_.size(); }
    int cameraCount() const { return rig_.count(); }
    const std::vector<RigImage>& images() const { return images_; }
    //! Indices into images().
    const std::vector<int>& imagesOf(int view) const { return imagesOfView_[view]; }
    const std::vector<RigBlock>& blocks() const { return blocks_; }
    std::vector<RigBlock>& blocks() { return blocks_; }     //!< updateCameras() after a change
    //! The cameras at the current values of the blocks.
    void updateCameras();
    void setRootWeights(int image, const std::vector<double>& rootWeights);
    //! Standard deviation of a pixel coordinate, against which what is known with a covariance is weighed.
    void setPixelSigma(double sigma) { pixelSigma_ = sigma; }
    double pixelSigma() const { return pixelSigma_; }

    Rig rig() const;                    //!< with the current parameters
    Camera camera(int c) const;
    Pose pose(int view) const;
    void setPose(int view, const Pose& pose);           //!< nothing if it is known exactly
    double* poseValues(int view) { return poses_[view].data(); }
    //! With what is known of it.
    void addPose(ceres::Problem& problem, int view);
    bool isAdjusted(int view) const { return isSeen_[view] && knowledgeOf(view) != PoseKnowledge::EXACT; }
    bool isUncertain(int view) const { return isSeen_[view] && knowledgeOf(view) == PoseKnowledge::UNCERTAIN; }
    //! The scene that each view's target is, where it is not known: one for all views. NaN: that point has no weight.
    void setObjectPoints(const std::vector<Point3d>& points);
    PoseKnowledge::Kind knowledgeOf(int view) const { return known_.empty() ? PoseKnowledge::UNKNOWN : known_[view].kind; }
    bool hasPriors() const;             //!< poses or parameters known with a covariance

    int pointCount() const;             //!< of those with a weight
    int freeCount() const;              //!< without the poses
    int poseCount() const;              //!< of those that are adjusted
    int equationCount() const;
    int freedom() const { return equationCount() - freeCount() - 6*poseCount(); }
    //! Weighted residuals of one image: u, v of each point.
    Eigen::VectorXd residuals(const RigImage& image) const;
    double squaredError() const;        //!< of all images, and of what is known with a covariance
    bool isOnBound() const;
    bool holdAtBounds();                //!< true if that changes what is held

    //! Distance of each predicted from the observed pixel, whatever its weight, with this pose; infinite without image.
    std::vector<double> pixelErrors(const RigImage& image, const Pose& pose) const;

    //! One image's residuals and their derivatives: by its pose, and by all coordinates of the blocks that it depends on.
    struct Derivatives
    {
        std::vector<int> blocks;                    //!< indices into blocks()
        std::vector<RowMajorMatrix> byBlock;        //!< of the same
        RowMajorMatrix byPose;                      //!< 0 if the pose is known exactly
        Eigen::VectorXd residuals;
    };
    Derivatives derivatives(const RigImage& image) const;
    //! The same whatever is known of the pose, or residuals only; false where a point has no image.
    bool evaluate(const RigImage& image, bool wantsDerivatives, Derivatives& result) const;
    std::vector<int> blocksOf(const RigImage& image) const;     //!< indices into blocks(), as in Derivatives
    //! What is known of a pose counts as six more residuals; their derivatives by the pose.
    Matrix6 priorByPose(int view) const { return pixelSigma_*known_[view].inverseRoot; }
    Vector6 priorOfPose(int view) const;                //!< these residuals
    //! The same of a block's parameters.
    Eigen::MatrixXd priorByBlock(int block) const { return pixelSigma_*blocks_[block].priorRows; }
    Eigen::VectorXd priorOfBlock(int block) const;

    /** d public parameters / d free coordinates of all blocks, in the order of blocks(). What the other cameras see of a
    shared window follows from its owner's. */
    Eigen::MatrixXd publicBasis() const;
    int publicCount() const;

private:
    void addBlock(RigBlock::Kind kind, int camera, int first, const std::vector<bool>& isFree);
    void setKnown(const CameraKnowledge& known, int first, RigBlock& block);
    void addImages(const RigViews& views);
    int blockOf(RigBlock::Kind kind, int camera) const;
    const double* valuesOf(RigBlock::Kind kind, int camera) const;      //!< null for the extrinsics of camera 1
    ceres::CostFunction* makeCost(const RigImage& image) const;
    int publicRow(RigBlock::Kind kind, int camera) const;
    void addSharedWindow(int camera, Eigen::MatrixXd& basis) const;

    void PrepareForEvaluation(bool, bool isNewPoint) override { if (isNewPoint) updateCameras(); }

    void solveInside(TrustRegion& region);
    bool isAtMinimum() const;
    String startFault() const;      //!< empty, or which point has no image at the start

    Rig rig_;                           //!< lens models and numbers of layers
    std::vector<RigCamera> cameras_;
    std::vector<RigImage> images_;
    std::vector<std::vector<int> > imagesOfView_;
    std::vector<double> values_;        //!< of all blocks, one after the other, as Ceres sorts blocks by their address
    std::vector<RigBlock> blocks_;
    std::vector<std::array<double, 6> > poses_, knownPoses_;
    std::vector<PoseKnowledge> known_;
    std::vector<bool> isSeen_;          //!< per view: some image
    double pixelSigma_;
};

}} // namespace

#endif // OPENCV_REFRACT_RIG_PROBLEM_HPP
