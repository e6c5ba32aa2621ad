// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* At the least squares of all observations, let a part of them have the residuals r and the derivatives J. In the fit of the
others, to first order, its residuals are

    e = (I - J (R^T R)^-1 J^T)^-1 r,     R^T R: the information of all observations

(Cook and Weisberg, Residuals and Influence in Regression, 1982). Where a pose belongs to the part alone, r and J are those in the null
space of its derivatives: the pose is fitted to what is held out. */

#include "adjust/held_out.hpp"
#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

const int BISECTIONS = 3;               // of a view: 8 regions
const double ROUNDING = 1e-9;           // what is left of a column below this part of it is rounding

//! Rows [J, r] of a part.
struct PartRows
{
    explicit PartRows(int columns) : rows(0, columns + 1), points(0) {}

    void add(const MatrixXd& more)
    {
        rows.conservativeResize(rows.rows() + more.rows(), Eigen::NoChange);
        rows.bottomRows(more.rows()) = more;
    }
    //! As few rows with the same products.
    void reduce()
    {
        if (rows.rows() <= rows.cols())
            return;
        rows = QR(rows).R();
    }

    MatrixXd rows;
    int points;
};

//! Which region of a view each point of its target is in: the longest axis is halved at the median, thrice.
class Regions
{
public:
    explicit Regions(const std::vector<Point3d>& object, const std::vector<int>& points) : object_(object), of_(object.size(), 0)
    {
        bisect(points, BISECTIONS);
    }
    int operator()(int point) const { return of_[point]; }

private:
    void bisect(std::vector<int> points, int times)
    {
        if (times == 0 || points.empty())
            return;
        Point3d low = object_[points[0]], high = low;
        for (int i : points)
        {
            const Point3d& X = object_[i];
            low = Point3d(std::min(low.x, X.x), std::min(low.y, X.y), std::min(low.z, X.z));
            high = Point3d(std::max(high.x, X.x), std::max(high.y, X.y), std::max(high.z, X.z));
        }
        const Vec3d size = high - low;
        const int axis = (int)(std::max_element(size.val, size.val + 3) - size.val);
        const auto along = [&](int i) { return Vec3d(object_[i])[axis]; };
        std::stable_sort(points.begin(), points.end(), [&](int a, int b) { return along(a) < along(b); });
        const auto middle = points.begin() + points.size()/2;
        for (auto i = middle; i != points.end(); i++)
            of_[*i] += 1 << (times - 1);
        bisect(std::vector<int>(points.begin(), middle), times - 1);
        bisect(std::vector<int>(middle, points.end()), times - 1);
    }
    const std::vector<Point3d>& object_;
    std::vector<int> of_;
};

//! Rows [by all columns of the free space, r] of an image.
MatrixXd spread(const ImageRows& image, int count)
{
    MatrixXd rows = MatrixXd::Zero(image.residuals.size(), count + 1);
    for (size_t i = 0; i < image.columns.size(); i++)
        rows.col(image.columns[i]) = image.outer.col(i);
    rows.rightCols<1>() = image.residuals;
    return rows;
}

std::vector<PartRows> viewsAsParts(const Problem& problem, const std::vector<ImageRows>& images, int count)
{
    std::vector<PartRows> parts;
    const std::vector<EliminatedView> views = eliminateEachPose(problem, images);
    for (int v = 0; v < problem.viewCount(); v++)
    {
        if (problem.imagesOf(v).empty())
            continue;
        const EliminatedView& view = views[v];
        PartRows part(count);
        part.rows = MatrixXd::Zero(view.rows.rows(), count + 1);
        for (size_t i = 0; i < view.pose.columns.size(); i++)
            part.rows.col(view.pose.columns[i]) = view.rows.col(i);
        part.rows.rightCols<1>() = view.rows.rightCols<1>();
        for (int i : problem.imagesOf(v))
            part.points += problem.images()[i].usedCount();
        parts.push_back(part);
    }
    return parts;
}

