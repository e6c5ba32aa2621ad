// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the derivatives E by a cluster's points and F by cameras and poses, the information on the latter that is left when
the points are unknown is

    S = sum over images of F^T F - sum over clusters of (Y E^T F)^T (Y E^T F),     Y^T Y = (E^T E)^+

(the Schur complement; Triggs et al., Bundle adjustment - a modern synthesis, 2000, section 6.1). Poses of views that show no point
in common have no block in S, and are eliminated in turn, by a sparse Cholesky; what is left is as large as the cameras' parameters
are many. Columns are scaled to their own effect before anything is inverted. Sums are in one order, whatever the number of threads.
*/

#include "adjust/eliminate.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is left of a squared effect below this part of it is rounding.
const double ROUNDING = 1e-12;
const int SIZE = BlockCholesky::SIZE;

//! Views are neighbours where they show points of one cluster, whatever the weights: which ones are outliers changes.
BlockGraph graphOf(const Problem& problem, const FreeSpace& space)
{
    const int views = space.adjustedViews();
    std::vector<std::vector<bool> > areNeighbours(views, std::vector<bool>(views, false));
    std::vector<int> seen;
    for (int cluster = 0; cluster < (int)problem.scene().clusters().size(); cluster++)
    {
        seen.clear();
        for (const Observation& o : problem.observationsOf(cluster))
        {
            const int view = space.placeOf(problem.poseBlock(problem.images()[o.image].view));
            if (view >= 0 && (seen.empty() || seen.back() != view))     // images come view by view
                seen.push_back(view);
        }
        for (int a : seen)
            for (int b : seen)
                areNeighbours[a][b] = true;
    }
    BlockGraph graph(views);
    for (int a = 0; a < views; a++)
        for (int b = 0; b < views; b++)
            if (a != b && areNeighbours[a][b])
                graph[a].push_back(b);
    return graph;
}

//! @param squares of each column, in and out
void addImages(const PassingRows& rows, const std::vector<int>& images, NormalEquations& equations, VectorXd& squares)
{
    std::vector<MatrixXd> products(images.size());
    std::vector<VectorXd> gradients(images.size());
    parallel_for_(Range(0, (int)images.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const ImageRows& image = rows[images[i]];
            const int count = (int)image.columns.size();
            products[i] = MatrixXd::Zero(count, count);
            if (count == 0)         // Eigen has no products of nothing
                continue;
            addGram(image.outer, 1, products[i]);
            gradients[i] = transposeTimesVector(image.outer, image.residuals);
        }
    });
    for (size_t i = 0; i < images.size(); i++)
    {
        const std::vector<int>& columns = rows[images[i]].columns;
        equations.add(products[i], gradients[i], columns);
        for (size_t k = 0; k < columns.size(); k++)
            squares[columns[k]] += products[i](k, k);
    }
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
    if (problem.rigPrior().count() > 0)
        addPrior(rigPriorRows(problem, space), problem.rigPriorResidual(), 0, equations);
}

//! A cluster without its points.
struct EliminatedCluster
{
    InnerBlock points;
    MatrixXd W;                 //!< (Y E^T F)^T
    VectorXd residual;          //!< Y E^T r
};

/** Y of one point, by Cholesky.
@return false if there is none to speak of */
bool inverseRoot3(const Eigen::Matrix3d& A, Eigen::Matrix3d& Y)
{
    const double WELL_CONDITIONED = 1e-6;
    const Eigen::Vector3d scale = A.diagonal().cwiseMax(DBL_MIN).cwiseSqrt().cwiseInverse();
    Eigen::Matrix3d L = scale.asDiagonal()*A*scale.asDiagonal();
    Y.setIdentity();
    for (int k = 0; k < 3; k++)
    {
        const double left = L(k, k) - L.row(k).head(k).squaredNorm();
        if (!(left > WELL_CONDITIONED))
            return false;
        L(k, k) = std::sqrt(left);
        for (int i = k + 1; i < 3; i++)
            L(i, k) = (L(i, k) - L.row(i).head(k).dot(L.row(k).head(k)))/L(k, k);
        for (int c = 0; c <= k; c++)
            Y(k, c) = (Y(k, c) - L.row(k).head(k).dot(Y.col(c).head(k)))/L(k, k);
    }
    Y *= scale.asDiagonal();
    return true;
}

//! Y, Y^T Y = A^+. @param isRegular whether A has an inverse
MatrixXd inverseRoot(const MatrixXd& A, bool& isRegular)
{
    Eigen::Matrix3d Y;
    isRegular = A.cols() == 3 && inverseRoot3(A, Y);
    if (isRegular)
        return Y;
    const VectorXd scale = A.diagonal().cwiseMax(DBL_MIN).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen(scale.asDiagonal()*A*scale.asDiagonal());
    const VectorXd& values = eigen.values;
    const VectorXd roots = (values.array() > ROUNDING*values.maxCoeff()).select(values.cwiseSqrt().cwiseInverse(), 0.);
    isRegular = values[0] > ROUNDING*values.maxCoeff();
    return roots.asDiagonal()*eigen.vectors.transpose()*scale.asDiagonal();
}

