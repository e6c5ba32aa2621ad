// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LINEARIZE_HPP
#define OPENCV_REFRACT_LINEARIZE_HPP

#include "adjust/problem.hpp"
#include <memory>

namespace cv { namespace refract {

//! Free coordinates of the outer blocks, one column each.
struct FreeSpace
{
    //! @param withHeld also those that are held on their bound
    explicit FreeSpace(const Problem& problem, bool withHeld = true);
    int columnsOf(int block) const { return (int)bases[block].cols(); }
    //! Of the blocks before the poses; of a scene the others are those of the views that are adjusted, six each.
    int cameraCount() const { return cameras_; }
    int adjustedViews() const { return (count - cameras_)/6; }
    //! Which of these a view's pose is; -1: it is not adjusted.
    int placeOf(int poseBlock) const { return columnsOf(poseBlock) > 0 ? (first[poseBlock] - cameras_)/6 : -1; }

    std::vector<Eigen::MatrixXd> bases;     //!< of each block
    std::vector<int> first;                 //!< column of each block
    int count;

private:
    int cameras_;
};

//! One image's residuals and their derivatives.
struct ImageRows
{
    Eigen::VectorXd residuals;      //!< u, v of each point
    RowMajorMatrix inner;           //!< by what is eliminated: the pose of a target (0 if it is fixed), or each point of a scene
    RowMajorMatrix outer;           //!< by the free parameters that the image depends on
    std::vector<int> columns;       //!< which these are, in the free space

    //! @param rootWeights in place of the image's own
    ImageRows(const Problem& problem, const FreeSpace& space, int image, const std::vector<double>& rootWeights);
};

//! Of all images, with their own weights.
std::vector<ImageRows> linearize(const Problem& problem, const FreeSpace& space);

/** The same while inner blocks (clusters of a scene's points, views of targets) are gone through: an image has rows from the first block
that it shows to the last. Where points are listed as images show them, these are few images at a time. */
class PassingRows
{
public:
    enum { AT_ONCE = 4096 };        //!< inner blocks
    //! @param rootWeights in place of the images' own; outlive it; null: their own
    PassingRows(const Problem& problem, const FreeSpace& space, const std::vector<std::vector<double> >* rootWeights = nullptr);
    //! To inner blocks begin ... end - 1; begin ascends. @return the images that are new; they ascend
    std::vector<int> moveTo(int begin, int end);
    //! One that these blocks show.
    const ImageRows& operator[](int image) const { return *rows_[image]; }

private:
    const Problem& problem_;
    const FreeSpace& space_;
    const std::vector<std::vector<double> >* const rootWeights_;
    std::vector<int> first_, last_;                     //!< inner block of each image; beyond all: it shows none
    std::vector<std::unique_ptr<ImageRows> > rows_;
};

//! What is known of all cameras together, by the free coordinates of their blocks, which come first.
Eigen::MatrixXd rigPriorRows(const Problem& problem, const FreeSpace& space);

}} // namespace

#endif // OPENCV_REFRACT_LINEARIZE_HPP
