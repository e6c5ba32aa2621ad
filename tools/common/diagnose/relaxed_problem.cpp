// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/relaxed_fit.hpp"
#include "measure/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "math/dense.hpp"
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Inverse of a covariance, 0 for what has no variance (it is fixed) or an unknown one (NaN, about which nothing is known).
MatrixXd informationOf(MatrixXd covariance)
{
    const double NOTHING = 1e-12;
    for (Eigen::Index i = 0; i < covariance.rows(); i++)
        if (!(covariance(i, i) > 0.))
        {
            covariance.row(i).setZero();
            covariance.col(i).setZero();
        }
    const CorrelationSpectrum spectrum(covariance);
    const int rank = spectrum.rank(NOTHING);
    if (rank == 0)
        return MatrixXd::Zero(covariance.rows(), covariance.cols());
    const MatrixXd root = spectrum.inverseRoot(rank);
    return timesTranspose(root, root);
}

const double BEFORE_BOARDS = 0.2;       // of the range of the nearest board: where a window is, and how well that is known;
const double AT_MOST = 0.6;             // beyond this part boards reach into it

/** Parallel faces between equal media are indifferent to the distance. A wedge is not: its glass is as thick as where the light goes
through, and cameras that share it look through it at two places. Whatever is tested, it is then somewhere before the boards. */
bool showsDistanceByWedge(const Fit& fit, int camera)
{
    const ParameterColumns at = columnsOf(fit.rig, camera);
    const GlassWindow& window = fit.rig.cameras[camera]->window();
    return fit.rig.ownsWindow(camera) && !hasDifferentMedia(window) && at.wedge < at.curvature
        && fit.stdDeviations.at<double>(at.wedge) > 0.;
}

//! A fit that took the wedge for none held it; a cause that alone was free to say so would explain what only the held distance leaves.
bool holdsDistance(const Fit& fit, int camera) { return !(fit.stdDeviations.at<double>(columnsOf(fit.rig, camera).distance) > 0.); }

double nearestBoard(const Fit& fit)
{
    double nearest = INFINITY;
    for (const Vec3d& tvec : fit.tvecs)
        nearest = std::min(nearest, norm(tvec));
    return nearest;
}

//! What the fit estimated, a column each.
MatrixXd freeOf(const Fit& fit)
{
    const RigModel& rig = fit.rig;
    const int size = rigVectorSize(rig), targets = columnCount(rig);
    std::vector<VectorXd> columns;
    const auto add = [&](int number) { columns.push_back(VectorXd::Unit(size, number)); };
    const auto addFree = [&](int first, int end) {
        for (int i = first; i < end; i++)
            if (fit.stdDeviations.at<double>(i) > 0.)
                add(i);
    };
    const auto addAcross = [&](const Vec3d& axis, int first) {
        const Matx32d basis = tangents(axis);
        for (int k = 0; k < 2; k++)
        {
            columns.push_back(VectorXd::Zero(size));
            for (int i = 0; i < 3; i++)
                columns.back()[first + i] = basis(i, k);
        }
    };
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        addFree(at.lens, at.lens + at.lensCount);
        if (c > 0)
            addFree(extrinsicsColumn(rig, c), extrinsicsColumn(rig, c) + 6);
        if (!rig.ownsWindow(c))
            continue;
        const GlassWindow window = rig.cameras[c]->window();
        const Vec3d* const axis = at.has(at.normal) ? &window.normal : at.has(at.axis) ? &window.axis : nullptr;
        if (at.has(at.normal))
            addAcross(*axis, at.normal);
        else if (axis)          // a tube's centre moves along its axis without effect
        {
            addAcross(*axis, at.center);
            addAcross(*axis, at.axis);
        }
        else
            addFree(at.center, at.center + 3);
        addFree(at.thickness - 1, at.end);          // from the distance or the radius on
        if (showsDistanceByWedge(fit, c) && holdsDistance(fit, c))
            add(at.distance);
    }
    for (int i = 0; i < TARGET_ERRORS && !rig.targetCovariance.empty(); i++)
        if (rig.targetCovariance.at<double>(i, i) > 0.)
            add(targets + i);
    MatrixXd free(size, columns.size());
    for (size_t i = 0; i < columns.size(); i++)
        free.col(i) = columns[i];
    return free;
}

