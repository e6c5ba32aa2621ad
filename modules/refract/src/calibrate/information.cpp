// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the residuals' derivatives J by the free parameters and K by the poses, the information on the parameters that is
left when the poses are unknown is

    A = sum over views of J^T (I - P_K) J,     P_K the projector on the range of K

It is kept as its square root R, A = R^T R, built by orthogonal transformations only, so that the condition number is not
squared; views whose points do not fix a pose need no special case. An image depends on few parameters: its rows are
reduced first, on their own columns. */

#include "calibrate/information.hpp"
#include <Eigen/QR>
#include <Eigen/SVD>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! One image's derivatives by its pose (6 columns) and by the free parameters that it depends on, and its residuals.
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
        rows.conservativeResize(Eigen::NoChange, rows.cols() + 1);
        rows.rightCols<1>() = d.residuals;
    }

    //! As few rows with the same products.
    void reduce()
    {
        const int least = (int)std::min(rows.rows(), rows.cols());
        const Eigen::HouseholderQR<MatrixXd> qr(rows);
        rows = MatrixXd(qr.matrixQR().topRows(least).triangularView<Eigen::Upper>());
    }

    //! Columns: all free parameters, the residual.
    MatrixXd spread(int count) const
    {
        MatrixXd all = MatrixXd::Zero(rows.rows(), count + 1);
        for (size_t i = 0; i < columns.size(); i++)
            all.col(columns[i]) = rows.col(6 + i);
        all.rightCols<1>() = rows.rightCols<1>();
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

/** The part of J that no change of the pose can imitate.
@param ofPose gets the squares of the last column's other part */
MatrixXd withoutPose(const MatrixXd& J, const MatrixXd& K, double& ofPose)
{
    const Eigen::RowVectorXd scale = K.colwise().norm().cwiseMax(DBL_MIN);
    Eigen::ColPivHouseholderQR<MatrixXd> qr;
    qr.setThreshold(1e-12);
    qr.compute(K.array().rowwise()/scale.array());
    const MatrixXd rotated = qr.householderQ().adjoint()*J;
    ofPose = rotated.topRows(qr.rank()).rightCols<1>().squaredNorm();
    return rotated.bottomRows(J.rows() - qr.rank());
}

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

} // namespace

Information rigInformation(const RigProblem& rig, bool withHeld)
{
    const FreeSpace space(rig, withHeld);
    const int count = space.count;
    Information information;
    information.ofPoses = 0;
    SquareRoot root(count + 1);
    VectorXd squares = VectorXd::Zero(count);
    for (int view = 0; view < rig.viewCount(); view++)
    {
        MatrixXd J(0, count + 1), K(0, 6);
        for (int i : rig.imagesOf(view))
        {
            ImageRows own(space, rig.derivatives(rig.images()[i]));
            own.reduce();
            J = stacked(J, own.spread(count));
            K = stacked(K, own.rows.leftCols<6>());
        }
        if (J.rows() == 0)
            continue;
        squares += J.leftCols(count).colwise().squaredNorm().transpose();
        if (rig.knowledgeOf(view) == PoseKnowledge::UNCERTAIN)
        {
            J = stacked(J, MatrixXd::Zero(6, count + 1));
            J.bottomRightCorner<6, 1>() = rig.priorOfPose(view);
            K = stacked(K, rig.priorByPose(view));
        }
        double ofPose;
        root.add(withoutPose(J, K, ofPose));
        information.ofPoses += ofPose;
    }
    for (int block = 0; block < (int)rig.blocks().size(); block++)
    {
        const MatrixXd byParameters = rig.priorByBlock(block)*space.bases[block];
        MatrixXd rows = MatrixXd::Zero(byParameters.rows(), count + 1);
        rows.middleCols(space.first[block], byParameters.cols()) = byParameters;
        rows.rightCols<1>() = rig.priorOfBlock(block);
        squares += rows.leftCols(count).colwise().squaredNorm().transpose();
        root.add(rows);
    }
    const MatrixXd triangle = root.triangle();
    information.root = triangle.topLeftCorner(count, count);
    information.residual = triangle.topRightCorner(count, 1);
    information.effect = squares.cwiseSqrt();
    return information;
}

double stepLeft(const RigProblem& rig)
{
    const double SINGULAR = 1e-9;       // what no data determine has no least squares
    const Information information = rigInformation(rig, false);
    const VectorXd scale = (information.effect.array() > 0).select(information.effect.cwiseInverse(), 0);
    Eigen::JacobiSVD<MatrixXd> svd(information.root*scale.asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeThinV);
    svd.setThreshold(SINGULAR);
    return std::sqrt((svd.matrixU().leftCols(svd.rank()).transpose()*information.residual).squaredNorm() + information.ofPoses);
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
