// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet_fit.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double NEAR_PX = 3.;              // a point of the line is not farther from where the sheet puts it
const int ROUNDS = 6;
const double MAX_TILT_STD = 0.2;        // radians, of a plane that is determined

typedef std::shared_ptr<const SheetSurface> SheetPtr;

//! Generalised least squares on what is free of a sheet.
struct SheetStep
{
    VectorXd step;
    MatrixXd covariance, byParameters;
    double chiSquare = 0.;              //!< of the lines and the prior

    //! @param deviation from the prior, in its standard deviations; empty: there is none. @param left out of it, or -1
    SheetStep(const std::vector<ReducedLine>& lines, const VectorXd& deviation, double poseNoise, int left = -1)
    {
        const Eigen::Index free = lines[0].byState.cols();
        const bool prior = deviation.size() > 0;
        MatrixXd information = MatrixXd::Zero(free, free), gradientByParameters = MatrixXd::Zero(free, lines[0].byParameters.cols());
        VectorXd gradient = VectorXd::Zero(free);
        if (prior)
        {
            information.setIdentity();
            gradient = deviation;
        }
        for (size_t m = 0; m < lines.size(); m++)
        {
            if ((int)m == left)
                continue;
            const MatrixXd HtW = transposeTimes(lines[m].byState, lines[m].weight(poseNoise));
            information += product(HtW, lines[m].byState);
            gradient += timesVector(HtW, lines[m].e);
            gradientByParameters += product(HtW, lines[m].byParameters);
        }
        covariance = inverse(information);
        step = -timesVector(covariance, gradient);
        byParameters = -product(covariance, gradientByParameters);
        if (prior)
            chiSquare = (deviation + step).squaredNorm();
        for (size_t m = 0; m < lines.size(); m++)
            if ((int)m != left)
            {
                const VectorXd rest = lines[m].e + timesVector(lines[m].byState, step);
                chiSquare += rest.dot(timesVector(lines[m].weight(poseNoise), rest));
            }
    }
};

//! By how much the poses' errors must be larger for chi^2 to be what it should. A prior adds as many observations as unknowns.
double poseNoiseOf(const std::vector<ReducedLine>& lines, const VectorXd& deviation)
{
    double dof = deviation.size() > 0 ? 0. : -(double)lines[0].byState.cols();
    for (const ReducedLine& line : lines)
        dof += line.e.size();
    const auto chiSquare = [&](double noise) { return SheetStep(lines, deviation, noise).chiSquare; };
    double low = 1., high = 1.;
    if (dof <= 0. || chiSquare(low) <= dof)
        return 1.;
    while (chiSquare(high) > dof && high < 1e3)
        high *= 2.;
    for (int i = 0; i < 40; i++)
    {
        const double middle = 0.5*(low + high);
        (chiSquare(middle) > dof ? low : high) = middle;
    }
    return high;
}

//! What the points are off a straight line, and what of that is not white noise.
void judgeStraightness(const BoardImage& image, const SheetSurface& sheet, LineOnBoard& line)
{
    const std::vector<double> rest = straightResiduals(image, line.points, sheet);
    std::vector<double> variances;
    double squares = 0.;
    for (size_t k = 0; k < rest.size(); k++)
    {
        squares += rest[k]*rest[k];
        variances.push_back(std::pow(image.points[line.points[k]].ridge.sigma, 2));
    }
    line.rmsPx = std::sqrt(squares/rest.size());
    line.noise = excessNoise(rest, variances);
}

//! Of a parabola through the points.
void judgeBend(const LineRows& rows, LineOnBoard& line)
{
    const ReducedLine parabola(rows, 3);
    line.bend = -parabola.e[2];
    line.bendSigma = std::sqrt(parabola.ofNoise(2, 2));
}

void requireDetermined(const SheetStep& step)
{
    const bool regular = step.covariance.allFinite() && step.covariance(0, 0) > 0. && step.covariance(1, 1) > 0.;
    if (!regular || std::sqrt(std::max(step.covariance(0, 0), step.covariance(1, 1))) > MAX_TILT_STD)
        throw Failure("the lines do not determine the sheet of light: show the board at several distances, tilted in several ways, "
                      "so that its lines are not one line in space");
}

//! The images, and what is known of them.
struct Boards
{
    const std::vector<BoardImage>& images;
    const Calibration& calibration;
    double pixelSigma, scale;
};

//! A sheet, and the lines that it was estimated from.
struct Estimate
{
    SheetPtr sheet;
    std::vector<LineOnBoard> lines;
    std::vector<int> without, disagreeing;
    std::vector<LineRows> rows;
    std::vector<ReducedLine> reduced;
    double poseNoise = 1.;

    SheetStep step(int left = -1) const { return SheetStep(reduced, sheet->deviation(), poseNoise, left); }

