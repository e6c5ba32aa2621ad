// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The likelihood's profile of a window's distance, or of a coordinate of a dome's centre: the least squares at each, all else being
fitted. What follows is said of a distance; of a sealed rig the centre of a dome is known as badly, and the lens follows it.

With derivatives that stayed the same, it would be a parabola: three standard deviations from the best distance the sum of squares
would be larger by 3^2 variances. Of a window far before a long lens it is flat and bent, and the other parameters follow on a
curve. So it is followed to both sides to where it is larger by as much. The way to there, of all parameters together, is three
standard deviations: with H the half of the covariance, h the unit vector along the distance's row of H, and v a third of the way,

    H' = H + (v - H h) h^T,    H' H'^T = covariance at a known distance + v v^T.

Where a target or the camera ends the way before, the best distance is no nearer to that end than the profile says, and two standard
deviations at most. */

#include "adjust/distance_profile.hpp"
#include "adjust/inner.hpp"
#include "adjust/minimize.hpp"
#include "math/dense.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::VectorXd;

const double SIGMAS = 3;                // where the profile's width is read
const double TO_AN_END = 2;             // standard deviations, if the profile is flat to there
const double WEAK = 0.02;               // part of the way from the window to the targets, or of a radius: what is known better has a
                                        // parabola
const double WIDER = 1.05;              // what is wider by less is as stated

//! From a window at this distance to the targets, roughly; of a scene, which may be anywhere, the distance itself.
double gapBehind(const Problem& problem, double distance)
{
    if (problem.hasScene())
        return distance;
    return std::max(meanRange(problem.poses()) - distance, 0.);
}

VectorXd valuesOf(const Problem& problem)
{
    const VectorXd inner = innerValues(problem);
    int count = 0;
    for (int b = 0; b < problem.outerCount(); b++)
        count += (int)problem.blocks()[b].values.size();
    VectorXd all(count + inner.size());
    int at = 0;
    for (int b = 0; b < problem.outerCount(); b++)
    {
        const auto& values = problem.blocks()[b].values;
        all.segment(at, values.size()) = values;
        at += (int)values.size();
    }
    all.tail(inner.size()) = inner;
    return all;
}

void setValues(Problem& problem, const VectorXd& all)
{
    int at = 0;
    for (int b = 0; b < problem.outerCount(); b++)
    {
        auto& values = problem.blocks()[b].values;
        values = all.segment(at, values.size());
        at += (int)values.size();
    }
    problem.updateCameras();
    setInnerValues(problem, all.tail(all.size() - at));
}

//! How all values change with the free coordinates of the outer blocks, to first order.
VectorXd changeOfValues(const Problem& problem, const FreeSpace& space, const Information& information, const VectorXd& free)
{
    VectorXd change = VectorXd::Zero(valuesOf(problem).size());
    int at = 0;
    for (int b = 0; b < problem.outerCount(); b++)
    {
        const int size = (int)problem.blocks()[b].values.size();
        if (space.columnsOf(b) > 0)
            change.segment(at, size) = timesVector(space.bases[b], free.segment(space.first[b], space.columnsOf(b)));
        at += size;
    }
    for (const InnerBlock& inner : information.inner)
    {
        VectorXd own(inner.columns.size());
        for (size_t k = 0; k < inner.columns.size(); k++)
            own[k] = free[inner.columns[k]];
        change.segment(at, inner.byOuter.rows()) = timesVector(inner.byOuter, own);
        at += (int)inner.byOuter.rows();
    }
    return change;
}

//! The change of the outer blocks as one of their free coordinates.
VectorXd freeChange(const Problem& problem, const FreeSpace& space, const VectorXd& change)
{
    VectorXd free(space.count);
    int at = 0;
    for (int b = 0; b < problem.outerCount(); b++)
    {
        const int size = (int)problem.blocks()[b].values.size();
        if (space.columnsOf(b) > 0)
            free.segment(space.first[b], space.columnsOf(b)) = transposeTimesVector(space.bases[b], change.segment(at, size));
        at += size;
    }
    return free;
}

//! One window's distance, or a coordinate of its centre, which is fixed while this lives.
class PlaceProfile
{
public:
    /** @param step the change of all values for one standard deviation of the distance */
    PlaceProfile(Problem& problem, int block, int coordinate, const VectorXd& step, double variance);
    ~PlaceProfile();
    //! The change of all values, for one standard deviation to one side as the profile has them.
    VectorXd towards(int side) const;

private:
    double excess(double sigmas, const VectorXd& start, VectorXd& change) const;
    VectorXd widest(const VectorXd& ofAll, const VectorXd& shares) const;
    Problem& problem_;
    const std::vector<ParameterBlock> before_;      //!< what is free and held
    const int block_, coordinate_;
    int index_;                                     //!< of the distance in all values
    const VectorXd best_, step_;
    const double variance_, least_;
};

PlaceProfile::PlaceProfile(Problem& problem, int block, int coordinate, const VectorXd& step, double variance)
    : problem_(problem), before_(problem.blocks()), block_(block), coordinate_(coordinate), index_(coordinate), best_(valuesOf(problem)),
      step_(step), variance_(variance), least_(problem.squaredError())
{
    for (int b = 0; b < block; b++)
        index_ += (int)problem.blocks()[b].values.size();
    problem.blocks()[block].isFree[coordinate] = false;
}

