// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DENSE_HPP
#define OPENCV_REFRACT_DENSE_HPP

#include <Eigen/Core>
#include <memory>

/* Products and decompositions of matrices of any size. Eigen's own are compiled in each source that has one, for a second to ten;
these are compiled once. Sources so include no more of Eigen than its core. */
namespace cv { namespace refract {

//! A matrix, or a block of one; what else is given is evaluated.
typedef Eigen::Ref<const Eigen::MatrixXd> MatrixRef;
typedef Eigen::Ref<const Eigen::VectorXd> VectorRef;

Eigen::MatrixXd product(const MatrixRef& A, const MatrixRef& B);                    //!< A B
Eigen::MatrixXd transposeTimes(const MatrixRef& A, const MatrixRef& B, double factor = 1); //!< factor A^T B
Eigen::MatrixXd timesTranspose(const MatrixRef& A, const MatrixRef& B);             //!< A B^T
Eigen::VectorXd timesVector(const MatrixRef& A, const VectorRef& x);                //!< A x
Eigen::VectorXd transposeTimesVector(const MatrixRef& A, const VectorRef& x, double factor = 1); //!< factor A^T x
Eigen::VectorXd diagonalOfProduct(const MatrixRef& A, const MatrixRef& B);       //!< diag(A B)
Eigen::MatrixXd propagated(const MatrixRef& C, const MatrixRef& A);                //!< A C A^T: the covariance of A x, by that of x
//! Adds factor A^T A to the lower half of C.
void addGram(const MatrixRef& A, double factor, Eigen::MatrixXd& C);

//! A^-1, by LU with partial pivoting.
Eigen::MatrixXd inverse(const MatrixRef& A);
//! A^-1, by minors.
Eigen::Matrix2d inverse2(const Eigen::Matrix2d& A);
Eigen::Matrix3d inverse3(const Eigen::Matrix3d& A);

//! A = L L^T, of the lower half of A.
class LLT
{
public:
    explicit LLT(const MatrixRef& A);
    bool isPositiveDefinite() const;
    Eigen::MatrixXd L() const;
    Eigen::MatrixXd solveL(const MatrixRef& B) const;           //!< L^-1 B

private:
    std::shared_ptr<const Eigen::LLT<Eigen::MatrixXd> > llt_;
};

//! A = L D L^T with the diagonal matrix D, of the lower half of A; L is a triangle of which rows are exchanged.
class LDLT
{
public:
    explicit LDLT(const MatrixRef& A);
    Eigen::MatrixXd L() const;
    Eigen::VectorXd D() const;
    Eigen::VectorXd solveL(const Eigen::VectorXd& b) const;     //!< L^-1 b
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;      //!< A^-1 b
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;      //!< A^-1 B
    Eigen::MatrixXd solveTranspose(const MatrixRef& B) const;   //!< A^-1 B^T
    Eigen::MatrixXd inverse() const;

private:
    std::shared_ptr<const Eigen::LDLT<Eigen::MatrixXd> > ldlt_;
};

//! Q R = A, by Householder.
class QR
{
public:
    explicit QR(const MatrixRef& A);
    Eigen::MatrixXd R() const;                                  //!< its upper rows, which are not 0; no more than A has
    Eigen::MatrixXd Q() const;                                  //!< a square
    Eigen::MatrixXd rotate(const MatrixRef& B) const;           //!< Q^T B
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;      //!< least squares
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

private:
    std::shared_ptr<const Eigen::HouseholderQR<Eigen::MatrixXd> > qr_;
};

//! Q R = A P, by Householder with the permutation P of columns that makes R's diagonal descend.
class PivotedQR
{
public:
    explicit PivotedQR(const MatrixRef& A);
    //! @param threshold what of R's diagonal is below this part of its largest is 0
    PivotedQR(const MatrixRef& A, double threshold);
    int rank() const;
    int column(int i) const;                                    //!< of A, which P makes the i-th
    Eigen::MatrixXd rotate(const MatrixRef& B) const;           //!< Q^T B
    Eigen::MatrixXd solveR(const MatrixRef& B) const;           //!< P R^-1 B, of the rank's part of R and rows of B
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;      //!< least squares
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

private:
    std::shared_ptr<const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> > qr_;
};

//! A^+, of least squares and, of these, the least norm. @param threshold as PivotedQR's
Eigen::MatrixXd pseudoInverse(const MatrixRef& A);
Eigen::MatrixXd pseudoInverse(const MatrixRef& A, double threshold);

//! A V = V diag(values), of the lower half of the symmetric A; values ascend.
struct SymmetricEigen
{
    explicit SymmetricEigen(const MatrixRef& A);
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

/** C = D R D of a covariance: the deviations D of parameters, whose sizes differ by orders, and their correlations R = U diag(values) U^T.
What has no variance has no part in anything. */
struct CorrelationSpectrum
{
    explicit CorrelationSpectrum(const MatrixRef& C);
    //! Values above this part of their sum, the last ones.
    int rank(double nothing = 0) const;
    Eigen::MatrixXd root(int rank) const;                       //!< S = D U sqrt(values), S S^T = C: a column for each of the last values
    Eigen::MatrixXd inverseRoot(int rank) const;                //!< T = D^-1 U / sqrt(values), T T^T = C^-1, T^T S = 1

    Eigen::VectorXd deviations, inverseDeviations;              //!< both 0 where there is no variance
    Eigen::VectorXd values;                                     //!< ascend
    Eigen::MatrixXd vectors;
};

//! As SymmetricEigen, of 3 x 3.
struct SymmetricEigen3
{
    explicit SymmetricEigen3(const Eigen::Matrix3d& A);
    Eigen::Vector3d values;
    Eigen::Matrix3d vectors;
};

//! U diag(values) V^T = A, values descend; V is a square. By Jacobi's rotations.
struct SingularValues
{
    explicit SingularValues(const MatrixRef& A);
    Eigen::VectorXd values;
    Eigen::MatrixXd V;
};

}} // namespace

#endif // OPENCV_REFRACT_DENSE_HPP
