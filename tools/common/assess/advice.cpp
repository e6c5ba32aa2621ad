// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/advice.hpp"
#include "assess/findings.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_error.hpp"
#include "measure/rig_vector.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int GRID_COLUMNS = 5;             // to choose by
const int NEXT = 3;                     // images to advise
const double TILT_DEG = 30.;
const double MUST_BE_SEEN = 0.75;       // of the board's points, in each image

struct Placement
{
    std::string words;
    Vec3d rvec, tvec;                   //!< board -> camera 1
};

enum Kind { PAIR, GLASS_ONLY, DIRECT_ONLY };

class ViewPlanner
{
public:
    explicit ViewPlanner(const RigCalibration& c)
        : c_(c), board_(c.data.views[c.fit.views[0]].objectPoints), now_(toEigen(c.fit.withTargets)), sigma_(c.fit.sigma) {}

    const MatrixXd& now() const { return now_; }

    //! @param columns of the error maps
    Quality qualityOf(const MatrixXd& withTargets, int columns = ERROR_MAP_COLUMNS) const
    {
        const int parameters = columnCount(c_.fit.rig);
        const MatrixXd covariance = withTargets.topLeftCorner(parameters, parameters);
        Quality quality;
        for (int k = 0; k < c_.data.cameraCount; k++)
            quality.placeStd.push_back(placeStd(toMat(covariance), c_.fit.rig, k));
        Calibration calibration = calibrationOf(c_.fit.rig);
        calibration.covariance = toMat(covariance);
        const Vec3d depth = workingDepth(c_, 0);
        ErrorSquares squares;
        for (double z : {depth[0], depth[2]})
        {
            const ErrorMap map = mapErrors(calibration, z, sigma_, columns);
            if (map.seen())
                quality.worstPoint = std::fmax(quality.worstPoint, map.worst());
            squares.add(map);
        }
        quality.calibrationPart = squares.count ? std::sqrt(std::max(0., squares.calibration)/squares.count) : NONE;
        return quality;
    }

    /** The square root of what a view tells about the parameters; empty if too little of the board is seen by camera 1, or by
    all others. */
    MatrixXd informationOf(const Placement& placement, Kind kind) const
    {
        std::vector<ImageOfView> images;
        for (int camera = 0; camera < c_.data.cameraCount; camera++)
            for (bool glass : {true, false})
            {
                if ((glass && kind == DIRECT_ONLY) || (!glass && kind == GLASS_ONLY))
                    continue;
                const ImageOfView image = pointsInImage(c_.fit.rig, board_, placement.rvec, placement.tvec, camera, glass);
                if (image.points.size() >= MUST_BE_SEEN*board_.size())
                    images.push_back(image);
                else if (camera == 0 || c_.data.cameraCount == 2)
                    return MatrixXd();
            }
        if (c_.data.cameraCount > 1 && images.back().camera == 0)
            return MatrixXd();
        const ViewDerivatives d = differentiateView(c_.fit.rig, board_, placement.rvec, placement.tvec, images);
        return QR(PoseNullSpace(d.byPose)(d.byParameters)).R();
    }

    MatrixXd covarianceAfter(const MatrixXd& before, const MatrixXd& information) const
    {
        return covarianceWith(before, information, sigma_);
    }

    //! Near, middle and far; middle and four sides of the image; straight and tilted to four sides.
    std::vector<Placement> placements() const
    {
        const Vec3d depth = workingDepth(c_, 0);
        const struct { double z; const char* words; } ranges[] = {{depth[0], "near"}, {depth[1], "in the middle of the range"},
                                                                   {depth[2], "far"}};
        const struct { Point2d at; const char* words; } places[] = {{{0.5, 0.5}, "in the middle of the image"},
            {{0.3, 0.5}, "in the left half"}, {{0.7, 0.5}, "in the right half"}, {{0.5, 0.32}, "in the upper half"},
            {{0.5, 0.68}, "in the lower half"}};
        const struct { Vec3d axis; const char* words; } tilts[] = {{{0, 0, 0}, "square to the camera"},
            {{0, 1, 0}, "left edge farther by 30 degrees"}, {{0, -1, 0}, "right edge farther by 30 degrees"},
            {{1, 0, 0}, "lower edge farther by 30 degrees"}, {{-1, 0, 0}, "upper edge farther by 30 degrees"}};
        std::vector<Placement> result;
        for (const auto& range : ranges)
            for (const auto& place : places)
                for (const auto& tilt : tilts)
                {
                    const Vec3d tvec = boardAt(place.at, range.z, tilt.axis);
                    if (std::isfinite(tvec[0] + tvec[1] + tvec[2]))
                        result.push_back({format("%s (z = %.4g %s), %s, %s", range.words, range.z, c_.unit.c_str(), place.words,
                                                 tilt.words), tilt.axis*(TILT_DEG*CV_PI/180.), tvec});
                }
        return result;
    }

private:
    //! tvec that brings the board's middle to a share of the image, at the depth z; NaN if no ray leads there.
    Vec3d boardAt(const Point2d& share, double z, const Vec3d& axis) const
    {
        const Size size = c_.data.imageSize[0];
        std::vector<Point3d> middle;
        refractivePointsOnPlane(std::vector<Point2d>{{share.x*size.width, share.y*size.height}}, middle,
                                c_.fit.rig.cameras[0], Vec4d(0, 0, 1, z));
        Point3d centre;
        for (const Point3d& X : board_)
            centre += X*(1./board_.size());
        const Matx33d R = rotationMatrix(axis*(TILT_DEG*CV_PI/180.));
        return Vec3d(middle[0]) - R*Vec3d(centre);
    }

    const RigCalibration& c_;
    std::vector<Point3d> board_;
    MatrixXd now_;
    double sigma_;
};