    //! The lines where the sheet puts them.
    void findLines(const Boards& boards)
    {
        lines.clear();
        without.clear();
        for (size_t m = 0; m < boards.images.size(); m++)
        {
            LineOnBoard line;
            line.image = (int)m;
            if (std::find(disagreeing.begin(), disagreeing.end(), (int)m) != disagreeing.end())
                continue;
            line.points = pointsOnSheet(boards.images[m], *sheet, boards.scale, NEAR_PX);
            if (line.points.empty())
                without.push_back((int)m);
            else
                lines.push_back(line);
        }
        if (lines.size() < 2)
            throw Failure("the line was found on fewer than two boards: take images of the board at several distances and tilts");
    }
    void linearize(const Boards& boards)
    {
        rows.clear();
        reduced.clear();
        for (LineOnBoard& line : lines)
        {
            const BoardImage& image = boards.images[line.image];
            judgeStraightness(image, *sheet, line);
            rows.push_back(rowsOf(boards.calibration, image, line.points, *sheet, line.noise, boards.pixelSigma));
            reduced.emplace_back(rows.back(), sheet->coefficients());
        }
    }
    void fitPlane(const Boards& boards)
    {
        for (int round = 0; round < ROUNDS; round++)
        {
            findLines(boards);
            linearize(boards);
            poseNoise = poseNoiseOf(reduced, VectorXd());
            const SheetStep next = step();
            requireDetermined(next);
            if (round + 1 < ROUNDS)
                sheet = sheet->moved(next.step);
        }
    }
};

/** Boards whose line is another one, such as an edge: without them the errors of the others' poses are several times smaller. Each is
the one without which they are smallest.
@return images */
std::vector<int> disagreeingBoards(const Estimate& estimate)
{
    const double LARGE = SheetFit::LARGE_POSE_NOISE, SMALLER = 1.5;
    std::vector<ReducedLine> lines = estimate.reduced;
    std::vector<int> images, disagreeing;
    for (const LineOnBoard& line : estimate.lines)
        images.push_back(line.image);
    const size_t enough = std::max<size_t>(4, images.size() - images.size()/4);
    double noise = estimate.poseNoise;
    while (noise > LARGE && lines.size() > enough)
    {
        size_t best = 0;
        double least = INFINITY;
        for (size_t m = 0; m < lines.size(); m++)
        {
            std::vector<ReducedLine> others = lines;
            others.erase(others.begin() + (std::ptrdiff_t)m);
            const double without = poseNoiseOf(others, VectorXd());
            if (without < least)
            {
                least = without;
                best = m;
            }
        }
        if (least*SMALLER > noise)
            break;
        noise = least;
        disagreeing.push_back(images[best]);
        images.erase(images.begin() + (std::ptrdiff_t)best);
        lines.erase(lines.begin() + (std::ptrdiff_t)best);
    }
    return disagreeing;
}

Estimate estimatePlane(const Boards& boards)
{
    if (boards.images.size() == 1)
        throw Failure("one image of a board does not make a sheet of light: take ten or more, at several distances and tilts");
    const Vec4d start = planeOfMostLines(boards.images);
    if (start == Vec4d())
        throw Failure("no two images agree on a sheet of light: is the line on the boards, and of the colour that --laser says?");
    Estimate estimate;
    estimate.sheet = std::make_shared<PlaneSurface>(start);
    estimate.fitPlane(boards);
    estimate.disagreeing = disagreeingBoards(estimate);
    if (!estimate.disagreeing.empty())
        estimate.fitPlane(boards);
    return estimate;
}

//! From the lines that a plane found: first with these, then with those that lie on the emitter's sheet.
Estimate estimateEmitter(const Boards& boards, const EmitterPrior& prior, Estimate estimate)
{
    estimate.sheet = std::make_shared<EmitterSurface>(prior, prior.emitter());
    for (int round = 0; round < 2*ROUNDS; round++)
    {
        if (round >= ROUNDS)
            estimate.findLines(boards);
        estimate.linearize(boards);
        for (const LineRows& rows : estimate.rows)
            if (!rows.e.allFinite() || !rows.byState.allFinite())
                throw Failure("the emitter of '" + prior.filename() + "' sends no light to the boards: check rvec and tvec, which map "
                              "camera 1 to the emitter, and its window, which must be between it and the boards");
        estimate.poseNoise = round < ROUNDS ? 1. : poseNoiseOf(estimate.reduced, estimate.sheet->deviation());
        if (round + 1 < 2*ROUNDS)
            estimate.sheet = estimate.sheet->moved(estimate.step().step);
    }
    return estimate;
}

