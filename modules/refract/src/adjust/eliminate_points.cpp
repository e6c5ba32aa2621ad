// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the derivatives E by a cluster's points and F by cameras and poses, the information on the latter that is left when
the points are unknown is

    S = sum over images of F^T F - sum over clusters of (Y E^T F)^T (Y E^T F),     Y^T Y = (E^T E)^+

(the Schur complement; Triggs et al., Bundle adjustment - a modern synthesis, 2000, section 6.1). Columns are scaled to their own
effect before anything is inverted. Sums are in one order, whatever the number of threads. */

#include "adjust/eliminate.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is left of a squared effect below this part of it is rounding.
const double ROUNDING = 1e-12;

//! Normal equations of cameras and poses.
struct NormalEquations
{
    explicit NormalEquations(int count) : matrix(MatrixXd::Zero(count, count)), gradient(VectorXd::Zero(count)) {}
    MatrixXd matrix;            //!< lower half
    VectorXd gradient;
    void add(const MatrixXd& products, const VectorXd& ownGradient, const std::vector<int>& columns)
    {
        for (size_t c = 0; c < columns.size(); c++)
        {
            gradient[columns[c]] += ownGradient[c];
            for (size_t r = c; r < columns.size(); r++)
                matrix(std::max(columns[r], columns[c]), std::min(columns[r], columns[c])) += products(r, c);
        }
    }
};

void addImages(const std::vector<ImageRows>& images, NormalEquations& equations)
{
    std::vector<MatrixXd> products(images.size());
    std::vector<VectorXd> gradients(images.size());
    parallel_for_(Range(0, (int)images.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const int count = (int)images[i].columns.size();
            products[i] = MatrixXd::Zero(count, count);
            if (count == 0)         // Eigen has no products of nothing
                continue;
            addGram(images[i].outer, 1, products[i]);
            gradients[i] = transposeTimesVector(images[i].outer, images[i].residuals);
        }
    });
    for (size_t i = 0; i < images.size(); i++)
        equations.add(products[i], gradients[i], images[i].columns);
}

void addPrior(const MatrixXd& rows, const VectorXd& residual, int first, NormalEquations& equations)
{
    std::vector<int> columns;
    for (int j = 0; j < rows.cols(); j++)
        columns.push_back(first + j);
    equations.add(transposeTimes(rows, rows), transposeTimesVector(rows, residual), columns);
}

void addPriors(const Problem& problem, const FreeSpace& space, NormalEquations& equations)
{
    for (int block = 0; block < problem.outerCount(); block++)
    {
        const MatrixXd rows = product(problem.priorRows(block), space.bases[block]);
        if (rows.rows() > 0)
            addPrior(rows, problem.priorResidual(block), space.first[block], equations);
    }
    if (problem.rigPrior().count() == 0)
        return;
    const MatrixXd byValues = problem.rigPriorRows();
    MatrixXd rows(byValues.rows(), 0);
    int first = 0;
    for (int block = 0; block < problem.cameraBlockCount(); block++)
    {
        const MatrixXd& basis = space.bases[block];
        rows.conservativeResize(Eigen::NoChange, rows.cols() + basis.cols());
        if (basis.cols() > 0)       // Eigen has no products of nothing
            rows.rightCols(basis.cols()) = product(byValues.middleCols(first, basis.rows()), basis);
        first += (int)basis.rows();
    }
    addPrior(rows, problem.rigPriorResidual(), 0, equations);
}

//! A cluster without its points.
struct EliminatedCluster
{
    InnerBlock points;
    MatrixXd W;                 //!< Y E^T F
    VectorXd residual;          //!< Y E^T r
};

//! Y, Y^T Y = A^+. @param isRegular whether A has an inverse
MatrixXd inverseRoot(const MatrixXd& A, bool& isRegular)
{
    const VectorXd scale = A.diagonal().cwiseMax(DBL_MIN).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen(scale.asDiagonal()*A*scale.asDiagonal());
    const VectorXd& values = eigen.values;
    const VectorXd roots = (values.array() > ROUNDING*values.maxCoeff()).select(values.cwiseSqrt().cwiseInverse(), 0.);
    isRegular = values[0] > ROUNDING*values.maxCoeff();
    return roots.asDiagonal()*eigen.vectors.transpose()*scale.asDiagonal();
}

