// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PROBLEM_HPP
#define OPENCV_REFRACT_PROBLEM_HPP

#include "adjust/fit_outcome.hpp"
#include "adjust/parameter_block.hpp"
#include "adjust/residual.hpp"
#include "adjust/rig_prior.hpp"
#include "adjust/scene.hpp"
#include "adjust/shared_target_errors.hpp"

namespace cv { namespace refract {

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
struct PosePrior
{
    enum Kind { NONE, EXACT, UNCERTAIN };
    Kind kind = NONE;
    Eigen::MatrixXd sqrtInformation;    //!< W, W^T W = inverse of the covariance of what is known; UNCERTAIN only

    //! Something of one of the six coordinates.
    bool tells(int coordinate) const { return kind == EXACT || (kind == UNCERTAIN && !sqrtInformation.col(coordinate).isZero(0)); }
    bool tellsRotation() const { return tells(0) || tells(1) || tells(2); }
    bool tellsTranslation() const { return tells(3) || tells(4) || tells(5); }
    bool tellsAll() const { return tells(0) && tells(1) && tells(2) && tells(3) && tells(4) && tells(5); }
};

/** What an earlier step knows of a camera's parameters, in the order of Camera::parameters(): lens, or lens and window, or these and
its extrinsics (rvec, T). A parameter with a variance is estimated, within it. A lens parameter with none is exact, and one of the
extrinsics; NaN or empty: nothing is known. */
struct CameraPrior
{
    Eigen::MatrixXd covariance;
};

//! One image of the problem.
struct Image
{
    int view, camera;
    bool refracted;
    ImagePoints points;
    std::vector<double> rootWeights;    //!< one per point; 0: left out

    //! Observed coordinates of its points that have a weight.
    int coordinateCount() const
    {
        int count = 0;
        for (size_t i = 0; i < rootWeights.size(); i++)
            count += rootWeights[i] > 0 ? points.rowsOf(i) : 0;
        return count;
    }
    int usedCount() const { return (int)std::count_if(rootWeights.begin(), rootWeights.end(),
                                                      [](double w) { return w > 0; }); }
};

//! One image of a scene, as it is given: its points' indices are those of the scene.
struct SceneImage
{
    int view, camera;
    ImagePoints points;
};

/** Images of pixels per camera, per view: one per scene point, or none. Those that show nothing are left out.
@param covariances of the pixels, or empty
@param variance as RigViews' */
std::vector<SceneImage> sceneImages(const std::vector<PixelViews>& pixels,
                                    const std::vector<CovarianceViews>& covariances = std::vector<CovarianceViews>(), double variance = 1);

typedef std::vector<std::vector<uchar> > Masks;     //!< per image, per point of it; 1: an inlier

//! One point in one image: which of the image's points it is.
struct Observation
{
    int image, row;
};

/** The joint problem: cameras, each behind its own window or several behind one, a pose (object -> camera 1) for each view, and
every observed point of every image, through the window or direct. The points are known (targets; a calibration), or free: one
scene that all views show (a bundle adjustment). Maximum likelihood under equal isotropic pixel noise.

What is free are blocks of parameters. Some stand by themselves (outer blocks: of the cameras, and of a scene's views the poses);
the others follow from them, each from its own observations alone (inner blocks: the poses of targets, the clusters of a scene),
so the fit eliminates them.

The public parameters are, per camera, those of Camera::parameters(), then rvec and T of each camera but the first, then the errors
that all targets share, if the problem has them. What is free is said by GlassCalibrationFlags. */
class Problem
{
public:
    /** Known targets. The start of what is known is the known value.
    @param posePriors one per view, or empty
    @param cameraPriors one per camera, or empty
    @param targetCovariance of SharedTargetErrors; a variance of 0: there is no such error; empty: there is none */
    Problem(const Rig& rig, const RigViews& views, const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors,
            const std::vector<CameraPrior>& cameraPriors, int flags, const Eigen::MatrixXd& targetCovariance = Eigen::MatrixXd());
    /** A scene.
    @param images view by view
    @param cameraPriors one per camera, or empty
    @param rigCovariance of the public parameters, which start where they are known: what has a variance is estimated within it,
    for the rest the flags decide; empty: nothing is known
    @param lengthScaleSigma of a relative error that all lengths share; 0: there is none; NaN: nothing is known of it */
    Problem(const Rig& rig, const std::vector<SceneImage>& images, int pointCount, const std::vector<KnownLength>& lengths,
            const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors, int flags,
            const std::vector<CameraPrior>& cameraPriors = std::vector<CameraPrior>(),
            const Eigen::MatrixXd& rigCovariance = Eigen::MatrixXd(), double lengthScaleSigma = 0);
    Problem(const Problem&) = delete;
    Problem& operator=(const Problem&) = delete;

