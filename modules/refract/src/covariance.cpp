// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the residuals' derivatives J by the free parameters and K by the poses, the information on the parameters that is
left when the poses are unknown is

    A = sum over views of J^T (I - P_K) J,     P_K the projector on the range of K

It is kept as its square root R, A = R^T R, built by orthogonal transformations only, so that the condition number is not
squared; views whose points do not fix a pose need no special case. An image depends on few parameters: its rows are
reduced first, on their own columns. Covariance = s^2 A^-1 with s^2 the variance of a pixel coordinate. */

#include "covariance.hpp"
#include <Eigen/QR>
#include <Eigen/SVD>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Below this part of its own effect, what a parameter does that others cannot do is the derivatives' rounding error.
const double SINGULAR = 1e-9;
// Nobody finds points better than this: without it, noise-free data would seem to determine anything.
const double LEAST_SIGMA = 0.01;

struct FreeParameter
{
    const RigBlock* block;
    int coordinate;
    String name;
    double hopeless;        //!< a standard deviation beyond this is no answer

    double value() const { return block->values[coordinate]; }
    bool isNumber() const { return block->kind == RigBlock::LENS || block->kind == RigBlock::MEDIA; }
};

double meanRange(const RigProblem& rig)
{
    double sum = 0;
    int count = 0;
    for (int view = 0; view < rig.viewCount(); view++)
        if (rig.pose(view).found)
        {
            sum += norm(rig.pose(view).tvec);
            count++;
        }
    return sum/count;
}

std::vector<FreeParameter> freeParameters(const RigProblem& rig)
{
    const double infinity = std::numeric_limits<double>::infinity(), range = meanRange(rig);
    std::vector<FreeParameter> parameters;
    for (const RigBlock& block : rig.blocks())
        for (int i = 0; i < (int)block.values.size(); i++)
        {
            if (!block.isFree[i] || (block.kind == RigBlock::NORMAL && i == 2))     // a normal has two
                continue;
            FreeParameter p;
            p.name = block.nameOf(i);
            if (rig.cameraCount() > (block.kind == RigBlock::EXTRINSICS ? 2 : 1))
                p.name += format(" of camera %d", block.camera + 1);
            p.block = &block;
            p.coordinate = i;
            const bool isAngle = block.kind == RigBlock::NORMAL || (block.kind == RigBlock::EXTRINSICS && i < 3);
            const bool isLength = block.kind == RigBlock::MEDIA ? i == 0 : block.kind == RigBlock::EXTRINSICS && i >= 3;
            p.hopeless = isAngle ? CV_PI/4 : isLength ? range :
                block.kind == RigBlock::MEDIA || i < 2 ? p.value() : infinity;
            parameters.push_back(p);
        }
    return parameters;
}

//! The free coordinates of each block, and where they stand among all.
struct FreeSpace
{
    explicit FreeSpace(const RigProblem& rig) : count(0)
    {
        for (const RigBlock& block : rig.blocks())
        {
            bases.push_back(block.tangentBasis());
            first.push_back(count);
            count += (int)bases.back().cols();
        }
    }
    std::vector<MatrixXd> bases;
    std::vector<int> first;
    int count;
};

//! One image's derivatives by its pose (6 columns) and by the free parameters that it depends on.
struct ImageRows
{
    ImageRows(const FreeSpace& space, const RigProblem::Derivatives& d)
    {
        rows = d.byPose;
        for (size_t i = 0; i < d.blocks.size(); i++)
        {
            const MatrixXd& basis = space.bases[d.blocks[i]];
            if (basis.cols() == 0)
                continue;
            const int before = (int)rows.cols();
            rows.conservativeResize(Eigen::NoChange, before + basis.cols());
            rows.rightCols(basis.cols()) = d.byBlock[i]*basis;
            for (int j = 0; j < basis.cols(); j++)
                columns.push_back(space.first[d.blocks[i]] + j);
        }
    }

    //! As few rows with the same products.
    void reduce()
    {
        const int least = (int)std::min(rows.rows(), rows.cols());
        const Eigen::HouseholderQR<MatrixXd> qr(rows);
        rows = MatrixXd(qr.matrixQR().topRows(least).triangularView<Eigen::Upper>());
    }

    MatrixXd spread(int count) const
    {
        MatrixXd all = MatrixXd::Zero(rows.rows(), count);
        for (size_t i = 0; i < columns.size(); i++)
            all.col(columns[i]) = rows.col(6 + i);
        return all;
    }