//! The views' poses are columns too, after the others.
std::vector<PartRows> regionsAsParts(const Problem& problem, const std::vector<ImageRows>& images, int outerCount)
{
    const int count = outerCount + 6*problem.viewCount(), perView = 1 << BISECTIONS;
    std::vector<PartRows> parts(perView*problem.viewCount(), PartRows(count));
    for (int view = 0; view < problem.viewCount(); view++)
    {
        std::vector<Point3d> object;
        std::vector<bool> isSeen;
        for (int i : problem.imagesOf(view))
        {
            const ImagePoints& points = problem.images()[i].points;
            for (size_t k = 0; k < points.index.size(); k++)
            {
                const size_t least = points.index[k] + 1;
                object.resize(std::max(object.size(), least));
                isSeen.resize(object.size(), false);
                object[points.index[k]] = points.object[k];
                isSeen[points.index[k]] = problem.images()[i].rootWeights[k] > 0 || isSeen[points.index[k]];
            }
        }
        std::vector<int> points;
        for (int i = 0; i < (int)isSeen.size(); i++)
            if (isSeen[i])
                points.push_back(i);
        const Regions regions(object, points);
        for (int i : problem.imagesOf(view))
        {
            const Image& image = problem.images()[i];
            MatrixXd all = MatrixXd::Zero(images[i].residuals.size(), count + 1);
            const MatrixXd outer = spread(images[i], outerCount);
            all.leftCols(outerCount) = outer.leftCols(outerCount);
            all.middleCols<6>(outerCount + 6*view) = images[i].inner;
            all.rightCols<1>() = outer.rightCols<1>();
            std::vector<MatrixXd> ofRegion(perView, MatrixXd(all.rows(), count + 1));
            std::vector<int> used(perView, 0);
            for (size_t k = 0; k < image.points.index.size(); k++)
            {
                if (!(image.rootWeights[k] > 0))
                    continue;
                const int region = regions(image.points.index[k]);
                ofRegion[region].middleRows(2*used[region]++, 2) = all.middleRows(2*k, 2);
            }
            for (int region = 0; region < perView; region++)
            {
                parts[perView*view + region].add(ofRegion[region].topRows(2*used[region]));
                parts[perView*view + region].points += used[region];
            }
        }
    }
    parts.erase(std::remove_if(parts.begin(), parts.end(), [](const PartRows& part) { return part.points == 0; }), parts.end());
    return parts;
}

//! What is known from outside, which is never held out.
MatrixXd priorsOf(const Problem& problem, const FreeSpace& space, bool withPoses, int count)
{
    PartRows priors(count);
    for (int block = 0; block < (int)problem.blocks().size(); block++)
    {
        const bool isPose = block >= problem.outerCount();
        const MatrixXd byBlock = isPose && !withPoses ? MatrixXd(0, 6) : problem.priorRows(block);
        if (byBlock.rows() == 0)
            continue;
        MatrixXd rows = MatrixXd::Zero(byBlock.rows(), count + 1);
        if (isPose)
            rows.middleCols(space.count + 6*(block - problem.outerCount()), 6) = byBlock;
        else
            rows.middleCols(space.first[block], space.columnsOf(block)) = product(byBlock, space.bases[block]);
        rows.rightCols<1>() = problem.priorResidual(block);
        priors.add(rows);
    }
    if (problem.rigPrior().count() > 0)
    {
        const MatrixXd byFree = rigPriorRows(problem, space);
        MatrixXd rows = MatrixXd::Zero(byFree.rows(), count + 1);
        rows.leftCols(byFree.cols()) = byFree;
        rows.rightCols<1>() = problem.rigPriorResidual();
        priors.add(rows);
    }
    return priors.rows;
}

//! Squares of (I - X X^T)^-1 z.
double squaresOfHeldOut(const MatrixXd& X, const VectorXd& z)
{
    const SymmetricEigen leverage(timesTranspose(X, X));
    const VectorXd left = 1. - leverage.values.array();
    if (left.minCoeff() < ROUNDING)
        return std::numeric_limits<double>::infinity();
    return transposeTimesVector(leverage.vectors, z).cwiseQuotient(left).squaredNorm();
}

} // namespace

std::vector<HeldOutPart> heldOutErrors(const Problem& problem)
{
    const FreeSpace space(problem, false);
    const std::vector<ImageRows> images = linearize(problem, space);
    const bool byViews = problem.viewCount() >= MIN_HELD_OUT_VIEWS;
    std::vector<PartRows> parts = byViews ? viewsAsParts(problem, images, space.count)
                                          : regionsAsParts(problem, images, space.count);
    const int count = byViews ? space.count : space.count + 6*problem.viewCount();
    PartRows all(count);
    all.add(priorsOf(problem, space, !byViews, count));
    for (PartRows& part : parts)
    {
        part.reduce();
        all.add(part.rows);
        if (all.rows.rows() > 8*count)
            all.reduce();
    }
    all.reduce();
    Information information;
    information.root = all.rows.leftCols(count);
    information.effect = information.root.colwise().norm().transpose();
    information.rounding = ROUNDING;
    const MatrixXd inverse = pseudoInverseRoot(information);
    std::vector<HeldOutPart> errors;
    for (const PartRows& part : parts)
    {
        HeldOutPart error;
        error.points = part.points;
        error.squares = squaresOfHeldOut(product(part.rows.leftCols(count), inverse), part.rows.rightCols<1>());
        errors.push_back(error);
    }
    return errors;
}

}} // namespace