    // Images
    int viewCount() const { return (int)imagesOfView_.size(); }
    int cameraCount() const { return rig_.count(); }
    const std::vector<Image>& images() const { return images_; }
    //! Indices into images().
    const std::vector<int>& imagesOf(int view) const { return imagesOfView_[view]; }
    void setRootWeights(int image, const std::vector<double>& rootWeights);
    int pointCount() const;             //!< of those with a weight
    int coordinateCount() const;        //!< that were observed, of the same
    /** Distance of each predicted from the observed pixel, whitened, whatever its weight, with this pose of the view; infinite without
    image. */
    std::vector<double> pixelErrors(const Image& image, const Pose& pose) const;
    std::vector<double> pixelErrors(const Image& image) const { return pixelErrors(image, pose(image.view)); }
    std::vector<std::vector<double> > pixelErrors() const;      //!< of all images
    double squaredPixelError(const Image& image) const;     //!< weighted and whitened
    double squaredDistances(const Image& image) const;      //!< weighted; in pixels whatever their covariances
    //! The first point with a weight that has no image; or which window no camera can look through so.
    FitOutcome findPointWithoutImage() const;
    /** The first point with a weight that all but touches the window of its camera: nearer by this part of its distance, it has no image.
    @param owner of the window; -1: any */
    FitOutcome findPointAtWindow(double nearer, int owner = -1) const;

    /** The means of priors, where they are not the values that the problem was made with: a search may have moved these.
    @param given the rig that the priors are of. @param poses the same of the views; empty: none is known */
    void setPriorMeans(const Rig& given, const std::vector<Pose>& poses);

    // Parameters
    const std::vector<ParameterBlock>& blocks() const { return blocks_; }
    std::vector<ParameterBlock>& blocks() { return blocks_; }     //!< updateCameras() after a change
    int outerCount() const { return hasScene() ? (int)blocks_.size() : poseBlock(0); }     //!< blocks; these come first
    int poseBlock(int view) const { return cameraBlocks_ + view; }
    //! Indices into blocks(), in the order of ImageResidual's blocks after the pose.
    std::vector<int> blocksOf(const Image& image) const;
    //! The cameras at the current values of the blocks.
    void updateCameras();
    Rig rig() const;                    //!< with the current parameters
    Camera camera(int c) const;
    Pose pose(int view) const;
    std::vector<Pose> poses() const;        //!< of all views
    void setPose(int view, const Pose& pose);           //!< nothing if it is known exactly
    RigidTransform camFromScene(const Image& image) const;     //!< or from the view's target
    //! The pose in the direct images of a target that has this pose in an image.
    Pose inDirectImages(const Image& image, const Pose& pose) const;
    //! Of SharedTargetErrors; -1: the problem has none.
    int targetBlock() const { return targetBlock_; }
    //! A scene's points, which are in the unit of the given lengths, are larger by this.
    double sceneScale() const { return targetErrors_.scale; }
    bool isAdjusted(int view) const { return isSeen_[view] && blocks_[poseBlock(view)].isFree[0]; }

    // A scene
    bool hasScene() const { return scene_.pointCount() > 0; }
    Scene& scene() { return scene_; }
    const Scene& scene() const { return scene_; }
    /** Which points are in use, and where they are. What is not in use has no weight in any image.
    @param points NaN: not in use
    @param isInlier 0 is left out; empty: all are used */
    void setPoints(const std::vector<Point3d>& points, const Masks& isInlier);
    //! Copies the scene's points to where the residuals look for them; what is not in use stays where it was.
    void placePoints(const std::vector<Point3d>& points);
    void placeCluster(int cluster);     //!< the same of its points
    //! Of all its points, also those that are left out.
    const std::vector<Observation>& observationsOf(int cluster) const { return observations_[cluster]; }