    MatrixXd rows;
    std::vector<int> columns;
};

MatrixXd stacked(const MatrixXd& top, const MatrixXd& bottom)
{
    MatrixXd both(top.rows() + bottom.rows(), bottom.cols());
    if (top.rows() > 0)
        both.topRows(top.rows()) = top;
    both.bottomRows(bottom.rows()) = bottom;
    return both;
}

//! The part of J that no change of the pose can imitate.
MatrixXd withoutPose(const MatrixXd& J, const MatrixXd& K)
{
    const Eigen::RowVectorXd scale = K.colwise().norm().cwiseMax(DBL_MIN);
    Eigen::ColPivHouseholderQR<MatrixXd> qr;
    qr.setThreshold(1e-12);
    qr.compute(K.array().rowwise()/scale.array());
    const MatrixXd rotated = qr.householderQ().adjoint()*J;
    return rotated.bottomRows(J.rows() - qr.rank());
}

struct Information
{
    MatrixXd root;          //!< upper triangular, root^T root = A
    VectorXd effect;        //!< of each parameter alone: the norm of its derivatives
};

//! Appends rows, and replaces all by the triangle with the same products when they are many.
class SquareRoot
{
public:
    explicit SquareRoot(int count) : rows_(8*count + 64, count), used_(0) {}

    void add(const MatrixXd& rows)
    {
        if (used_ + rows.rows() > rows_.rows())
            reduce();
        if (used_ + rows.rows() > rows_.rows())
            rows_.conservativeResize(used_ + rows.rows(), Eigen::NoChange);
        rows_.middleRows(used_, rows.rows()) = rows;
        used_ += (int)rows.rows();
    }

    MatrixXd triangle()
    {
        const int count = (int)rows_.cols();
        add(MatrixXd::Zero(count, count));
        reduce();
        return rows_.topRows(count);
    }

private:
    void reduce()
    {
        const int count = (int)rows_.cols();
        if (used_ <= count)
            return;
        const Eigen::HouseholderQR<MatrixXd> qr(rows_.topRows(used_));
        rows_.topRows(count) = qr.matrixQR().topRows(count).triangularView<Eigen::Upper>();
        used_ = count;
    }
    MatrixXd rows_;
    int used_;
};

std::vector<std::vector<const RigImage*> > imagesByView(const RigProblem& rig)
{
    std::vector<std::vector<const RigImage*> > images(rig.viewCount());
    for (const RigImage& image : rig.images())
        images[image.view].push_back(&image);
    return images;
}

Information informationOf(const RigProblem& rig)
{
    const FreeSpace space(rig);
    Information information;
    SquareRoot root(space.count);
    VectorXd squares = VectorXd::Zero(space.count);
    const std::vector<std::vector<const RigImage*> > images = imagesByView(rig);
    for (int view = 0; view < rig.viewCount(); view++)
    {
        MatrixXd J(0, space.count), K(0, 6);
        for (const RigImage* image : images[view])
        {
            ImageRows own(space, rig.derivatives(*image));
            own.reduce();
            J = stacked(J, own.spread(space.count));
            K = stacked(K, own.rows.leftCols<6>());
        }
        if (J.rows() == 0)
            continue;
        squares += J.colwise().squaredNorm().transpose();
        if (rig.knowledgeOf(view) == PoseKnowledge::UNCERTAIN)
        {
            J = stacked(J, MatrixXd::Zero(6, space.count));
            K = stacked(K, rig.priorByPose(view));
        }
        root.add(withoutPose(J, K));
    }
    information.root = root.triangle();
    information.effect = squares.cwiseSqrt();
    return information;
}