//! The seen points of a view at a pose.
ViewObservations observedAt(const View& view, int cameras, const Vec3d& rvec, const Vec3d& tvec)
{
    ViewObservations observed;
    observed.objectPoints = view.objectPoints;
    observed.rvec = rvec;
    observed.tvec = tvec;
    for (bool glass : {false, true})        // in this order, so that each state has one block of rows
        for (int c = 0; c < cameras; c++)
            addImage(view, c, glass, observed);
    return observed;
}

} // namespace

RelaxedProblem::RelaxedProblem(const RigData& data, const Fit& fit, bool posesKnown) : rig(fit.rig.clone()), free(freeOf(fit))
{
    const int size = rigVectorSize(rig);
    information = MatrixXd::Zero(size, size);
    known = VectorXd::Zero(size);
    for (int c = 0; c < (int)rig.known.size(); c++)
        if (!rig.known[c].covariance.empty())
            addKnownCamera(c);
    known[columnCount(rig)] = 1.;               // the targets' scale
    if (rig.targetCovariance.empty())
        rig.targetCovariance = Mat::zeros(TARGET_ERRORS, TARGET_ERRORS, CV_64F);     // so that poseInImage follows the motion
    else
        information.bottomRightCorner(TARGET_ERRORS, TARGET_ERRORS) = informationOf(toEigen(rig.targetCovariance));
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        if (showsDistanceByWedge(fit, c))
            freeDistance(fit, c);
    for (size_t k = 0; k < fit.views.size(); k++)
    {
        const View& view = data.views[fit.views[k]];
        views.push_back(observedAt(view, data.cameraCount, fit.rvecs[k], fit.tvecs[k]));
        if (!posesKnown)
            continue;
        const bool exact = view.pose->covariance.empty();
        poseInformation.push_back(exact ? MatrixXd::Constant(1, 1, INFINITY) : informationOf(toEigen(view.pose->covariance)));
        knownPoses.push_back(toVector(view.pose->rvec, view.pose->tvec));
    }
}

void RelaxedProblem::addKnownCamera(int c)
{
    const KnownCamera& camera = rig.known[c];
    const ParameterColumns at = columnsOf(rig, c);
    RigModel given = rig.clone();
    given.cameras[c]->setLensParameters(camera.lens);
    GlassWindow window = camera.window;
    const GlassWindow now = rig.cameras[c]->window();
    window.shape = now.shape;
    window.wedge.resize(now.wedge.size());
    const bool isNormalKnown = camera.covariance.rows > at.lensCount && at.has(at.normal)
        && camera.covariance.at<double>(at.normal - at.lens, at.normal - at.lens) > 0;
    if (!isNormalKnown)
        window.normal = now.normal;
    window.axis = now.axis;
    if (window.shape == WINDOW_TUBE)
        window.center = now.center;
    given.cameras[c]->setWindow(window);
    known.segment(at.lens, at.end - at.lens) = toVector(given).segment(at.lens, at.end - at.lens);
    const MatrixXd covariance = toEigen(camera.covariance);
    const int count = rig.ownsWindow(c) ? (int)covariance.rows() : std::min((int)covariance.rows(), at.lensCount);
    information.block(at.lens, at.lens, count, count) = informationOf(covariance.topLeftCorner(count, count));
}

void RelaxedProblem::freeDistance(const Fit& fit, int c)
{
    VectorXd numbers = toVector(rig);
    const int distance = columnsOf(rig, c).distance;
    const double nearest = nearestBoard(fit), somewhere = BEFORE_BOARDS*nearest;
    Eigen::Index column;
    free.row(distance).maxCoeff(&column);
    bounds.push_back({distance, (int)column, std::max(AT_MOST*nearest, 1.01*numbers[distance])});
    if (!holdsDistance(fit, c))
        return;
    known[distance] = numbers[distance] = somewhere;
    information(distance, distance) = 1./(somewhere*somewhere);
    rig = withVector(rig, numbers);
}

double RelaxedProblem::priorOf(const VectorXd& numbers) const
{
    const VectorXd off = numbers - known;
    return off.dot(timesVector(information, off));
}

VectorXd toVector(const Vec3d& rvec, const Vec3d& tvec)
{
    VectorXd pose(6);
    pose << rvec[0], rvec[1], rvec[2], tvec[0], tvec[1], tvec[2];
    return pose;
}

} // namespace tools