    // Equations
    //! Standard deviation of a pixel coordinate, against which priors and lengths are weighed.
    void setPixelSigma(double sigma) { pixelSigma_ = sigma; }
    double pixelSigma() const { return pixelSigma_; }
    bool hasPriors() const { return equationCount() > coordinateCount(); }     //!< or lengths
    int equationCount() const;
    int unknownCount() const;
    int freedom() const { return equationCount() - unknownCount(); }
    double squaredError() const;        //!< weighted; of images, lengths and priors
    //! A block's prior counts as so many more residuals. Their derivatives by the block; none where it does not count now.
    Eigen::MatrixXd priorRows(int block) const;
    Eigen::VectorXd priorResidual(int block) const;
    //! The same of what is known of all cameras together, by the values of the blocks before the poses, one after the other.
    const RigPrior& rigPrior() const { return rigPrior_; }
    Eigen::MatrixXd rigPriorRows() const;
    Eigen::VectorXd rigPriorResidual() const;
    double squaredOuterPriors() const;          //!< of all priors but those of eliminated poses
    int cameraBlockCount() const { return cameraBlocks_; }

    //! One image's residuals and their derivatives: by its pose, and by all coordinates of blocksOf().
    struct Derivatives
    {
        Eigen::VectorXd residuals;
        RowMajorMatrix byPose;
        std::vector<RowMajorMatrix> byBlock;
    };
    enum Wanted { RESIDUALS, BY_POSE, ALL };
    //! @return false where a point with a weight has no image; its residuals are infinite
    bool evaluate(const Image& image, const std::vector<double>& rootWeights, Wanted wanted, Derivatives& result) const;

    //! Derivatives by the scene's points, from those by the view's pose.
    RowMajorMatrix byScenePoint(const Image& image, const RowMajorMatrix& byPose) const;

    /** d public parameters / d free coordinates of the blocks before the poses, in their order. What the other cameras see of a shared
    window follows from its owner's. */
    Eigen::MatrixXd publicBasis() const;
    int publicCount() const
    { return publicRow(ParameterBlock::TARGETS, 0) + (targetBlock_ < 0 ? 0 : SharedTargetErrors::COUNT); }

private:
    void addBlocks(const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors,
                   const std::vector<CameraPrior>& cameraPriors, int flags, const Eigen::MatrixXd& targetCovariance);
    ParameterBlock& addBlock(ParameterBlock::Kind kind, int index, const std::vector<double>& values,
                             const std::vector<String>& names, const std::vector<bool>& isFree);
    void addTargetBlock(const Eigen::MatrixXd& covariance);
    void setRigPrior(const Eigen::MatrixXd& covariance);
    Eigen::MatrixXd correlatedWindows(const std::vector<CameraPrior>& cameraPriors) const;
    std::vector<double> givenValues(const ParameterBlock& block, const Rig& given, const std::vector<Pose>& poses) const;
    void addCameraBlocks(int camera, const CameraPrior& prior, int flags);
    void addImages(const RigViews& views);
    void addImage(int view, int camera, bool refracted, const ImagePoints& points);
    //! Pixels of an image's points, and their RefractiveStatus.
    struct Prediction
    {
        std::vector<Point2d> pixel;
        std::vector<uchar> status;
    };
    FitOutcome checkCamera(const Image& image) const;
    FitOutcome findPointWithoutImage(const Image& image) const;
    Prediction predict(const Image& image, const Pose& pose, double part = 1) const;
    bool isActive(int block) const;
    int blockOf(ParameterBlock::Kind kind, int camera) const;
    const double* valuesOf(ParameterBlock::Kind kind, int camera) const;    //!< null for the extrinsics of camera 1
    int publicRow(ParameterBlock::Kind kind, int camera) const;
    void addSharedWindow(int camera, Eigen::MatrixXd& basis) const;

    Rig rig_;                           //!< lens models and numbers of layers
    std::vector<RigCamera> cameras_;
    std::vector<Image> images_;
    std::vector<std::vector<int> > imagesOfView_;
    std::vector<bool> isSeen_;          //!< per view: some image has a weight
    std::vector<double> values_;        //!< of all blocks, one after the other
    std::vector<ParameterBlock> blocks_;
    int cameraBlocks_;                  //!< and of the targets: those before the poses
    int targetBlock_;
    SharedTargetErrors targetErrors_;
    RigPrior rigPrior_;
    Scene scene_;
    std::vector<std::vector<Observation> > observations_;
    double pixelSigma_;
};

}} // namespace

#endif // OPENCV_REFRACT_PROBLEM_HPP
