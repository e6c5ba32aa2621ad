// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MULTI_START_HPP
#define OPENCV_REFRACT_MULTI_START_HPP

#include "start/pose_start.hpp"
#include <functional>

namespace cv { namespace refract {

//! Those of the views.
RigViews pick(const RigViews& views, const std::vector<int>& which);

//! What a fit has come to, and from where; it may start the next one.
struct Minimum : RigStart
{
    RigStart start;         //!< as it was given
    double cost = std::numeric_limits<double>::infinity();     //!< infinite where a point has no image
    int freedom = 0;
    bool converged = false;
    bool operator<(const Minimum& other) const { return cost < other.cost; }
};

//! Windows whose normals differ by less are one minimum: radians.
const double SAME_ANGLE = 0.01;
const int ALL_VIEWS = INT_MAX;
//! Of one camera. @param range of its targets
bool isSameWindow(const GlassWindow& first, const GlassWindow& second, double range, double angle);

//! One round of successive halving: which views count, how far each fit goes, and what the next round starts from.
struct Stage
{
    int views;              //!< at most
    TermCriteria criteria;
    size_t keep = SIZE_MAX; //!< at most
    double sameAngle = SAME_ANGLE;      //!< of minima whose normals differ by less, the best one is kept
    double maxExcess = std::numeric_limits<double>::infinity();     //!< over the best, in standard deviations of a pixel
};

const TermCriteria COARSE(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-8), FINE(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12);

const double ROUGHLY_SAME_ANGLE = 0.05;     //!< before the end of a fit
/** Of many hypotheses, those that are worth more. Of those that lead to one place the best, as all that lead to the best of some views
would leave no room for the best of all. */
const Stage FIRST_OF_MANY = { 6, TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 20, 1e-8), 6, ROUGHLY_SAME_ANGLE };

//! Excess that some views, or one camera alone, leave a minimum behind the best that all have in another.
const double PLAUSIBLE = 10;
//! Of minima that are sorted, those that a stage keeps.
std::vector<Minimum> keptMinima(const std::vector<Minimum>& sorted, const Stage& stage);

/** Successive halving: all hypotheses are fitted to some views, the best of them to more. Some views may have their least cost in
another minimum than all have, so several have to be kept.
@param hypotheses poses of other views than those of the stage are found anew
@return what the last stage keeps, the best first */
std::vector<Minimum> multiStart(std::vector<RigStart> hypotheses, const std::vector<Stage>& stages, const RigViews& views, int flags);

typedef std::function<std::vector<RigStart>(const Minimum&)> Neighbours;

/** From the best minimum to its neighbours, as long as one of them leads to a better one: a search does not meet all combinations
of several windows, nor minima that some views do not have.
@return the minima and all that the neighbours lead to, the best first */
std::vector<Minimum> hillClimb(std::vector<Minimum> minima, const Neighbours& neighbours, const RigViews& views, int flags);

//! A second minimum of the cost of a window that only images through it tell of.
struct OtherMinimum
{
    GlassWindow window;         //!< in the frame of its first camera
    //! Root of the difference of the squared errors, in standard deviations of a pixel; NaN: there is none.
    double excess = std::numeric_limits<double>::quiet_NaN();
};

//! The second best minimum, for the windows that it has elsewhere: rows of the first camera behind each.
void describeOther(const std::vector<Minimum>& sorted, std::vector<OtherMinimum>& others);

}} // namespace

#endif // OPENCV_REFRACT_MULTI_START_HPP
