// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_INFORMATION_HPP
#define OPENCV_REFRACT_BUNDLE_INFORMATION_HPP

#include "calibrate/bundle_problem.hpp"
#include "calibrate/information.hpp"

namespace cv { namespace refract {

/** Normal equations of a bundle's cameras and poses that are left when its points are eliminated, for unit pixel noise; the
bundle must have been evaluated with derivatives. Columns: the rig's free parameters, then 6 of each pose that is adjusted. */
class ReducedBundle
{
public:
    //! @param withHeld also of parameters that are held on their bound
    ReducedBundle(const BundleProblem& bundle, bool withHeld);

    //! As information.hpp's.
    double stepLeft() const;
    //! On the rig's parameters, poses unknown. Throws, naming the view, if a pose is not determined by the points.
    Information information() const;
    /** One standard deviation of each coordinate of the scene's points; NaN where they are not in use, infinite where the images
    do not determine them.
    @param half of the rig's covariance, as halfCovariance() has it from information()
    @param variance of a pixel coordinate */
    Mat pointDeviations(const Eigen::MatrixXd& half, double variance) const;
    /** H (studentized.hpp) of every observation of a point in use, per image, per point of it; the bundle must have been evaluated
    with all of them. */
    std::vector<std::vector<Matx22d> > predictions() const;

private:
    //! One image's derivatives by the free parameters and the pose that it depends on, and where they stand among all.
    struct ImageRows
    {
        RowMajorMatrix rows;
        std::vector<int> columns;
    };
    //! What a cluster's points take away: W (a row for each of their coordinates), of the residuals too, and Y.
    struct Eliminated
    {
        Eigen::MatrixXd W, Y;
        Eigen::VectorXd ofResiduals;
        bool isDetermined;
    };
    //! What an observation's pixel has to do with: its point in the cluster, and columns among all.
    struct Observation
    {
        int image, row, at;
    };
    void addImages();
    void addClusters();
    void addPriors();
    Eliminated eliminate(const Cluster& cluster) const;
    Eigen::MatrixXd poseInverseRoot() const;
    Eigen::MatrixXd jointHalf(const Eigen::MatrixXd& half) const;
    Matx22d prediction(const Observation& observation, const Eigen::MatrixXd& ofPoints, const Eigen::MatrixXd& cross,
                       const Eigen::MatrixXd& ofCameras) const;

    const BundleProblem& bundle_;
    const FreeSpace space_;
    std::vector<int> firstOfPose_;      //!< column; -1: not adjusted
    std::vector<ImageRows> images_;
    int count_;
    Eigen::MatrixXd matrix_;            //!< lower half
    Eigen::VectorXd gradient_, effect_;
    double ofPoints_;                   //!< sum of squares that the points alone could still take up
};

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_INFORMATION_HPP
