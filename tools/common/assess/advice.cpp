// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/advice.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_error.hpp"
#include "measure/view_derivatives.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
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

} // namespace tools