/** Throws, naming the parameters that take part in what is undetermined.
@param part of each parameter
@param dimension of what is undetermined
@param sigma standard deviations; may be empty */
void refuse(const std::vector<FreeParameter>& parameters, const VectorXd& part, int dimension, const VectorXd& sigma)
{
    std::vector<String> words;
    String hint;
    for (int i = 0; i < (int)parameters.size(); i++)
    {
        const FreeParameter& p = parameters[i];
        const auto takesPart = [&](int j) { return part[j] >= 0.2*part.maxCoeff(); };
        if (!takesPart(i))
            continue;
        String word = p.name;
        if (p.isNumber())
            word += format(" = %.4g", p.value());
        if (p.isNumber() && sigma.size() > 0)
            word += format(" +- %.2g", sigma[i]);
        if (std::find(words.begin(), words.end(), word) == words.end())     // two angles of one normal
            words.push_back(word);
        const int last = (int)p.block->values.size() - 1, layers = last/2 - 1;
        for (int j = i + 1; j < (int)parameters.size(); j++)
            if (p.block->kind == RigBlock::MEDIA && p.coordinate > 0 && parameters[j].block == p.block &&
                parameters[j].coordinate == p.coordinate + layers && takesPart(j))
                hint += format("; at small angles only thickness (1 - outerIndex/index) = %.4g shows",
                               p.value()*(1 - p.block->values[last]/parameters[j].value()));
    }
    String text;
    for (size_t i = 0; i < words.size(); i++)
        text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
    if ((int)words.size() > dimension)
        text += hint.empty() ? String("; only combinations of them show") : hint;
    CV_Error_(Error::StsNoConv, ("the views do not determine %s. Fix what is known otherwise, or add views: pairs without "
                                 "and with the window, more tilt, more depth", text.c_str()));
}

//! 1 for every parameter that is beyond its limit or tied to the worst one, else 0.
VectorXd hopelessPart(const MatrixXd& half, const VectorXd& excess, int worst)
{
    const double TIED = 0.9;        // correlation
    const MatrixXd unit = half.rowwise().normalized();
    VectorXd part = VectorXd::Zero(excess.size());
    for (int i = 0; i < excess.size(); i++)
        if (excess[i] > 1 || std::abs(unit.row(i).dot(unit.row(worst))) > TIED)
            part[i] = 1;
    return part;
}

//! Covariance of the free parameters; refuses if a direction is lost or a standard deviation is no answer.
MatrixXd freeCovariance(const RigProblem& rig, const std::vector<FreeParameter>& parameters, double variance)
{
    const Information information = informationOf(rig);
    for (int i = 0; i < (int)parameters.size(); i++)
        if (!(information.effect[i] > 0))
            refuse(parameters, VectorXd::Unit(parameters.size(), i), 1, VectorXd());

    const VectorXd scale = information.effect.cwiseInverse();
    const Eigen::JacobiSVD<MatrixXd> svd(information.root*scale.asDiagonal(), Eigen::ComputeFullV);
    const int undetermined = (int)(svd.singularValues().array() < SINGULAR).count();
    if (undetermined > 0)
        refuse(parameters, svd.matrixV().rightCols(undetermined).rowwise().norm(), undetermined, VectorXd());
    const MatrixXd half = scale.asDiagonal()*svd.matrixV()*svd.singularValues().cwiseInverse().asDiagonal();

    const double floor = std::max(variance, LEAST_SIGMA*LEAST_SIGMA);
    const VectorXd sigma = half.rowwise().norm()*std::sqrt(floor);
    VectorXd excess(parameters.size());
    for (int i = 0; i < (int)parameters.size(); i++)
        excess[i] = sigma[i]/parameters[i].hopeless;
    int worst;
    if (excess.maxCoeff(&worst) > 1)
        refuse(parameters, hopelessPart(half, excess, worst), 1, sigma);
    return variance*half*half.transpose();
}

} // namespace

MatrixXd rigCovariance(const RigProblem& rig, double variance)
{
    const MatrixXd free = freeCovariance(rig, freeParameters(rig), variance);
    const MatrixXd basis = rig.publicBasis();
    return basis*free*basis.transpose();
}

MatrixXd rigJacobian(const RigProblem& rig)
{
    const FreeSpace space(rig);
    const MatrixXd basis = rig.publicBasis();
    int rows = 0;
    for (const RigImage& image : rig.images())
        rows += 2*(int)image.points.pixel.size();
    MatrixXd jacobian = MatrixXd::Zero(rows, rig.publicCount() + 6*rig.viewCount());
    int row = 0;
    for (const RigImage& image : rig.images())
    {
        const ImageRows own(space, rig.derivatives(image));
        const int count = (int)own.rows.rows();
        for (size_t i = 0; i < own.columns.size(); i++)
            jacobian.block(row, 0, count, rig.publicCount()) += own.rows.col(6 + i)*basis.col(own.columns[i]).transpose();
        jacobian.block(row, rig.publicCount() + 6*image.view, count, 6) = own.rows.leftCols<6>();
        row += count;
    }
    return jacobian;
}

}} // namespace
