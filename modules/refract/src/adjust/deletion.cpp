// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With an observation's derivatives F by the outer parameters and E by its inner block, which follows them by D (InnerBlock), and
S the covariance of the outer ones, its predicted pixel has the covariance

    [F E] C [F E]^T,     C = [ S  S D^T; D S  H H^T + D S D^T ]  */

#include "adjust/deletion.hpp"
#include "adjust/outer_covariance.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;

MatrixXd rowsOf(const MatrixXd& matrix, const std::vector<int>& rows)
{
    MatrixXd picked(rows.size(), matrix.cols());
    for (size_t i = 0; i < rows.size(); i++)
        picked.row(i) = matrix.row(rows[i]);
    return picked;
}

MatrixXd columnsOf(const MatrixXd& matrix, const std::vector<int>& columns)
{
    MatrixXd picked(matrix.rows(), columns.size());
    for (size_t i = 0; i < columns.size(); i++)
        picked.col(i) = matrix.col(columns[i]);
    return picked;
}

//! What one inner block's observations are predicted from.
class InnerPrediction
{
public:
    //! @param columns of the outer parameters that some of these observations depend on; they ascend
    InnerPrediction(const InnerBlock& block, const std::vector<int>& columns, const OuterCovariance& outer)
        : columns_(columns), S_(outer.of(columns))
    {
        const std::vector<int> own = placesOf(block.columns);
        cross_ = product(block.byOuter, rowsOf(S_, own));
        ofInner_ = timesTranspose(block.half, block.half) + timesTranspose(columnsOf(cross_, own), block.byOuter);
    }

    //! @param at the first of the block's values that image.inner has the derivatives by
    Matx22d operator()(const ImageRows& image, int row, int at) const
    {
        const int size = (int)image.inner.cols(), count = (int)image.columns.size();
        const auto E = image.inner.middleRows<2>(2*row);
        const auto F = image.outer.middleRows<2>(2*row);
        Eigen::Matrix2d H = E.lazyProduct(ofInner_.block(at, at, size, size)).eval().lazyProduct(E.transpose());
        const std::vector<int> own = placesOf(image.columns);
        for (int c = 0; c < count; c++)         // few columns, of many: no products of matrices
        {
            const Eigen::Vector2d both = E.lazyProduct(cross_.block(at, own[c], size, 1));
            Eigen::Vector2d ofOuter = both;
            for (int r = 0; r < count; r++)
                ofOuter += S_(own[r], own[c])*F.col(r);
            H += ofOuter*F.col(c).transpose() + F.col(c)*both.transpose();
        }
        return Matx22d(H(0, 0), H(0, 1), H(1, 0), H(1, 1));
    }

private:
    std::vector<int> placesOf(const std::vector<int>& columns) const
    {
        std::vector<int> places;
        for (int column : columns)
            places.push_back((int)(std::lower_bound(columns_.begin(), columns_.end(), column) - columns_.begin()));
        return places;
    }
    const std::vector<int>& columns_;
    const MatrixXd S_;
    MatrixXd cross_, ofInner_;
};

//! Those of all observations that are asked for, and of the inner block itself.
std::vector<int> columnsOf(const InnerBlock& block, const std::vector<Observation>& observations,
                           const PassingRows& images, const std::vector<std::vector<double> >& weights)
{
    std::vector<int> columns = block.columns;
    int last = -1;
    for (const Observation& o : observations)
        if (weights[o.image][o.row] > 0 && o.image != last)
        {
            last = o.image;
            columns.insert(columns.end(), images[last].columns.begin(), images[last].columns.end());
        }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return columns;
}

//! Which observations are asked for and have an image: they get derivatives as if their weight were one.
std::vector<std::vector<double> > weightsOfAsked(const Problem& problem, const Masks& isAsked)
{
    std::vector<std::vector<double> > weights = problem.pixelErrors();
    for (size_t i = 0; i < weights.size(); i++)
        for (size_t row = 0; row < weights[i].size(); row++)
            weights[i][row] = std::isfinite(weights[i][row]) && isAsked[i][row] ? 1 : 0;
    return weights;
}

//! Of one inner block.
std::vector<Observation> observationsOf(const Problem& problem, int inner)
{
    if (problem.hasScene())
        return problem.observationsOf(inner);
    std::vector<Observation> observations;
    for (int i : problem.imagesOf(inner))
        for (int row = 0; row < (int)problem.images()[i].points.pixel.size(); row++)
            observations.push_back({ i, row });
    return observations;
}

} // namespace

std::vector<std::vector<DeletionResidual> > deletionResiduals(const Problem& problem, const Masks& isInlier, const Masks& isAsked)
{
    Information information = informationOf(problem, false);
    information.equations.reset();
    OuterCovariance outer(information, pseudoInverseRoot(information));
    outer.invertPoses(std::move(information.poses.factor));
    const FreeSpace space(problem, false);
    const std::vector<std::vector<double> > weights = weightsOfAsked(problem, isAsked);
    std::vector<std::vector<DeletionResidual> > all;
    for (const std::vector<double>& ofImage : weights)
        all.push_back(std::vector<DeletionResidual>(ofImage.size()));
    PassingRows images(problem, space, &weights);
    const auto predict = [&](int inner)
    {
        const std::vector<Observation> observations = observationsOf(problem, inner);
        const std::vector<int> columns = columnsOf(information.inner[inner], observations, images, weights);
        const InnerPrediction prediction(information.inner[inner], columns, outer);
        for (const Observation& o : observations)
        {
            if (weights[o.image][o.row] == 0)
                continue;
            const ImageRows& image = images[o.image];
            const int at = problem.hasScene() ? 3*problem.scene().placeInCluster(problem.images()[o.image].points.index[o.row]) : 0;
            all[o.image][o.row] = DeletionResidual(Vec2d(image.residuals[2*o.row], image.residuals[2*o.row + 1]),
                                                   prediction(image, o.row, at), isInlier[o.image][o.row] != 0,
                                                   problem.images()[o.image].points.rowsOf(o.row));
        }
    };
    const int count = (int)information.inner.size();
    for (int begin = 0; begin < count; begin += PassingRows::AT_ONCE)
    {
        const int end = std::min(begin + PassingRows::AT_ONCE, count);
        images.moveTo(begin, end);
        parallel_for_(Range(begin, end), [&](const Range& range)
        {
            for (int inner = range.start; inner < range.end; inner++)
                predict(inner);
        });
    }
    return all;
}

}} // namespace