PlaceProfile::~PlaceProfile()
{
    for (size_t b = 0; b < before_.size(); b++)
    {
        problem_.blocks()[b].isFree = before_[b].isFree;
        problem_.blocks()[b].isHeld = before_[b].isHeld;
    }
    setValues(problem_, best_);
}

/** By how many variances the least squares at another distance are larger than at the best; infinite where some point has no image.
@param start in the direction of this change of all values
@param change out */
double PlaceProfile::excess(double sigmas, const VectorXd& start, VectorXd& change) const
{
    const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-7);
    setValues(problem_, best_ + start*(sigmas*step_[index_]/start[index_]));
    for (size_t b = 0; b < before_.size(); b++)
        problem_.blocks()[b].isHeld = before_[b].isHeld;
    for (ParameterBlock& block : problem_.blocks())
    {
        block.values = block.values.cwiseMax(Eigen::Map<const VectorXd>(block.lower.data(), block.lower.size()));
        if (block.isOnManifold())
            block.values.tail<3>().normalize();         // a normal, or the axis behind a center
    }
    problem_.updateCameras();
    if (!minimize(problem_, criteria).isUsable())
        return std::numeric_limits<double>::infinity();
    change = valuesOf(problem_) - best_;
    return (problem_.squaredError() - least_)/variance_;
}

/** What other values change by for one standard deviation, where they are far off before the end of the way: it is bent.
@param shares changes on the way, by their standard deviations */
VectorXd PlaceProfile::widest(const VectorXd& ofAll, const VectorXd& shares) const
{
    VectorXd change = (shares.array().abs() > ofAll.array().abs()).select(shares, ofAll);
    change[index_] = ofAll[index_];
    return change;
}

VectorXd PlaceProfile::towards(int side) const
{
    const int STEPS = 12;
    const double SHORT = 0.05;          // part of the way
    const double lower = problem_.blocks()[block_].lower[coordinate_];
    const double end = side < 0 ? (best_[index_] - lower)/step_[index_] : std::numeric_limits<double>::infinity();
    VectorXd last = VectorXd::Zero(step_.size()), shares = last, direction = step_;
    double inside = 0, root = 0, step = SIGMAS;         // standard deviations by the derivatives, and by the profile
    bool hasFailed = false;
    for (int i = 0; i < STEPS && step > SHORT*inside && inside < end; i++)
    {
        const double sigmas = std::min(inside + step, end);
        VectorXd change;
        const double squares = excess(side*sigmas, direction, change);
        if (std::isinf(squares))
        {
            step /= 2;
            hasFailed = true;
            continue;
        }
        const double there = std::sqrt(std::max(squares, 0.));
        if (there >= SIGMAS)
            return widest(change*((inside + (sigmas - inside)*(SIGMAS - root)/(there - root))/sigmas/SIGMAS), shares);
        last = direction = change;
        shares = widest(shares, change/std::max(there, 1.));
        inside = sigmas;
        root = there;
        if (!hasFailed)
            step = inside;
    }
    return widest(last/std::max(root, TO_AN_END), shares);
}

} // namespace

namespace {

//! A coordinate that tells where a window is.
struct PlaceCoordinate
{
    int block, coordinate;
    double size;                    //!< of which a standard deviation may be a part
    int together, before;           //!< with the others of a centre, which is hardly known as a whole; so many of them come before it
};

//! Those that are free, a distance of a pane and the centre of a dome.
std::vector<PlaceCoordinate> placeCoordinates(const Problem& problem)
{
    std::vector<PlaceCoordinate> all;
    for (int b = 0; b < problem.outerCount(); b++)
    {
        const ParameterBlock& block = problem.blocks()[b];
        const int distance = block.at.distance - block.at.media;
        if (block.kind == ParameterBlock::MEDIA && !hasCenter(block.at.shape) && block.isFree[distance])
            all.push_back({ b, distance, gapBehind(problem, block.values[distance]), 1, 0 });
        if (block.kind != ParameterBlock::PLACE || block.at.shape != WINDOW_DOME)
            continue;
        for (int i : { 2, 0, 1 })
            if (block.isFree[0])        // as a whole
                all.push_back({ b, i, problem.camera(block.index).window().radius, 3, i });
    }
    return all;
}

} // namespace

bool widenByProfiles(Problem& problem, const Information& information, double variance, Eigen::MatrixXd& half)
{
    const FreeSpace space(problem);
    bool isWider = false;
    for (const PlaceCoordinate& place : placeCoordinates(problem))
    {
        const std::vector<bool>& isFree = problem.blocks()[place.block].isFree;
        const int column = space.first[place.block] + (int)std::count(isFree.begin(), isFree.begin() + place.coordinate, true);
        const Eigen::RowVectorXd h = half.row(column).normalized();
        const VectorXd linear = std::sqrt(variance)*timesVector(half, h.transpose());
        const double sigma = std::sqrt(variance)*half.middleRows(column - place.before, place.together).norm();
        if (!(sigma > WEAK*place.size))
            continue;
        VectorXd change;
        {
            const PlaceProfile profile(problem, place.block, place.coordinate, changeOfValues(problem, space, information, linear),
                                          variance);
            for (int side : { -1, 1 })
            {
                const VectorXd way = side*freeChange(problem, space, profile.towards(side));
                if (change.size() == 0 || way[column] > change[column])
                    change = way;
            }
        }
        if (!(change[column] > WIDER*linear[column]))
            continue;
        half += (change - linear)/std::sqrt(variance)*h;
        isWider = true;
    }
    return isWider;
}

}} // namespace