//! The source of the budget that has the largest share of a point's error; null: there is no budget.
const BudgetRow* largestShare(const Assessment& a)
{
    const BudgetRow* largest = nullptr;
    for (size_t i = 0; i + 1 < a.budget.size(); i++)        // the last is the total
        if (std::isfinite(a.budget[i].share) && (!largest || a.budget[i].share > largest->share))
            largest = &a.budget[i];
    return largest;
}

//! Of the camera that has the fewest.
int fewestPairs(const RigCalibration& c)
{
    int fewest = c.data.countPairs(0);
    for (int k = 1; k < c.data.cameraCount; k++)
        fewest = std::min(fewest, c.data.countPairs(k));
    return fewest;
}

//! "another pair: near (z = 490 mm), in the middle of the image, ..."
std::string nextPair(const Assessment& a, int count)
{
    const std::string pairs = (count == 1 ? std::string("another ") : format("%d more ", count))
        + (a.advice.arePairs ? "pair" : "image") + (count == 1 ? "" : "s");
    return a.advice.pairs.empty() ? pairs : pairs + (count == 1 ? ": " : ", first: ") + a.advice.pairs[0].placement;
}

//! What a point's error is mostly made of, and what makes that smaller.
std::string toMeasureBetter(const RigCalibration& c, const Assessment& a)
{
    const BudgetRow* largest = largestShare(a);
    if (!largest)
        return "take more images";
    const std::string share = format("%.0f %% of a point's error", 100.*largest->share);
    if (!largest->given.empty())
        return "know the " + largest->source + " better than " + largest->given + ", " + share;
    if (largest->source != CALIBRATION_NOISE)
        return "take sharper images: " + share + " is the noise of its own pixels";
    if (a.advice.pairs.empty())
        return "take more images: " + share + " is noise of the calibration's";
    return "take " + nextPair(a, 1) + format(" (the worst point then has %.3g instead of %.3g %s)", a.advice.pairs[0].quality.worstPoint,
                                             a.advice.now.worstPoint, c.unit.c_str());
}

std::string worstView(const RigCalibration& c)
{
    double worst = 0.;
    std::string name;
    for (int k = 0; k < c.data.cameraCount; k++)
        for (int i : c.fit.views)
            for (bool glass : {true, false})
            {
                const double px = rmsOf(c, k, glass, i).px;
                if (!(px > worst))
                    continue;
                worst = px;
                name = "'" + c.data.views[i].stem + "'" + ofCamera(k, c.data.cameraCount)
                    + (glass ? "" : ", direct");
            }
    return name + format(" (%.3g px)", worst);
}

//! Of the first limit that is not met.
std::string toMeet(const LimitCheck& limit, const RigCalibration& c, const Assessment& a)
{
    if (!limit.notJudged.empty())
        return "take " + nextPair(a, std::max(1, ENOUGH_PAIRS - fewestPairs(c)));
    if (limit.unit == "px")
        return "look at the images that fit worst, first " + worstView(c) + ": focus, motion, light, a board that is not flat";
    if (limit.unit == "deg")
        return "take " + nextPair(a, 1);
    return toMeasureBetter(c, a);
}

} // namespace

Advice adviseImages(const RigCalibration& calibration)
{
    const ViewPlanner planner(calibration);
    Advice advice;
    advice.now = planner.qualityOf(planner.now());
    advice.arePairs = calibration.data.hasDirect();
    const Kind kind = advice.arePairs ? PAIR : GLASS_ONLY;
    if (!(calibration.square > 0))      // where another target would be put nobody knows
        return advice;
    std::vector<Placement> placements;
    std::vector<MatrixXd> informations;
    for (const Placement& placement : planner.placements())
    {
        const MatrixXd information = planner.informationOf(placement, kind);
        if (information.size() == 0)
            continue;
        placements.push_back(placement);
        informations.push_back(information);
    }
    MatrixXd covariance = planner.now();
    int first = -1;
    for (int n = 0; n < NEXT && !placements.empty(); n++)
    {
        PlannedImage best;
        MatrixXd bestCovariance;
        int at = -1;
        for (size_t i = 0; i < placements.size(); i++)
        {
            const MatrixXd after = planner.covarianceAfter(covariance, informations[i]);
            const Quality quality = planner.qualityOf(after, GRID_COLUMNS);
            if (at >= 0 && !(quality.calibrationPart < best.quality.calibrationPart))
                continue;
            best = {placements[i].words, quality};
            bestCovariance = after;
            at = (int)i;
        }
        covariance = bestCovariance;
        best.quality = planner.qualityOf(covariance);
        advice.pairs.push_back(best);
        if (n == 0)
            first = at;
    }
    if (first < 0 || !advice.arePairs)
        return advice;
    const struct { Kind kind; const char* words; } others[] = {{GLASS_ONLY, "only the image through the window of the first"},
                                                              {DIRECT_ONLY, "only the direct image of the first"}};
    for (const auto& other : others)
        advice.instead.push_back({other.words, planner.qualityOf(
            planner.covarianceAfter(planner.now(), planner.informationOf(placements[first], other.kind)))});
    return advice;
}

std::string nextStep(const RigCalibration& c, const Assessment& a, const Findings& f)
{
    if (!f.contradictions.empty())
        return "put right what the images contradict, and calibrate again";
    for (const LimitCheck& limit : f.limits)
        if (!limit.met())
            return toMeet(limit, c, a);
    const int pairs = fewestPairs(c);
    if (pairs > 0 && pairs < ENOUGH_PAIRS)
        return "take " + nextPair(a, ENOUGH_PAIRS - pairs);
    return (f.weak.empty() ? "measure (refract_measure); to do so better, " : "mend what is weak; then ") + toMeasureBetter(c, a);
}

} // namespace tools
