// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/window_check.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/f_distribution.hpp"
#include "measure/view_observations.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int ITERATIONS = 20;
const double CONVERGED = 1e-9;          // radians
const double DEGREES = 180./CV_PI;
const char* const NO_TILT = "no tilt of the window explains the new images: did the target move between the images of a pair, or "
                            "are images and calibration not of the same cameras?";

//! A window whose tilt is looked for: n = n0 + basis delta, normalised.
struct FreeNormal
{
    int camera, column;         //!< of the normal in the parameters
    Eigen::Vector3d calibrated;
    Eigen::Matrix<double, 3, 2> basis;

    FreeNormal(const RigModel& rig, int c) : camera(c), column(columnsOf(rig, c).normal)
    {
        const Vec3d n = rig.cameras[c]->window().normal;
        calibrated << n[0], n[1], n[2];
        basis.col(0) = calibrated.cross(Eigen::Vector3d::UnitY()).normalized();
        basis.col(1) = calibrated.cross(basis.col(0));
    }
    Eigen::Vector3d at(const Eigen::Vector2d& delta) const { return calibrated + basis*delta; }
};

//! The new images against the calibration, linearised; the boards' poses projected out.
class CheckProblem
{
public:
    CheckProblem(const CheckInput& input, const std::vector<View>& views) : input_(input), rig_(input.rig.clone())
    {
        for (const View& view : views)
            observed_.push_back(observationsOf(input.rig, view));
        for (int c = 0; c < (int)rig_.cameras.size(); c++)
            if (std::any_of(views.begin(), views.end(), [c](const View& view) { return view.hasGlass(c); }))
                normals_.emplace_back(rig_, c);
        if (normals_.empty())
            throw Failure("there is no image through the window to check: give --glass");
        delta = VectorXd::Zero(2*normals_.size());
    }

    //! Gauss-Newton on tilts and poses.
    void solve()
    {
        for (int i = 0; i < ITERATIONS; i++)
            if (step() < CONVERGED)
                return;
        throw Failure(NO_TILT);
    }

    const std::vector<FreeNormal>& normals() const { return normals_; }

    VectorXd delta;             //!< two for each window
    MatrixXd covariance;        //!< of delta
    double chiSquare = 0.;      //!< r^T S^-1 r that is left
    int dof = 0;                //!< of it

private:
    double step()
    {
        MatrixXd A, B;
        VectorXd r;
        std::vector<ViewDerivatives> views;
        linearise(views, A, B, r);
        MatrixXd S = MatrixXd::Identity(r.size(), r.size())*(input_.sigma*input_.sigma);
        MatrixXd CAt = MatrixXd::Zero(A.cols(), A.rows());
        if (!input_.covariance.empty())
            CAt = toEigen(input_.covariance)*A.transpose();
        S += A*CAt;
        const Eigen::LDLT<MatrixXd> inverse(S);
        covariance = (B.transpose()*inverse.solve(B)).inverse();
        const VectorXd change = covariance*(B.transpose()*inverse.solve(r));
        if (!change.allFinite())
            throw Failure(NO_TILT);
        const VectorXd rest = r - B*change, weighted = inverse.solve(rest), parameters = CAt*weighted;
        chiSquare = rest.dot(weighted);
        dof = (int)(r.size() - delta.size());
        for (size_t i = 0; i < observed_.size(); i++)
            movePose(observed_[i], views[i], parameters, change);
        delta += change;
        for (size_t w = 0; w < normals_.size(); w++)
        {
            GlassWindow window = rig_.cameras[normals_[w].camera]->window();
            const Eigen::Vector3d n = normals_[w].at(delta.segment<2>(2*w)).normalized();
            window.normal = Vec3d(n[0], n[1], n[2]);
            rig_.cameras[normals_[w].camera]->setWindow(window);
        }
        return change.cwiseAbs().maxCoeff();
    }

