// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/checked_stereo.hpp"
#include "calibrate/parameter_columns.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/rig_vector.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv::refract;

namespace tools {

using cv::Mat;
using cv::Point;

namespace {

const double LEFT_OVER = 0.03;          // px that a matcher and maps for found depths leave
const double NOT_STATED = 0.05;         // px that a good calibration leaves, where the file has no covariance

//! Derivatives of the regions' row offsets, and of the shares of their depths, by all parameters of the calibration.
class RowModel
{
public:
    RowModel(const RectifiedRig& rig, const DenseStereo& stereo, const std::vector<RowCell>& cells) : model_(modelOf(rig.calibration()))
    {
        std::vector<cv::Point3d> points;
        for (const RowCell& cell : cells)
        {
            const cv::Vec3f X = stereo.points.at<cv::Vec3f>(cell.at);
            points.emplace_back(X[0], X[1], X[2]);
            offsets_.push_back(cell.offset);
            sigmas_.push_back(cell.sigma);
        }
        const int n = (int)points.size();
        byParameters = depthByParameters = MatrixXd::Zero(n, columnCount(model_));
        if (n == 0)
            return;
        PointDerivatives derivatives[2];
        for (int c = 0; c < 2; c++)
            derivatives[c] = differentiatePoints(model_.cameras[c], points, rotationVector(model_.extrinsics[c].R), model_.extrinsics[c].t);
        for (int i = 0; i < n; i++)
            addRow(derivatives, points[i].z, i, rig.vertical());
    }

    VectorXd offsets() const { return Eigen::Map<const VectorXd>(offsets_.data(), (Eigen::Index)offsets_.size()); }
    VectorXd sigmas() const { return Eigen::Map<const VectorXd>(sigmas_.data(), (Eigen::Index)sigmas_.size()); }
    const RigModel& model() const { return model_; }
    MatrixXd byParameters, depthByParameters;

private:
    /* Four coordinates, three of a point: what is left over is the difference of the rows over sqrt(2). If the parameters change
    and the pixels stay, the point moves. */
    void addRow(const PointDerivatives* derivatives, double z, int i, bool vertical)
    {
        Eigen::Matrix<double, 4, 3> J;
        MatrixXd A = MatrixXd::Zero(4, byParameters.cols());
        for (int c = 0; c < 2; c++)
        {
            J.middleRows(2*c, 2) = product(derivatives[c].byPose.block(2*i, 3, 2, 3), toEigen(cv::Mat(model_.extrinsics[c].R)));
            const MatrixXd& byCamera = derivatives[c].byParameters;
            A.block(2*c, columnsOf(model_, c).lens, 2, byCamera.cols()) = byCamera.middleRows(2*i, 2);
        }
        A.block(2, extrinsicsColumn(model_, 1), 2, 6) = derivatives[1].byPose.middleRows(2*i, 2);
        if (!J.allFinite() || !A.allFinite())
            return;
        const QR qr(J);
        const VectorXd over = qr.Q().col(3);
        const double sign = over[vertical ? 0 : 1] > 0 ? 1 : -1;
        byParameters.row(i) = transposeTimesVector(A, sign*std::sqrt(2.)*over);
        depthByParameters.row(i) = -qr.solve(A).row(2)/z;
    }