std::vector<int> columnsOf(const Problem& problem, int cluster, const std::vector<ImageRows>& images)
{
    std::vector<int> columns;
    std::vector<int> last;      // views come one after the other: most images of a view depend on the same
    for (const Observation& o : problem.observationsOf(cluster))
    {
        if (problem.images()[o.image].rootWeights[o.row] == 0 || images[o.image].columns == last)
            continue;
        last = images[o.image].columns;
        columns.insert(columns.end(), last.begin(), last.end());
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return columns;
}

EliminatedCluster eliminate(const Problem& problem, int index, const FreeSpace& space, const std::vector<ImageRows>& images)
{
    const Cluster& cluster = problem.scene().clusters()[index];
    EliminatedCluster result;
    result.points.columns = columnsOf(problem, index, images);
    const std::vector<int>& columns = result.points.columns;
    std::vector<int> place(space.count, -1);
    for (size_t k = 0; k < columns.size(); k++)
        place[columns[k]] = (int)k;
    const int size = cluster.size();
    MatrixXd EE = MatrixXd::Zero(size, size), EF = MatrixXd::Zero(size, columns.size());
    VectorXd Er = VectorXd::Zero(size);
    for (const Observation& o : problem.observationsOf(index))
    {
        if (problem.images()[o.image].rootWeights[o.row] == 0)
            continue;
        const ImageRows& image = images[o.image];
        const Eigen::Matrix<double, 2, 3> E = image.inner.middleRows<2>(2*o.row);
        const int at = 3*problem.scene().placeInCluster(problem.images()[o.image].points.index[o.row]);
        EE.block<3, 3>(at, at) += E.transpose()*E;
        Er.segment<3>(at) += E.transpose()*image.residuals.segment<2>(2*o.row);
        for (size_t c = 0; c < image.columns.size(); c++)
            EF.block<3, 1>(at, place[image.columns[c]]) += E.transpose()*image.outer.block<2, 1>(2*o.row, c);
    }
    cluster.addLengths(problem.pixelSigma(), EE, Er);
    const MatrixXd Y = inverseRoot(EE, result.points.isDetermined);
    result.W = product(Y, EF);
    result.residual = timesVector(Y, Er);
    result.points.half = Y.transpose();
    result.points.byOuter = -transposeTimes(Y, result.W);
    result.points.step = -transposeTimesVector(Y, result.residual);
    return result;
}

//! Subtracts W^T W of many clusters at a time, as products of large matrices are faster.
class ProductsOfRows
{
public:
    explicit ProductsOfRows(NormalEquations& equations)
        : equations_(equations), rows_(MatrixXd::Zero(MANY, equations.matrix.cols())), used_(0) {}

    void subtract(const EliminatedCluster& cluster)
    {
        const int size = (int)cluster.W.rows();
        if (used_ + size > rows_.rows())
            flush();
        if (size > rows_.rows())
            rows_ = MatrixXd::Zero(size, rows_.cols());
        for (size_t k = 0; k < cluster.points.columns.size(); k++)
        {
            rows_.block(used_, cluster.points.columns[k], size, 1) = cluster.W.col(k);
            equations_.gradient[cluster.points.columns[k]] -= cluster.W.col(k).dot(cluster.residual);
        }
        used_ += size;
    }

    void flush()
    {
        const int count = (int)rows_.cols();
        parallel_for_(Range(0, (count + PANEL - 1)/PANEL), [&](const Range& range)
        {
            for (int panel = range.start; panel < range.end; panel++)
            {
                const int begin = panel*PANEL, width = std::min(PANEL, count - begin);
                subtractTransposeTimes(rows_.topRows(used_).rightCols(count - begin), rows_.topRows(used_).middleCols(begin, width),
                                       equations_.matrix.block(begin, begin, count - begin, width));
            }
        });
        rows_.setZero();
        used_ = 0;
    }

private:
    static const int MANY = 384, PANEL = 64;
    NormalEquations& equations_;
    MatrixXd rows_;
    int used_;
};

/** R and z, R^T R = S and R^T z = gradient.
@param effect to which the columns are scaled */
void setRoot(const NormalEquations& equations, Information& information)
{
    const VectorXd& effect = information.effect;
    const VectorXd scale = (effect.array() > 0).select(effect.cwiseInverse(), 0.);
    const LDLT ldlt(scale.asDiagonal()*equations.matrix*scale.asDiagonal());
    const VectorXd D = ldlt.D();
    const VectorXd roots = (D.array() > ROUNDING).select(D.cwiseMax(0).cwiseSqrt(), 0.);
    information.root = roots.asDiagonal()*ldlt.L().transpose()*effect.asDiagonal();
    const VectorXd z = ldlt.solveL(scale.cwiseProduct(equations.gradient));
    information.residual = (roots.array() > 0).select(z.cwiseQuotient(roots), 0.);
}

} // namespace

Information eliminatePoints(const Problem& problem, const FreeSpace& space, const std::vector<ImageRows>& images)
{
    NormalEquations equations(space.count);
    addImages(images, equations);
    addPriors(problem, space, equations);
    Information information;
    information.effect = equations.matrix.diagonal().cwiseSqrt();
    const int count = (int)problem.scene().clusters().size();
    information.inner.resize(count);
    ProductsOfRows products(equations);
    const int MANY = 512;       // clusters at a time
    for (int begin = 0; begin < count; begin += MANY)
    {
        std::vector<EliminatedCluster> some(std::min(MANY, count - begin));
        parallel_for_(Range(0, (int)some.size()), [&](const Range& range)
        {
            for (int i = range.start; i < range.end; i++)
                some[i] = eliminate(problem, begin + i, space, images);
        });
        for (size_t i = 0; i < some.size(); i++)
        {
            products.subtract(some[i]);
            information.ofInner += some[i].residual.squaredNorm();
            information.inner[begin + i] = std::move(some[i].points);
        }
    }
    products.flush();
    if (space.count > 0)
        setRoot(equations, information);
    information.rounding = std::sqrt(ROUNDING);
    return information;
}

}} // namespace