//! The plane nearest to the lines of a sheet that may be none.
Estimate nearestPlane(const Boards& boards, const Vec4d& start, Estimate estimate)
{
    estimate.sheet = std::make_shared<PlaneSurface>(start, 3);
    for (int round = 0; round < ROUNDS; round++)
    {
        estimate.linearize(boards);
        if (round + 1 < ROUNDS)
            estimate.sheet = estimate.sheet->moved(estimate.step().step);
    }
    return estimate;
}

//! Chance makes planes of two or three edges of boards.
void requireMostBoards(const Boards& boards, const Estimate& estimate)
{
    if (2*estimate.lines.size() < boards.images.size())
        throw Failure(format("only %zu of %zu boards have a line on the same sheet of light, which may be edges: say the line's colour "
                             "(--laser), give images without it (--laser-off), or leave out images that do not show it",
                             estimate.lines.size(), boards.images.size()));
}

Vec4d planeOf(const Estimate& estimate) { return static_cast<const PlaneSurface&>(*estimate.sheet).plane(); }

void judgeLines(const Boards& boards, Estimate& estimate, SheetFit& fit)
{
    std::vector<double> noises;
    const SheetStep all = estimate.step();
    double variances = 0., points = 0.;
    double nearest = INFINITY, farthest = -INFINITY;
    const MatrixXd C = covarianceOfCamera1(boards.calibration, estimate.rows[0].byParameters.cols());
    for (size_t m = 0; m < estimate.rows.size(); m++)
    {
        LineOnBoard& line = estimate.lines[m];
        const LineRows& rows = estimate.rows[m];
        judgeBend(rows, line);
        noises.push_back(line.noise);
        const SheetStep others = estimate.step((int)m);
        const VectorXd e = rows.e + timesVector(rows.byState, others.step);
        line.heldOut.rms = std::sqrt(e.squaredNorm()/e.size());
        const MatrixXd byParameters = rows.byParameters + product(rows.byState, others.byParameters);
        const double variance = rows.sigma.squaredNorm()
            + fit.poseNoise*fit.poseNoise*propagated(rows.ofPose, rows.byPose).trace()
            + propagated(others.covariance, rows.byState).trace()
            + propagated(C, byParameters).trace();
        line.heldOut.stated = std::sqrt(variance/e.size());
        const MatrixXd byCamera = product(rows.byState, all.byParameters);
        variances += propagated(all.covariance, rows.byState).trace() + propagated(C, byCamera).trace();
        points += e.size();
        for (int i : line.points)
        {
            const double z = boards.images[line.image].points[i].inCamera.z;
            nearest = std::min(nearest, z);
            farthest = std::max(farthest, z);
        }
    }
    fit.sheetStd = std::sqrt(variances/points);
    fit.sheet.lineNoise = median(noises);
    fit.sheet.depth = Vec2d(nearest, farthest);
}

} // namespace

double SheetFit::heldOutRms() const
{
    double sum = 0.;
    for (const LineOnBoard& line : lines)
        sum += std::pow(line.heldOut.rms, 2);
    return std::sqrt(sum/lines.size());
}

double SheetFit::heldOutRatio() const
{
    double sum = 0.;
    for (const LineOnBoard& line : lines)
        sum += std::pow(line.heldOut.rms/line.heldOut.stated, 2);
    return std::sqrt(sum/lines.size());
}

SheetFit fitSheet(const std::vector<BoardImage>& images, const Calibration& calibration, double pixelSigma, double scale,
                  const EmitterPrior* emitter)
{
    const Boards boards = {images, calibration, pixelSigma, scale};
    Estimate estimate = estimatePlane(boards);
    SheetFit fit;
    fit.sheet.plane = planeOf(estimate);
    if (emitter)
    {
        estimate = estimateEmitter(boards, *emitter, estimate);
        fit.sheet.emitter = static_cast<const EmitterSurface&>(*estimate.sheet).emitter();
        const Estimate plane = nearestPlane(boards, fit.sheet.plane, estimate);
        fit.sheet.plane = planeOf(plane);
        fit.planeExcess = plane.step().chiSquare - estimate.step().chiSquare;
        fit.moved = estimate.sheet->deviation().cwiseAbs().maxCoeff();
    }
    requireMostBoards(boards, estimate);
    fit.poseNoise = estimate.poseNoise;
    const SheetStep step = estimate.step();
    const MatrixXd basis = estimate.sheet->basis();
    fit.sheet.covariance = toMat(propagated(step.covariance, basis));
    fit.sheet.byParameters = toMat(product(basis, step.byParameters));
    fit.sheet.scale = scale;
    if (fit.sheet.plane[3] < 0.)
    {
        fit.sheet.plane = -fit.sheet.plane;
        if (!emitter)
            fit.sheet.byParameters = -fit.sheet.byParameters;
    }
    judgeLines(boards, estimate, fit);
    fit.lines = estimate.lines;
    fit.without = estimate.without;
    fit.disagreeing = estimate.disagreeing;
    return fit;
}

} // namespace tools
