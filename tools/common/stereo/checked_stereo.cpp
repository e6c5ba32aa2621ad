// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/checked_stereo.hpp"
#include "console/progress.hpp"
#include "match/features.hpp"
#include "match/pair_mistakes.hpp"
#include "math/quantile.hpp"
#include "stereo/depth_picture.hpp"
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Vec3d;
using cv::Vec3f;
using cv::format;

namespace {

/* What the calibration is worth at a point changes slowly all over the view: its variances are found at the nodes of a grid of
pixels of the new image 1 and of disparities, and between them interpolated. */
class CalibrationVariance
{
public:
    explicit CalibrationVariance(const RectifiedRig& rig) : rig_(rig)
    {
        if (rig.calibration().covariance.empty())
            return;
        step_ = Vec3d((rig.size().width - 1)/(double)(COLUMNS - 1), (rig.size().height - 1)/(double)(ROWS - 1),
                      (rig.disparities() - 1)/(double)(DEPTHS - 1));
        variances_.resize(COLUMNS*ROWS*DEPTHS);
        std::vector<cv::Point2d> pixels[2];
        for (int i = 0; i < (int)variances_.size(); i++)
        {
            const Vec3d X = pointAt(i);
            for (int c = 0; c < 2; c++)
            {
                std::vector<cv::Point2d> pixel;
                const Vec3d T = c ? rig.calibration().extrinsics[c].t : Vec3d();
                const Matx33d R = c ? rig.calibration().extrinsics[c].R : Matx33d::eye();
                cv::refract::refractiveProjectPoints(std::vector<Vec3d>{X}, R, T, rig.calibration().cameras[c].camera, pixel);
                pixels[c].push_back(pixel[0]);
            }
        }
        Mat points, status, covariance;
        const Calibration& calibration = rig.calibration();
        cv::refract::triangulateRefractive(calibration.cameras[0].camera, calibration.cameras[1].camera, calibration.extrinsics[1].R,
                                           calibration.extrinsics[1].t, pixels[0], pixels[1], points, status, 0, 0.,
                                           calibration.covariance, covariance);
        for (int i = 0; i < (int)variances_.size(); i++)
        {
            const double* C = covariance.ptr<double>(i);
            variances_[i] = Vec3d(C[0], C[4], C[8]);
        }
    }

    //! Of x, y, z; a node without an answer, behind a window say, gives its part to the others.
    Vec3d at(double x, double y, double disparity) const
    {
        if (variances_.empty())
            return Vec3d();
        const double place[] = {x/step_[0], y/step_[1], (disparity - rig_.minDisparity())/step_[2]};
        const int counts[] = {COLUMNS, ROWS, DEPTHS};
        int first[3];
        double part[3];
        for (int k = 0; k < 3; k++)
        {
            first[k] = std::clamp(cvFloor(place[k]), 0, counts[k] - 2);
            part[k] = std::clamp(place[k] - first[k], 0., 1.);
        }
        Vec3d sum;
        double weights = 0;
        for (int corner = 0; corner < 8; corner++)
        {
            double weight = 1;
            int index[3];
            for (int k = 0; k < 3; k++)
            {
                const int bit = corner >> k & 1;
                index[k] = first[k] + bit;
                weight *= bit ? part[k] : 1 - part[k];
            }
            const Vec3d& v = variances_[(index[2]*ROWS + index[1])*COLUMNS + index[0]];
            if (v == v && weight > 0)
            {
                sum += weight*v;
                weights += weight;
            }
        }
        return sum*(1/weights);     // NaN if no node has an answer
    }

private:
    enum { COLUMNS = 9, ROWS = 7, DEPTHS = 7 };

    //! Of a node, camera-1 frame.
    Vec3d pointAt(int i) const
    {
        const double x = i % COLUMNS*step_[0], y = i/COLUMNS % ROWS*step_[1], d = rig_.minDisparity() + i/(COLUMNS*ROWS)*step_[2];
        const cv::Vec4d X = cv::Matx44d(rig_.Q.ptr<double>())*cv::Vec4d(x, y, std::max(d, rig_.shift() + 0.5), 1);
        return Matx33d(rig_.R1.ptr<double>()).t()*(Vec3d(X.val)*(1/X[3]));
    }

    const RectifiedRig& rig_;
    Vec3d step_;
    std::vector<Vec3d> variances_;
};

} // namespace