    MatrixXd byTilts(const ViewDerivatives& view) const
    {
        MatrixXd B(view.byParameters.rows(), delta.size());
        for (size_t w = 0; w < normals_.size(); w++)
            B.middleCols(2*w, 2) = view.byParameters.middleCols(normals_[w].column, 3)*normals_[w].basis
                                     / normals_[w].at(delta.segment<2>(2*w)).norm();
        return B;
    }

    void linearise(std::vector<ViewDerivatives>& views, MatrixXd& A, MatrixXd& B, VectorXd& r) const
    {
        Eigen::Index rows = 0;
        for (const ViewObservations& observed : observed_)
            rows += observed.pixels.size() - 6;
        for (const ViewObservations& observed : observed_)
        {
            views.push_back(differentiateView(rig_, observed.objectPoints, observed.rvec, observed.tvec, observed.images));
            const ViewDerivatives& view = views.back();
            const PoseNullSpace project(view.byPose);
            const MatrixXd byParameters = project(view.byParameters);
            const Eigen::Index count = byParameters.rows();
            if (A.size() == 0)
            {
                A.resize(rows, view.byParameters.cols());
                B.resize(rows, delta.size());
                r.resize(rows);
                rows = 0;
            }
            A.middleRows(rows, count) = byParameters;
            B.middleRows(rows, count) = project(byTilts(view));
            r.segment(rows, count) = project(observed.pixels - view.predicted);
            rows += count;
        }
    }

    void movePose(ViewObservations& observed, const ViewDerivatives& view, const VectorXd& parameters, const VectorXd& change) const
    {
        const VectorXd r = observed.pixels - view.predicted - view.byParameters*parameters - byTilts(view)*change;
        const VectorXd pose = view.byPose.colPivHouseholderQr().solve(r);
        for (int i = 0; i < 3; i++)
        {
            observed.rvec[i] += pose[i];
            observed.tvec[i] += pose[3 + i];
        }
    }

    const CheckInput& input_;
    RigModel rig_;                   // the windows as they are now
    std::vector<ViewObservations> observed_;
    std::vector<FreeNormal> normals_;
};

} // namespace

CheckResult checkTilts(const CheckInput& input, const std::vector<View>& views, double falseAlarm)
{
    CheckProblem problem(input, views);
    problem.solve();
    CheckResult result;
    const size_t count = problem.normals().size();
    for (size_t w = 0; w < count; w++)
    {
        const FreeNormal& free = problem.normals()[w];
        const Eigen::Vector2d delta = problem.delta.segment<2>(2*w);
        const Eigen::Matrix2d V = problem.covariance.block<2, 2>(2*w, 2*w);
        const Eigen::Vector3d n = free.at(delta).normalized();
        const Eigen::Vector2d variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(V).eigenvalues();
        WindowCheck check;
        check.camera = free.camera;
        check.normal = Vec3d(n[0], n[1], n[2]);
        check.tiltDeg = std::atan(delta.norm())*DEGREES;
        check.stdDeg[0] = std::sqrt(variances[1])*DEGREES;
        check.stdDeg[1] = std::sqrt(variances[0])*DEGREES;
        check.probability = upperTailF(1, input.dof, 0.5*delta.dot(V.inverse()*delta));
        check.moved = check.probability < falseAlarm/count;
        result.windows.push_back(check);
    }
    // Pixels come in twos, and so do poses and tilts: the number of degrees of freedom is even.
    result.sigmaSeen = input.sigma*std::sqrt(problem.chiSquare/problem.dof);
    result.residualProbability = upperTailF(problem.dof/2, input.dof, problem.chiSquare/problem.dof);
    return result;
}

double powerOf(const WindowCheck& window, size_t windowCount, double dof, double falseAlarm, double tiltDeg, double share)
{
    const double lambda = tiltDeg*tiltDeg/(share*window.stdDeg[0]*window.stdDeg[0]);
    return upperTailNoncentralF2(dof, lambda, quantileF2(dof, falseAlarm/windowCount));
}

} // namespace tools
