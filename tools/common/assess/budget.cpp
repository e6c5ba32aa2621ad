// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/budget.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_error.hpp"
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! What is known before the images, and which of the estimated parameters it is of.
struct Source
{
    std::string name, given;
    std::vector<int> columns;       //!< of the covariance with the targets' errors
    Mat prior;                      //!< covariance of these
    double unit = 1.;               //!< of the values in which it is given, over that of the prior
};

std::vector<int> rangeOf(int first, int count)
{
    std::vector<int> all;
    for (int i = 0; i < count; i++)
        all.push_back(first + i);
    return all;
}

//! Those of a prior's rows that have a variance, shifted to where they are in the whole.
Source sourceOf(const std::string& name, const std::string& given, const Mat& prior, const std::vector<int>& rows, int first,
                double unit = 1.)
{
    Source source{name, given, {}, Mat(), unit};
    std::vector<int> own;
    for (int row : rows)
        if (prior.at<double>(row, row) > 0)
        {
            own.push_back(row);
            source.columns.push_back(first + row);
        }
    source.prior = partOf(prior, own, own);
    return source;
}

std::vector<Source> sourcesOfCamera(const RigCalibration& c, int k)
{
    const KnownCamera& known = c.fit.rig.known[k];
    if (known.covariance.empty())
        return {};
    const std::string whose = c.data.cameraCount == 1 ? "" : format(", camera %d", k + 1);
    const ParameterColumns own = columnsOf(*c.fit.rig.cameras[k]);
    const int first = columnsOf(c.fit.rig, k).lens;
    const GivenStd& std = c.options.std;
    const std::string length = " " + c.unit;
    std::string indices;                // of layers, one where all are equal
    for (size_t i = 0; i < std.index.size(); i++)
        if (i == 0 || std.index[i].text("") != std.index[i - 1].text(""))
            indices += (i ? ", " : "") + std.index[i].text("");
    const bool isOfFile = bool(c.options.known[k]);
    const std::string lens = isOfFile ? "lens" : "lens coefficients left out", of = isOfFile ? "its file" : "the images";
    std::vector<Source> sources = {sourceOf(lens + whose, of, known.covariance, rangeOf(0, own.lensCount), first)};
    if (known.covariance.rows == own.lensCount || !c.fit.rig.ownsWindow(k))
        return sources;
    const auto add = [&](const std::string& name, const std::string& given, int column, int count, double unit = 1.) {
        sources.push_back(sourceOf(name + whose, given, known.covariance, rangeOf(column, count), first, unit));
    };
    const double minutes = 1./ARC_MINUTE, degrees = 180./CV_PI;
    add("thickness", std.thickness.text(length), own.thickness, own.layers);
    add("index", indices, own.index, own.layers);
    add("wedge", std.wedge.text("'", minutes), own.wedge, own.curvature - own.wedge, minutes);
    const auto addIf = [&](const std::string& name, const std::string& given, int column, int count, double unit = 1.) {
        if (own.has(column))
            add(name, given, column, count, unit);
    };
    if (c.options.areMarkersGiven())    // they tell both together
        add("normal and distance", c.options.placeOption, own.normal, 4);
    else
    {
        addIf("normal", std.normal.text(" degrees", degrees), own.normal, 3, degrees);
        if (own.has(own.distance))
        {
            const double open = std::sqrt(known.covariance.at<double>(own.distance, own.distance));
            add("distance", (std.isDistanceOpen ? Std(open, "not given") : std.distance).text(length), own.distance, 1);
        }
    }
    addIf("radius", std.radius.text(length), own.radius, 1);
    addIf("centre", std.center.text(length), own.center, 3);
    addIf("bow", std.bow.text(" mm per m"), own.curvature, 1, bowOf(1., c.unit));
    add(INDEX_OF_MEDIUM, std.outerIndex.text(""), own.outerIndex, 1);
    return sources;
}

std::vector<Source> sourcesOf(const RigCalibration& c)
{
    std::vector<Source> sources;
    for (int k = 0; k < c.data.cameraCount && !c.fit.rig.known.empty(); k++)
        for (const Source& source : sourcesOfCamera(c, k))
            sources.push_back(source);
    const Mat& targets = c.fit.rig.targetCovariance;
    if (!targets.empty())
    {
        const int first = columnCount(c.fit.rig);
        sources.push_back(sourceOf(c.square > 0. ? SQUARE_OF_BOARD : SCALE_OF_TARGETS,
                                   c.square > 0. ? c.options.std.scale.text(" " + c.unit, c.square)
                                                 : c.options.std.scale.text(" %", 100.), targets, {0}, first,
                                   c.square > 0. ? c.square : 100.));
        sources.push_back(sourceOf("boards moved between direct and glass", c.options.std.placement.text(" " + c.unit), targets,
                                   rangeOf(1, 6), first));
    }
    sources.erase(std::remove_if(sources.begin(), sources.end(), [](const Source& s) { return s.columns.empty(); }), sources.end());
    return sources;
}