    RigModel model_;
    std::vector<double> offsets_, sigmas_;
};

//! What may have changed, by parameters that change together, each with the size of a usual change.
struct Cause
{
    std::string name, unit;
    double scale;                           //!< of the unit
    std::vector<VectorXd> directions;       //!< of all parameters
};

std::vector<Cause> causesOf(const RigModel& model)
{
    const int count = columnCount(model), place = extrinsicsColumn(model, 1);
    const double TILT = 0.1, TURN = 0.02, SHIFT = 0.02, THICKER = 0.1, DEGREES = 180/CV_PI;
    const auto along = [&](int column, double size) { return VectorXd(size*VectorXd::Unit(count, column)); };
    std::vector<Cause> causes;
    Cause tilts = {"a tilt of both windows", " degrees", DEGREES, {}};
    std::vector<Cause> thicker;
    for (int c = 0; c < 2; c++)
    {
        const ParameterColumns columns = columnsOf(model, c);
        if (columns.layers == 0)
            continue;
        const bool isFlat = columns.has(columns.normal);
        const double radius = model.cameras[c]->window().radius;
        Cause tilt = {cv::format(isFlat ? "a tilt of the window of camera %d" : "a motion of the dome or tube of camera %d", c + 1),
                      isFlat ? " degrees" : "", isFlat ? DEGREES : 1, {}};
        for (int k = 0; k < 3; k++)
            tilt.directions.push_back(along(columns.window + k, isFlat ? TILT : SHIFT*radius));
        if (isFlat)
            tilts.directions.insert(tilts.directions.end(), tilt.directions.begin(), tilt.directions.end());
        causes.push_back(tilt);
        VectorXd all = VectorXd::Zero(count);
        for (int k = 0; k < columns.layers; k++)
            all += along(columns.thickness + k, THICKER*model.cameras[c]->window().thickness[k]);
        thicker.push_back({cv::format("another thickness of the window of camera %d", c + 1), "", 1, {all}});
    }
    if (thicker.size() == 2)
    {
        if (!tilts.directions.empty())
            causes.push_back(tilts);
        thicker.push_back({"another thickness of both windows", "", 1, {thicker[0].directions[0] + thicker[1].directions[0]}});
    }
    causes.insert(causes.end(), thicker.begin(), thicker.end());
    Cause turn = {"a turn of camera 2", " degrees", DEGREES, {}}, moved = {"a motion of camera 2", "", 1, {}};
    for (int k = 0; k < 3; k++)
    {
        turn.directions.push_back(along(place + k, TURN));
        moved.directions.push_back(along(place + 3 + k, SHIFT*norm(model.extrinsics[1].t)));
    }
    causes.push_back(turn);
    causes.push_back(moved);
    return causes;
}

//! Of what is one number, that number; of vectors the length of the longest.
double sizeOf(const VectorXd& change, const Cause& cause)
{
    if (cause.directions.size() < 3)
        return change.cwiseAbs().maxCoeff();
    double longest = 0;
    for (size_t k = 0; k < cause.directions.size(); k += 3)
    {
        Eigen::Index first;
        cause.directions[k].cwiseAbs().maxCoeff(&first);
        longest = std::max(longest, change.segment(first, 3).norm());
    }
    return longest;
}

struct Explanation
{
    double left, depthChange, size;
};

//! The most likely change of a cause, if its directions are as large as usual or, where the rows want that, larger.
Explanation explain(const RowModel& model, const Cause& cause, const VectorXd& sigma)
{
    MatrixXd directions(model.byParameters.cols(), (Eigen::Index)cause.directions.size());
    for (size_t k = 0; k < cause.directions.size(); k++)
        directions.col((Eigen::Index)k) = cause.directions[k];
    const VectorXd weights = sigma.cwiseInverse();
    const MatrixXd G = weights.asDiagonal()*product(model.byParameters, directions);
    const VectorXd r = weights.cwiseProduct(model.offsets());
    const MatrixXd N = transposeTimes(G, G) + MatrixXd::Identity(G.cols(), G.cols());
    const VectorXd p = LDLT(N).solve(transposeTimesVector(G, r)), change = timesVector(directions, p);
    const double n = (double)r.size();
    return {(r - timesVector(G, p)).norm()/std::sqrt(n), timesVector(model.depthByParameters, change).norm()/std::sqrt(n),
            sizeOf(change, cause)};
}

//! The causes that explain the rows about as well as the best, and what they do to depths.
void explainRows(const RowModel& model, const VectorXd& sigma, RowCheck& result)
{
    const double AS_GOOD = 1.3, POSSIBLE = 2, EXPLAINED = 0.5;
    const std::vector<Cause> causes = causesOf(model.model());
    std::vector<Explanation> explanations;
    double best = INFINITY;
    for (const Cause& cause : causes)
    {
        explanations.push_back(explain(model, cause, sigma));
        best = std::min(best, explanations.back().left);
    }
    const double before = model.offsets().cwiseQuotient(sigma).norm()/std::sqrt((double)sigma.size());
    for (size_t i = 0; i < causes.size(); i++)
    {
        const Explanation& e = explanations[i];
        if (e.left <= POSSIBLE*best)
            result.depthChange = std::max(result.depthChange, e.depthChange);
        if (e.left <= AS_GOOD*best && e.left < EXPLAINED*before)
            result.causes += (result.causes.empty() ? "" : " or ") + causes[i].name + cv::format(" by %.2g", e.size*causes[i].scale)
                             + causes[i].unit;
    }
}

} // namespace

static bool isPoint(const cv::Vec3f& X) { return X[2] == X[2]; }

//! Regions all over the image, where they have enough points.
static std::vector<RowCell> rowCellsOf(const DenseStereo& stereo)
{
    const Mat& values = stereo.rowOffset;
    const int PATCH = 13*13, SIDE = 80, EVERY = 2, MOST = 8, ENOUGH = 200;
    const int columns = std::clamp(values.cols/SIDE, 1, MOST), rows = std::clamp(values.rows/SIDE, 1, MOST);
    std::vector<RowCell> result;
    for (int i = 0; i < columns*rows; i++)
    {
        const int column = i % columns, row = i/columns;
        std::vector<std::pair<float, Point>> cell;
        for (int y = values.rows*row/rows; y < values.rows*(row + 1)/rows; y += EVERY)
            for (int x = values.cols*column/columns; x < values.cols*(column + 1)/columns; x += EVERY)
                if (values.at<float>(y, x) == values.at<float>(y, x) && isPoint(stereo.points.at<cv::Vec3f>(y, x)))
                    cell.push_back({values.at<float>(y, x), Point(x, y)});
        if ((int)cell.size() < ENOUGH)
            continue;
        const auto less = [](const std::pair<float, Point>& a, const std::pair<float, Point>& b) { return a.first < b.first; };
        const auto at = [&](double part) {
            const auto place = cell.begin() + (int)(part*((double)cell.size() - 1));
            std::nth_element(cell.begin(), place, cell.end(), less);
            return *place;
        };
        // Half of normal numbers are within 0.6745 sigma, and the median of n has 1.2533 times the mean's deviation.
        const double spread = (at(0.75).first - at(0.25).first)/(2*0.6745);
        const double independent = std::max(1., (double)cell.size()*EVERY*EVERY/PATCH);
        const auto median = at(0.5);
        result.push_back({median.second, median.first, 1.2533*spread/std::sqrt(independent)});
    }
    return result;
}

//! RMS of their offsets; NaN if there are none.
static double rowOffsetOf(const std::vector<RowCell>& cells)
{
    double squares = 0;
    for (const RowCell& cell : cells)
        squares += cell.offset*cell.offset;
    return cells.empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(squares/(double)cells.size());
}

RowCheck checkRows(const RectifiedRig& rig, const DenseStereo& stereo)
{
    RowCheck result;
    const std::vector<RowCell> cells = rowCellsOf(stereo);
    result.found = rowOffsetOf(cells);
    const RowModel model(rig, stereo, cells);
    const VectorXd r = model.offsets();
    const int n = (int)r.size();
    if (n == 0)
        return result;
    const cv::Mat& covariance = rig.calibration().covariance;
    const VectorXd own = (model.sigmas().array().square() + LEFT_OVER*LEFT_OVER).sqrt();
    MatrixXd S = own.array().square().matrix().asDiagonal();
    if (covariance.empty())
        S.diagonal().array() += NOT_STATED*NOT_STATED;
    else
        S += propagated(toEigen(covariance), model.byParameters);
    result.expected = std::sqrt(S.trace()/n);
    result.times = std::sqrt(r.dot(LDLT(S).solve(r))/n);
    if (result.contradicts())
        explainRows(model, own, result);
    return result;
}

} // namespace tools
