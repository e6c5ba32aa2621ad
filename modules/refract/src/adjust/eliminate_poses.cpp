// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the residuals' derivatives J by the free parameters and K by the poses, the information on the parameters that is
left when the poses are unknown is

    A = sum over views of J^T (I - P_K) J,     P_K the projector on the range of K

It is kept as its square root R, A = R^T R, built by orthogonal transformations only, so that the condition number is not
squared; views whose points do not fix a pose need no special case. An image depends on few parameters: its rows are
reduced first, on their own columns. */

#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is left of a column below this part of it is rounding.
const double ROUNDING = 1e-12;

//! As few rows with the same products.
MatrixXd reduced(const MatrixXd& rows) { return QR(rows).R(); }

//! Appends rows, and replaces all by the triangle with the same products when they are many.
class SquareRoot
{
public:
    explicit SquareRoot(int count) : rows_(8*count + 64, count), used_(0) {}

    //! @param columns of all, in which the rows stand
    void add(const MatrixXd& rows, const std::vector<int>& columns)
    {
        if (used_ + rows.rows() > rows_.rows())
            reduce();
        if (used_ + rows.rows() > rows_.rows())
            rows_.conservativeResize(used_ + rows.rows(), Eigen::NoChange);
        rows_.middleRows(used_, rows.rows()).setZero();
        for (size_t i = 0; i < columns.size(); i++)
            rows_.block(used_, columns[i], rows.rows(), 1) = rows.col(i);
        used_ += (int)rows.rows();
    }

    MatrixXd triangle()
    {
        const int count = (int)rows_.cols();
        add(MatrixXd::Zero(count, 0), std::vector<int>());
        reduce();
        return rows_.topRows(count);
    }

private:
    void reduce()
    {
        const int count = (int)rows_.cols();
        if (used_ <= count)
            return;
        rows_.topRows(count) = reduced(rows_.topRows(used_));
        used_ = count;
    }
    MatrixXd rows_;
    int used_;
};

//! One view's rows: K by its pose; J by the columns, and the residuals as the last.
struct ViewRows
{
    std::vector<int> columns;
    MatrixXd K, J;

    ViewRows(const Problem& problem, int view, const std::vector<ImageRows>& images)
    {
        for (int i : problem.imagesOf(view))
            columns.insert(columns.end(), images[i].columns.begin(), images[i].columns.end());
        std::sort(columns.begin(), columns.end());
        columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
        J.resize(0, columns.size() + 1);
        K.resize(0, 6);
        for (int i : problem.imagesOf(view))
            add(images[i]);
    }

    void add(const ImageRows& image)
    {
        MatrixXd rows(image.residuals.size(), 7 + image.columns.size());
        rows << image.inner, image.outer, image.residuals;
        rows = reduced(rows);
        append((int)rows.rows());
        K.bottomRows(rows.rows()) = rows.leftCols<6>();
        for (size_t k = 0; k < image.columns.size(); k++)
        {
            const auto at = std::lower_bound(columns.begin(), columns.end(), image.columns[k]);
            J.bottomRows(rows.rows()).col(at - columns.begin()) = rows.col(6 + k);
        }
        J.bottomRows(rows.rows()).rightCols<1>() = rows.rightCols<1>();
    }

    //! A prior of the pose.
    void add(const MatrixXd& byPose, const VectorXd& residual)
    {
        append((int)byPose.rows());
        K.bottomRows(byPose.rows()) = byPose;
        J.bottomRows(byPose.rows()).rightCols<1>() = residual;
    }

    void append(int count)
    {
        J.conservativeResize(J.rows() + count, Eigen::NoChange);
        J.bottomRows(count).setZero();
        K.conservativeResize(K.rows() + count, Eigen::NoChange);
    }
};