/** One standard deviation of x, y and z of each point (camera-1 frame): that of its disparity, along the line of sight, and what
the calibration's covariance, if there is one, does to all points; CV_32FC3.
@param contradiction share of its distance by which a point may be off beside that, as the images contradict the calibration */
static Mat pointSigma(const RectifiedRig& rig, const DenseStereo& stereo, double contradiction)
{
    const CalibrationVariance calibration(rig);
    const Vec3d centre = Matx33d(rig.R1.ptr<double>()).t()*rig.centre();
    Mat result(stereo.points.size(), CV_32FC3, cv::Scalar::all(NAN));
    inParallel(result.rows, [&](int y) {
        for (int x = 0; x < result.cols; x++)
        {
            const Vec3f& X = stereo.points.at<Vec3f>(y, x);
            if (!(X[2] == X[2]))
                continue;
            const double d = stereo.disparity.at<float>(y, x);
            // a pinhole's point is its centre + something/(d - shift)
            const double byMatch = stereo.disparitySigmas.at<float>(y, x)/(d - rig.shift());
            const Vec3d along = (Vec3d(X) - centre)*std::sqrt(byMatch*byMatch + contradiction*contradiction);
            const Vec3d variance = along.mul(along) + calibration.at(x, y, d);
            result.at<Vec3f>(y, x) = Vec3f((float)std::sqrt(variance[0]), (float)std::sqrt(variance[1]), (float)std::sqrt(variance[2]));
        }
    });
    return result;
}

namespace {

const double FEWEST_MATCHED = 0.001;        // share of the pixels
const double FEWEST_SUPPORTED = 0.5;        // share of the matched ones with texture; good images have nearly all
const double MOST_OUTSIDE = 0.05;           // share of the details: fewer are chance
const double DOUBTFUL_SUPPORT = 0.85;
const double DOUBTFUL_ROWS = 0.3;           // px; a good calibration leaves a tenth
const double MOST_ROWS = 1;                 // px: beyond, a matcher finds only what agrees by chance
const double MOST_DEPTH_CHANGE = 0.02;      // share of the depth

const cv::Vec3f NO_POINT = cv::Vec3f::all(std::numeric_limits<float>::quiet_NaN());

void removeOutside(const cv::Vec2d& range, Mat& points)
{
    for (cv::Vec3f& X : cv::Mat_<cv::Vec3f>(points))
        if (!(X[2] >= range[0] && X[2] <= range[1]))
            X = NO_POINT;
}

//! Disparities of pixels that have a point.
Mat matchedDisparity(const DenseStereo& stereo)
{
    Mat result = stereo.disparity.clone();
    for (int y = 0; y < result.rows; y++)
        for (int x = 0; x < result.cols; x++)
            if (!(stereo.points.at<cv::Vec3f>(y, x)[2] == stereo.points.at<cv::Vec3f>(y, x)[2]))
                result.at<float>(y, x) = NO_POINT[0];
    return result;
}

//! "450 to 1150": of the details but for the rarest.
std::string seenRange(const WideDepths& seen)
{
    const double RARE = 0.02;
    return format("%.4g to %.4g", cv::refract::quantile(seen.sorted, RARE), cv::refract::quantile(seen.sorted, 1 - RARE));
}

//! Beyond, no match can be used: where the calibration says that it is that bad, what it says.
double mostRows(const RowCheck& rows)
{
    const double FEW = 3;
    return std::fmax(MOST_ROWS, FEW*rows.expected);
}

std::string rangeText(const cv::Vec2d& range) { return format("--depth=%g,%g", range[0], range[1]); }

} // namespace

StereoChecker::StereoChecker(const RectifiedRig& rig, const MatcherOptions& options, bool crop, const std::string& file)
    : rig_(rig), options_(options), crop_(crop), file_(file), wide_(rig.calibration(), rig) {}