std::vector<int> columnsOf(const Problem& problem, int cluster, const PassingRows& images)
{
    std::vector<int> columns;
    int last = -1;
    for (const Observation& o : problem.observationsOf(cluster))
    {
        if (problem.images()[o.image].rootWeights[o.row] == 0 || o.image == last)
            continue;
        last = o.image;
        const std::vector<int>& own = images[last].columns;
        const size_t before = columns.size();
        // Cameras' columns come first, and most images depend on the same of these.
        for (size_t k = 0; k < own.size(); k++)
            if (before <= k || columns[k] != own[k])
                columns.push_back(own[k]);
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return columns;
}

/** @param place of each column among those of the cluster: room for it */
EliminatedCluster eliminate(const Problem& problem, int index, const PassingRows& images, std::vector<int>& place)
{
    const Cluster& cluster = problem.scene().clusters()[index];
    EliminatedCluster result;
    result.points.columns = columnsOf(problem, index, images);
    const std::vector<int>& columns = result.points.columns;
    for (size_t k = 0; k < columns.size(); k++)
        place[columns[k]] = (int)k;
    const int size = cluster.size();
    MatrixXd EE = MatrixXd::Zero(size, size), FE = MatrixXd::Zero(columns.size(), size);
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
        const double* const u = image.outer.data() + 2*o.row*image.outer.cols();
        const double* const v = u + image.outer.cols();
        for (int k = 0; k < 3; k++)
            for (size_t c = 0; c < image.columns.size(); c++)
                FE(place[image.columns[c]], at + k) += E(0, k)*u[c] + E(1, k)*v[c];
    }
    cluster.addLengths(problem.pixelSigma(), EE, Er);
    const MatrixXd Y = inverseRoot(EE, result.points.isDetermined);
    result.W = FE.lazyProduct(Y.transpose());
    result.residual = timesVector(Y, Er);
    result.points.half = Y.transpose();
    result.points.byOuter = -result.W.lazyProduct(Y).transpose();
    result.points.step = -transposeTimesVector(Y, result.residual);
    return result;
}

//! What some clusters tell of the cameras alone.
struct CameraProducts
{
    MatrixXd products;
    VectorXd gradient;

    //! Of clusters begin ... end - 1, together, as products of large matrices are faster.
    CameraProducts(const std::vector<EliminatedCluster>& clusters, int begin, int end, int cameras)
        : products(MatrixXd::Zero(cameras, cameras))
    {
        int count = 0;
        for (int i = begin; i < end; i++)
            count += (int)clusters[i].W.cols();
        MatrixXd rows = MatrixXd::Zero(count, cameras);
        VectorXd residual(count);
        int row = 0;
        for (int i = begin; i < end; i++)
        {
            const std::vector<int>& columns = clusters[i].points.columns;
            const int size = (int)clusters[i].W.cols();
            for (size_t k = 0; k < columns.size() && columns[k] < cameras; k++)
                rows.block(row, columns[k], size, 1) = clusters[i].W.row(k).transpose();
            residual.segment(row, size) = clusters[i].residual;
            row += size;
        }
        addGram(rows, 1, products);
        gradient = transposeTimesVector(rows, residual);
    }
    CameraProducts() {}
};

//! Sums are in the order of the clusters, so that threads make no difference.
void subtractFromCameras(const std::vector<EliminatedCluster>& clusters, NormalEquations& equations)
{
    const int AT_A_TIME = 128, count = (int)clusters.size(), cameras = (int)equations.ofCameras.cols();
    if (cameras == 0)           // Eigen has no products of nothing
        return;
    std::vector<CameraProducts> parts((count + AT_A_TIME - 1)/AT_A_TIME);
    parallel_for_(Range(0, (int)parts.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            parts[i] = CameraProducts(clusters, i*AT_A_TIME, std::min(count, (i + 1)*AT_A_TIME), cameras);
    });
    for (const CameraProducts& part : parts)
    {
        equations.ofCameras -= part.products;
        equations.gradient.head(cameras) -= part.gradient;
    }
}

//! One pose in the W of one cluster.
struct PoseColumns
{
    const EliminatedCluster* cluster;
    int first;
};