EliminatedView eliminate(const ViewRows& view)
{
    EliminatedView result;
    const MatrixXd &J = view.J, &K = view.K;
    const int count = (int)view.columns.size();
    const Eigen::RowVectorXd scale = K.colwise().norm().cwiseMax(DBL_MIN);
    InnerBlock& pose = result.pose;
    pose.columns = view.columns;
    if (K.rows() == 0)          // nothing was seen
    {
        pose.byOuter = MatrixXd::Zero(6, count);
        pose.step = VectorXd::Zero(6);
        pose.half.resize(6, 0);
        result.squares = VectorXd::Zero(count);
        return result;
    }
    const PivotedQR qr(K.array().rowwise()/scale.array(), ROUNDING);
    const int rank = qr.rank();
    const MatrixXd rotated = qr.rotate(J);
    const MatrixXd rest = rotated.bottomRows(J.rows() - rank);
    result.rows = rest.rows() > count + 1 ? reduced(rest) : rest;
    result.squares = J.leftCols(count).colwise().squaredNorm().transpose();
    result.ofPose = rotated.topRows(rank).rightCols<1>().squaredNorm();

    setInner(qr, scale.cwiseInverse().transpose(), rotated, pose);
    return result;
}

} // namespace

std::vector<EliminatedView> eliminateEachPose(const Problem& problem, const std::vector<ImageRows>& images)
{
    std::vector<EliminatedView> views(problem.viewCount());
    parallel_for_(Range(0, problem.viewCount()), [&](const Range& range)
    {
        for (int view = range.start; view < range.end; view++)
        {
            ViewRows rows(problem, view, images);
            rows.add(problem.priorRows(problem.poseBlock(view)), problem.priorResidual(problem.poseBlock(view)));
            views[view] = eliminate(rows);
        }
    });
    return views;
}

Information eliminatePoses(const Problem& problem, const FreeSpace& space, const std::vector<ImageRows>& images)
{
    const int count = space.count;
    const std::vector<EliminatedView> views = eliminateEachPose(problem, images);
    Information information;
    SquareRoot root(count + 1);
    VectorXd squares = VectorXd::Zero(count);
    for (const EliminatedView& view : views)
    {
        std::vector<int> columns = view.pose.columns;
        for (size_t k = 0; k < columns.size(); k++)
            squares[columns[k]] += view.squares[k];
        columns.push_back(count);
        if (view.rows.rows() > 0)
            root.add(view.rows, columns);
        information.ofInner += view.ofPose;
        information.inner.push_back(view.pose);
    }
    const auto addPrior = [&](const MatrixXd& rows, const VectorXd& residual, int first)
    {
        MatrixXd both(rows.rows(), rows.cols() + 1);
        both << rows, residual;
        std::vector<int> columns;
        for (int j = 0; j < rows.cols(); j++)
            columns.push_back(first + j);
        squares.segment(first, rows.cols()) += rows.colwise().squaredNorm().transpose();
        columns.push_back(count);
        root.add(both, columns);
    };
    for (int block = 0; block < problem.outerCount(); block++)
    {
        const MatrixXd rows = product(problem.priorRows(block), space.bases[block]);
        if (rows.rows() > 0)
            addPrior(rows, problem.priorResidual(block), space.first[block]);
    }
    if (problem.rigPrior().count() > 0)
        addPrior(rigPriorRows(problem, space), problem.rigPriorResidual(), 0);
    const MatrixXd triangle = root.triangle();
    information.root = triangle.topLeftCorner(count, count);
    information.residual = triangle.topRightCorner(count, 1);
    information.effect = squares.cwiseSqrt();
    information.rounding = 1e-9;
    return information;
}

MatrixXd publicJacobian(const Problem& problem)
{
    const FreeSpace space(problem);
    const MatrixXd basis = problem.publicBasis();
    int rows = 0;
    for (const Image& image : problem.images())
        rows += 2*(int)image.points.pixel.size();
    MatrixXd jacobian = MatrixXd::Zero(rows, problem.publicCount() + 6*problem.viewCount());
    int row = 0;
    const std::vector<ImageRows> images = linearize(problem, space);
    for (size_t i = 0; i < images.size(); i++)
    {
        const ImageRows& own = images[i];
        const int count = (int)own.residuals.size();
        for (size_t k = 0; k < own.columns.size(); k++)
            jacobian.block(row, 0, count, problem.publicCount()) += own.outer.col(k)*basis.col(own.columns[k]).transpose();
        jacobian.block(row, problem.publicCount() + 6*problem.images()[i].view, count, 6) = own.inner;
        row += count;
    }
    return jacobian;
}

}} // namespace