CheckedStereo StereoChecker::match(const Mat& image1, const Mat& image2) const
{
    CheckedStereo result;
    DenseStereo& stereo = result.stereo;
    const WideDepths seen = wide_.look(image1, image2);
    const bool isElsewhere = seen.outside() > MOST_OUTSIDE;
    stereo = matchPair(rig_, image1, image2, options_);
    removeOutside(rig_.depthRange(), stereo.points);
    wide_.removeContradicted(seen, isElsewhere, stereo.points);
    const MatchSupport support = supportOf(forMatcher(rig_, stereo.rectified1), forMatcher(rig_, stereo.rectified2),
                                           fromMatcher(rig_, matchedDisparity(stereo)));
    stereo.points.setTo(NO_POINT, ~fromMatcher(rig_, isElsewhere ? support.mask : support.nearby));
    result.rows = checkRows(rig_, stereo);
    if (!(support.supported >= FEWEST_MATCHED*(double)image1.total()) || !(support.share() >= FEWEST_SUPPORTED))
        result.refusal = whyNothingFits(seen, mostRows(result.rows), image1, image2);
    else
    {
        judgeRows(image1, image2, support, result);
        judgeRange(seen, result);
    }
    if (result.refusal.empty())
        stereo.sigma = pointSigma(rig_, stereo, result.rows.depthChange);
    return result;
}

void StereoChecker::judgeRange(const WideDepths& seen, CheckedStereo& result) const
{
    if (crop_ || !result.refusal.empty() || seen.outside() <= MOST_OUTSIDE)
        return;
    result.warnings.push_back(rangeText(rig_.depthRange()) + format(": %.0f %% of what both images show lies outside and is left out; what "
                              "they show is at depths of ", 100*seen.outside()) + seenRange(seen) + " (--crop: on purpose)");
}

void StereoChecker::judgeRows(const Mat& image1, const Mat& image2, const MatchSupport& support, CheckedStereo& result) const
{
    const RowCheck& rows = result.rows;
    if (!rows.contradicts() && !(rows.found > DOUBTFUL_ROWS) && support.share() > DOUBTFUL_SUPPORT)
        return;
    const PairDiagnosis diagnosis = diagnosePair(rig_.calibration(), image1, image2);
    if (!diagnosis.mistake.empty() || diagnosis.rows > mostRows(rows))
        result.refusal = whatFeaturesSay(diagnosis);
    else if (!rows.contradicts() && diagnosis.features < MIN_FEATURES)
        result.refusal = format("only %.0f %% of the matches are supported by texture, and only %d details are unlike all others: a "
                                "pattern that repeats, as a chessboard's, matches at several depths; show a scene with texture",
                                100*support.share(), diagnosis.features);
    if (!rows.contradicts() || !result.refusal.empty())
        return;
    const std::string text = format("matches are %.2g px (RMS) off their rows, where '%s' allows for %.2g: calibration and images do "
                                    "not fit", rows.found, file_.c_str(), rows.expected);
    const std::string causes = rows.causes.empty() ? "has a camera or a window moved?" : "it may be " + rows.causes;
    const std::string wrong = format("depths may be wrong by %.2g %%", 100*rows.depthChange);
    if (rows.found > mostRows(rows))
        result.refusal = text + "; " + causes;
    else if (rows.depthChange > MOST_DEPTH_CHANGE)
        result.refusal = text + ", and " + wrong + "; " + causes;
    else
        result.warnings.push_back(text + "; " + wrong + ", which is in sx, sy, sz; " + causes);
}

std::string StereoChecker::whatFeaturesSay(const PairDiagnosis& diagnosis) const
{
    const std::string rows = !std::isfinite(diagnosis.rows) ? "" : format("features that are alike in both images are %.2g px off their "
                                                                          "rows (median): ", diagnosis.rows);
    if (!diagnosis.mistake.empty())
        return rows + diagnosis.mistake;
    return rows + "calibration and images do not fit; has a camera or a window moved, is '" + file_ + "' of this rig?";
}

std::string StereoChecker::whyNothingFits(const WideDepths& seen, double mostRows, const Mat& image1, const Mat& image2) const
{
    const PairDiagnosis diagnosis = diagnosePair(rig_.calibration(), image1, image2);
    if (!diagnosis.mistake.empty() || diagnosis.rows > mostRows)
        return whatFeaturesSay(diagnosis);
    if (seen.outside() > MOST_OUTSIDE)
        return rangeText(rig_.depthRange()) + ": hardly anything that both images show lies there, but at depths of " + seenRange(seen)
               + "; give the range of the scene";
    return "hardly anything looks alike in both images: do they show the same textured scene, of one moment, within --depth? Are LEFT "
           "and RIGHT swapped?";
}

} // namespace tools
