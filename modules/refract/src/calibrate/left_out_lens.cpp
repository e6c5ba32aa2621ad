// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/left_out_lens.hpp"
#include "adjust/eliminate.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/** Of quantities of mean 0 that all have this standard deviation, as their estimates have the covariance C by themselves: these have
C + w^2. The largest that is hardly less likely than the likeliest one: that is 0 for what noise explains, and would say that
coefficients are exactly 0, which nobody knows. */
double largestLikelyWidth(const MatrixXd& C, const VectorXd& estimates)
{
    const double LESS_LIKELY = 0.5;                         // log likelihood
    const double LEAST = 1e-4, MOST = 1e4, STEP = 1.05;     // px
    const SymmetricEigen spectrum(C);
    const VectorXd along = transposeTimesVector(spectrum.vectors, estimates);
    std::vector<double> widths, unlikelihoods;
    for (double width = LEAST; width < MOST; width *= STEP)
    {
        double sum = 0;
        for (int i = 0; i < along.size(); i++)
        {
            const double variance = std::max(spectrum.values[i], 0.) + width*width;
            sum += std::log(variance) + along[i]*along[i]/variance;
        }
        widths.push_back(width);
        unlikelihoods.push_back(sum);
    }
    const double most = *std::min_element(unlikelihoods.begin(), unlikelihoods.end()) + 2*LESS_LIKELY;
    size_t i = widths.size() - 1;
    while (unlikelihoods[i] > most)
        i--;
    return widths[i];
}

//! How far a unit of each parameter moves the corners of an image round the principal point, px, the most of them.
VectorXd pixelsAtCorners(const Lens& lens)
{
    const std::vector<double> parameters = lens.parameters();
    const int count = (int)parameters.size();
    VectorXd most = VectorXd::Zero(count);
    for (const Vec2d& part : { Vec2d(0, 0), Vec2d(2, 0), Vec2d(0, 2), Vec2d(2, 2) })
    {
        const double u = part[0]*parameters[2], v = part[1]*parameters[3];
        Vec3d direction;
        uchar status = REFRACT_OK;
        lens.unproject(1, &u, &v, &direction[0], &direction[1], &direction[2], &status);
        Vec2d pixel;
        double byDirection[6];
        std::vector<double> by(2*count);
        if (status != REFRACT_OK || lens.projectJacobian(direction, pixel, byDirection, by.data()) != REFRACT_OK)
            continue;
        for (int i = 0; i < count; i++)
            most[i] = std::max(most[i], std::hypot(by[i], by[count + i]));
    }
    return most;
}

//! A parameter that was left out, and what the data say of it.
struct LeftOut
{
    int index;                  //!< in its lens
    bool isTangential;
    double pixels;              //!< at the corner, of a unit
    double estimate;
    VectorXd half;              //!< row of a root of the covariance
};

//! Of one camera; nothing of those that the data, or the corners, do not show.
std::vector<LeftOut> leftOutOf(const Problem& problem, int camera, const std::vector<bool>& isLeftOut, const MatrixXd& half,
                               const VectorXd& step)
{
    const FreeSpace space(problem, false);
    const auto isLens = [&](const ParameterBlock& block) { return block.kind == ParameterBlock::LENS && block.index == camera; };
    const auto lens = std::find_if(problem.blocks().begin(), problem.blocks().end(), isLens);
    const VectorXd pixels = pixelsAtCorners(problem.rig().cameras[camera].lens());
    std::vector<LeftOut> all;
    int column = space.first[lens - problem.blocks().begin()];
    for (int i = 0; i < (int)isLeftOut.size(); i++)
    {
        if (!lens->isFree[i])
            continue;
        if (isLeftOut[i] && pixels[i] > 0 && !half.row(column).isZero(0))
            all.push_back({ i, lens->names[i].find("p") == 0, pixels[i], step[column], half.row(column) });
        column++;
    }
    return all;
}

} // namespace

std::vector<Mat> priorsOfLeftOut(const Problem& problem, const std::vector<std::vector<bool> >& isLeftOut)
{
    const Information information = informationOf(problem, false);
    const MatrixXd half = pseudoInverseRoot(information);
    const VectorXd step = -timesVector(half, information.residual);
    const double variance = problem.squaredError()/std::max(problem.freedom(), 1);
    std::vector<Mat> priors;
    for (int camera = 0; camera < (int)isLeftOut.size(); camera++)
    {
        const int count = (int)isLeftOut[camera].size();
        Mat_<double> prior(count, count, std::numeric_limits<double>::quiet_NaN());
        for (int r = 0; r < count; r++)
            for (int c = 0; c < count; c++)
                if (isLeftOut[camera][r] && isLeftOut[camera][c])
                    prior(r, c) = 0;
        const std::vector<LeftOut> all = leftOutOf(problem, camera, isLeftOut[camera], half, step);
        for (const bool isTangential : { false, true })
        {
            std::vector<LeftOut> some;
            std::copy_if(all.begin(), all.end(), std::back_inserter(some), [=](const LeftOut& parameter)
                         { return parameter.isTangential == isTangential; });
            const int n = (int)some.size();
            MatrixXd C(n, n);
            VectorXd estimates(n);
            for (int r = 0; r < n; r++)
            {
                estimates[r] = some[r].pixels*some[r].estimate;
                for (int c = 0; c < n; c++)
                    C(r, c) = variance*some[r].pixels*some[c].pixels*some[r].half.dot(some[c].half);
            }
            const double width = n > 0 ? largestLikelyWidth(C, estimates) : 0;
            for (const LeftOut& parameter : some)
                prior(parameter.index, parameter.index) = std::pow(width/parameter.pixels, 2);
        }
        priors.push_back(prior);
    }
    return priors;
}

}} // namespace