//! Subtracts what clusters tell of one view's pose, together with the cameras and the poses that are eliminated after it.
void subtractPose(int view, const std::vector<PoseColumns>& seen, std::vector<int>& entry, NormalEquations& equations)
{
    const int cameras = (int)equations.ofCameras.cols();
    BlockCholesky& poses = equations.ofPoses;
    BlockCholesky::Column& column = poses.column(poses.at(view));
    for (size_t i = 0; i < column.rows.size(); i++)
        entry[column.rows[i]] = (int)i;
    Eigen::Matrix<double, SIZE, Eigen::Dynamic> ofBoth = Eigen::Matrix<double, SIZE, Eigen::Dynamic>::Zero(SIZE, cameras);
    auto gradient = equations.gradient.segment<SIZE>(cameras + SIZE*view);
    for (const PoseColumns& own : seen)
    {
        gradient.noalias() -= own.cluster->W.middleRows<SIZE>(own.first).lazyProduct(own.cluster->residual);
        const std::vector<int>& columns = own.cluster->points.columns;
        const MatrixXd& W = own.cluster->W;
        for (int point = 0; point < (int)W.cols(); point += 3)
        {
            const Eigen::Matrix<double, SIZE, 3> ofView = W.block<SIZE, 3>(own.first, point);
            column.diagonal.noalias() -= ofView.lazyProduct(ofView.transpose());
            size_t k = 0;
            for (; k < columns.size() && columns[k] < cameras; k++)
                ofBoth.col(columns[k]).noalias() += ofView.lazyProduct(W.block<1, 3>(k, point).transpose());
            for (; k < columns.size(); k += SIZE)
            {
                const int other = poses.at((columns[k] - cameras)/SIZE);
                if (other > poses.at(view))
                    column.blocks[entry[other]].noalias() -= W.block<SIZE, 3>(k, point).lazyProduct(ofView.transpose());
            }
        }
    }
    if (cameras > 0)        // an empty matrix has no rows to take
        equations.ofBoth.middleRows<SIZE>(SIZE*view) -= ofBoth;
}

//! From all but the cameras' own. Each pose by itself, the clusters in their order, so that threads make no difference.
void subtractFromPoses(const std::vector<EliminatedCluster>& clusters, NormalEquations& equations)
{
    const int cameras = (int)equations.ofCameras.cols(), views = equations.ofPoses.count();
    std::vector<std::vector<PoseColumns> > seen(views);
    for (const EliminatedCluster& cluster : clusters)
    {
        const std::vector<int>& columns = cluster.points.columns;
        size_t k = std::lower_bound(columns.begin(), columns.end(), cameras) - columns.begin();
        for (; k < columns.size(); k += SIZE)
            seen[(columns[k] - cameras)/SIZE].push_back({ &cluster, (int)k });
    }
    std::vector<int> some;              // of a strip few views see some points
    for (int view = 0; view < views; view++)
        if (!seen[view].empty())
            some.push_back(view);
    parallel_for_(Range(0, (int)some.size()), [&](const Range& range)
    {
        std::vector<int> entry(views);
        for (int i = range.start; i < range.end; i++)
            subtractPose(some[i], seen[some[i]], entry, equations);
    });
}

} // namespace

VectorXd dampedStep(const Information& information, double damping, double& gain)
{
    NormalEquations equations = *information.equations;
    const VectorXd gradient = equations.gradient, added = damping*equations.diagonal();
    equations.addToDiagonal(added);
    const VectorXd step = RootOfEquations(std::move(equations), information.effect, ROUNDING).step(information.effect, ROUNDING);
    gain = step.cwiseProduct(added).dot(step) - gradient.dot(step);
    return step;
}

Information eliminatePoints(const Problem& problem, const FreeSpace& space)
{
    NormalEquations equations(space.cameraCount(), graphOf(problem, space));
    addPriors(problem, space, equations);
    VectorXd squares = equations.diagonal();
    PassingRows images(problem, space);
    Information information;
    information.rounding = std::sqrt(ROUNDING);
    const int count = (int)problem.scene().clusters().size();
    information.inner.resize(count);
    for (int begin = 0; begin < count; begin += PassingRows::AT_ONCE)
    {
        std::vector<EliminatedCluster> some(std::min<int>(PassingRows::AT_ONCE, count - begin));
        addImages(images, images.moveTo(begin, begin + (int)some.size()), equations, squares);
        parallel_for_(Range(0, (int)some.size()), [&](const Range& range)
        {
            std::vector<int> place(space.count);
            for (int i = range.start; i < range.end; i++)
                some[i] = eliminate(problem, begin + i, images, place);
        });
        subtractFromCameras(some, equations);
        subtractFromPoses(some, equations);
        for (size_t i = 0; i < some.size(); i++)
        {
            information.ofInner += some[i].residual.squaredNorm();
            information.inner[begin + i] = std::move(some[i].points);
        }
    }
    information.effect = squares.cwiseSqrt();
    information.equations = std::make_shared<NormalEquations>(std::move(equations));
    return information;
}

void findRoot(Information& information)
{
    RootOfEquations root(*information.equations, information.effect, ROUNDING);
    information.root = std::move(root.ofCameras);
    information.residual = std::move(root.residual);
    information.poses = std::move(root.poses);
    information.ofInner += information.poses.residual.squaredNorm();
}

}} // namespace