//! The standard deviation that all its values have; 0: they differ.
double commonStd(const Source& source)
{
    const Mat variances = source.prior.diag();
    double least, most;
    minMaxLoc(variances, &least, &most);
    return most - least < 1e-9*most ? source.unit*std::sqrt(most) : 0.;
}

//! W^(1/2), a column each direction that has a variance.
Mat rootOfInformation(const Mat& prior)
{
    const double NOTHING = 1e-12;
    const CorrelationSpectrum spectrum(toEigen(prior));
    return toMat(spectrum.inverseRoot(spectrum.rank(NOTHING)));
}

/* What was known before has the part C W C of the covariance C, which is no more than C where that is the inverse of all information.
Where a profile was wider than the least squares say, C was widened, and the parts are more than all: then along those directions they
are all. Empty: they are not; else the matrix that the parts' roots are to be multiplied by. */
MatrixXd noMoreThanAll(const Mat& covariance, const std::vector<Source>& sources)
{
    const double NOTHING = 1e-13, ROUNDING = 1e-9;
    const CorrelationSpectrum spectrum(toEigen(covariance));
    const int rank = spectrum.rank(NOTHING);
    if (rank == 0)
        return {};
    const MatrixXd root = spectrum.root(rank), inverseRoot = spectrum.inverseRoot(rank);
    MatrixXd parts = MatrixXd::Zero(rank, rank);        // of the unit matrix
    for (const Source& source : sources)
    {
        const Mat factor = partOf(covariance, rangeOf(0, covariance.rows), source.columns)*rootOfInformation(source.prior);
        const MatrixXd part = transposeTimes(inverseRoot, toEigen(factor));
        parts += product(part, part.transpose());
    }
    const SymmetricEigen eigen(parts);
    if (!(eigen.values.maxCoeff() > 1. + ROUNDING))
        return {};
    const VectorXd scales = eigen.values.array().max(1.).rsqrt();
    const MatrixXd scaled = product(MatrixXd(eigen.vectors*scales.asDiagonal()), eigen.vectors.transpose());
    return product(product(root, scaled), inverseRoot.transpose());
}

//! Mean squares of the errors of points in the working volume, and of their part that is pixel noise.
class Volume
{
public:
    explicit Volume(const RigCalibration& c) : c_(c), depth_(workingDepth(c, 0)) {}

    //! With this covariance of the calibration; the noise of the point's own pixels apart.
    double meanSquare(const Mat& covariance, double* pixelNoise = nullptr) const
    {
        Calibration calibration = calibrationOf(c_.fit.rig);
        calibration.covariance = covariance;
        ErrorSquares squares;
        for (double z : {depth_[0], depth_[1], depth_[2]})
            squares.add(mapErrors(calibration, z, c_.fit.sigma, COLUMNS));
        if (pixelNoise)
            *pixelNoise = squares.pixelNoise/squares.count;
        return squares.calibration/squares.count;
    }

private:
    static const int COLUMNS = 9;
    const RigCalibration& c_;
    const Vec3d depth_;
};

} // namespace

std::vector<UncertaintySource> uncertaintySources(const RigCalibration& c)
{
    const std::vector<int> cameras = rangeOf(0, columnCount(c.fit.rig));
    std::vector<UncertaintySource> sources;
    if (c.fit.withTargets.empty())
        return sources;
    const std::vector<Source> all = sourcesOf(c);
    const MatrixXd atMost = noMoreThanAll(c.fit.withTargets, all);
    for (const Source& source : all)
    {
        Mat factor = partOf(c.fit.withTargets, rangeOf(0, c.fit.withTargets.rows), source.columns)*rootOfInformation(source.prior);
        if (atMost.size() > 0)
            factor = toMat(product(atMost, toEigen(factor)));
        sources.push_back({source.name, source.given, commonStd(source), factor.rowRange(0, (int)cameras.size()).clone()});
    }
    return sources;
}

std::vector<BudgetRow> uncertaintyBudget(const RigCalibration& c)
{
    const Volume volume(c);
    double pixelNoise = 0.;
    const double calibration = volume.meanSquare(c.fit.covariance, &pixelNoise), total = calibration + pixelNoise;
    double left = calibration;
    std::vector<BudgetRow> rows;
    const auto add = [&](const std::string& source, const std::string& given, double square) {
        rows.push_back({source, given, std::sqrt(std::max(square, 0.)), std::max(square, 0.)/total});
    };
    for (const UncertaintySource& source : uncertaintySources(c))
    {
        const double square = volume.meanSquare(source.factor*source.factor.t());
        left -= square;
        add(source.name, source.given, square);
    }
    add(CALIBRATION_NOISE, "", left);
    add("noise of the point's own pixels", "", pixelNoise);
    add("total", "", total);
    return rows;
}

} // namespace tools
