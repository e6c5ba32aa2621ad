// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/lens_choice.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MOST_IMAGES = 60;             // of a camera: more decide nothing else
const int MIN_HELD_OUT = 4;             // images; of fewer, parts of the target are held out (selectLensCoefficients)
const int TWO = GLASS_FIX_TANGENT_DIST; // with four coefficients: k1 and k2
// A fisheye's error in that of OpenCV's model, to be taken in its place: of the rational one, which has more coefficients; of others.
const double AS_GOOD = 1.02, CLEARLY_BETTER = 0.97;
const double DESCRIBED = 1.;            // px: corners are found better than that, so more is of the lens

//! What the candidates are fitted to.
struct LensImages
{
    std::vector<int> cameras;
    std::vector<std::vector<Point3d>> object;
    std::vector<std::vector<Mat>> direct, glass;    //!< one of them is empty
    std::vector<std::vector<TargetView>> views;     //!< of each camera
};

std::vector<int> unknownCameras(const RigData& data, const RigOptions& options)
{
    std::vector<int> cameras;
    for (int c = 0; c < data.cameraCount; c++)
        if (!options.known[c])
            cameras.push_back(c);
    return cameras;
}

std::vector<TargetView> imagesOf(const RigData& data, int camera, bool glass)
{
    const std::vector<TargetView> all = targetViewsOf(data, camera, glass);
    std::vector<TargetView> some;
    const size_t step = (all.size() + MOST_IMAGES - 1)/MOST_IMAGES;
    for (size_t i = 0; i < all.size(); i += step)
        some.push_back(all[i]);
    return some;
}

//! Each image of each camera has a pose of its own. Nothing where a camera has too few.
LensImages directImages(const RigData& data, const std::vector<int>& cameras)
{
    LensImages images;
    images.cameras = cameras;
    images.direct.resize(cameras.size());
    for (int c : cameras)
    {
        images.views.push_back(imagesOf(data, c, false));
        if (!determineLens(images.views.back()))
            return LensImages();
        for (const TargetView& view : images.views.back())
        {
            images.object.push_back(view.objectPoints);
            for (std::vector<Mat>& pixels : images.direct)
                pixels.push_back(&pixels == &images.direct[images.views.size() - 1] ? Mat(view.pixels) : Mat());
        }
    }
    return images;
}

LensImages glassImages(const RigData& data, const std::vector<int>& cameras)
{
    LensImages images;
    images.cameras = cameras;
    images.glass.resize(cameras.size());
    for (int c : cameras)
        images.views.push_back(imagesOf(data, c, true));
    for (const View& view : data.views)
    {
        if (!view.hasGlass())
            continue;
        images.object.push_back(view.objectPoints);
        for (size_t k = 0; k < cameras.size(); k++)
            images.glass[k].push_back(Mat(view.glass[cameras[k]]));
    }
    return images;
}

//! Lenses to start from, with as many coefficients as may be.
std::vector<Ptr<RefractiveCamera>> startLenses(const RigData& data, const LensImages& images, bool fisheye, int richest,
                                               const GlassWindow& window)
{
    std::vector<Ptr<RefractiveCamera>> cameras;
    for (size_t k = 0; k < images.cameras.size(); k++)
    {
        double rms;
        const Size size = data.imageSize[images.cameras[k]];
        const Ptr<RefractiveCamera> lens = fisheye ? calibratePinhole(images.views[k], size, FISHEYE_LENS, 0, rms)
                                                   : calibratePinhole(images.views[k], size, 4, TWO, rms);
        cameras.push_back(fisheye ? RefractiveCamera::createFisheye(lens->cameraMatrix(), std::vector<double>(4, 0.), window)
                                  : RefractiveCamera::create(lens->cameraMatrix(), std::vector<double>(richest, 0.), window));
    }
    return cameras;
}

//! Of one model; nothing where it cannot be fitted.
LensChoice chooseCoefficients(const RigData& data, const LensImages& images, bool fisheye, int richest, const RigOptions& options,
                              bool robust)
{
    LensChoice choice;
    choice.direct = images.glass.empty();
    choice.byImages = (int)images.object.size() >= MIN_HELD_OUT;
    try
    {
        const std::vector<Ptr<RefractiveCamera>> cameras = startLenses(data, images, fisheye, richest,
                                                                       choice.direct ? GlassWindow() : options.window);
        std::vector<int> windows;
        for (int c : images.cameras)
            if (!choice.direct && !options.windows.empty())
                windows.push_back(options.windows[c]);
        std::vector<Mat> Rs(cameras.size(), Mat::eye(3, 3, CV_64F)), Ts(cameras.size(), Mat::zeros(3, 1, CV_64F));
        int flags = robust ? GLASS_ROBUST : 0;
        if (!choice.direct)
        {
            flags |= (options.flags & ~GLASS_USE_POSES) | (cameras.size() > 1 ? GLASS_FREE_EXTRINSICS : 0);
            Rs.clear();
            Ts.clear();
        }
        Mat_<double> scores;
        std::vector<Mat> leftOut;
        const int chosen = selectLensCoefficients(images.object, images.direct, images.glass, cameras, windows, Rs, Ts, flags, scores,
                                                  leftOut);
        choice.leftOut.resize(data.cameraCount);
        choice.lenses.resize(data.cameraCount);
        for (size_t k = 0; k < cameras.size(); k++)
        {
            choice.leftOut[images.cameras[k]] = leftOut[k];
            choice.lenses[images.cameras[k]] = cameras[k];
        }
        for (int i = 0; i < scores.rows; i++)
        {
            choice.scores.push_back({fisheye ? "fisheye" : "opencv", (int)scores(i, 0), (int)scores(i, 1), scores(i, 2)});
            if (choice.scores.back().flags == chosen)
                choice.chosen = i;
        }
    }
    catch (const CalibrationError& e)
    {
        choice.undetermined = e.cause == CalibrationError::UNDETERMINED;
    }
    catch (const cv::Exception&) {}         // both are told where the calibration itself fails
    return choice;
}

std::string namesOf(const LensScore& lens)
{
    if (lens.coefficients == 0)
        return "no coefficients";
    std::string text = format("%d coefficient%s", lens.coefficients, lens.coefficients == 1 ? "" : "s");
    static const std::map<int, const char*> NAMES = {{1, "k1"}, {2, "k1, k2"}, {3, "k1 to k3"}, {4, "k1, k2, p1, p2"},
                                                     {5, "k1, k2, p1, p2, k3"}, {6, "k1 to k4, p1, p2"},
                                                     {7, "k1 to k5, p1, p2"}, {8, "k1 to k6, p1, p2"}};
    return text + " (" + (lens.model == "fisheye" && lens.coefficients == 4 ? "k1 to k4" : NAMES.at(lens.coefficients)) + ")";
}

} // namespace

std::string LensChoice::sentence() const
{
    std::string others;
    for (int i = 0; i < (int)scores.size(); i++)
        if (i != chosen && !std::isnan(scores[i].px))
            others += (others.empty() ? "; with " : ", ") + (scores[i].model == lens().model ? "" : scores[i].model + " ")
                      + format("%d: %.3f", scores[i].coefficients, scores[i].px);
    return format("%s, %s, chosen by held-out %s%s: %.3f px", lens().model.c_str(), namesOf(lens()).c_str(),
                  byImages ? "images" : "parts of the target", direct ? "" : " through the window", lens().px) + others;
}

LensChoice chooseLens(const RigData& data, const RigOptions& options, bool robust, int richest)
{
    const std::vector<int> cameras = unknownCameras(data, options);
    if (cameras.empty())
        return LensChoice();
    LensImages images = directImages(data, cameras);
    if (images.cameras.empty())
    {
        if (!(options.flags & GLASS_FREE_INTRINSICS))
            return LensChoice();
        images = glassImages(data, cameras);
    }
    LensChoice choice = chooseCoefficients(data, images, false, richest, options, robust);
    if (choice.undetermined)
        return LensChoice();
    // A lens that k1 and k2 describe is not looked at as a fisheye. Where more coefficients find no good fit, they may be the best of bad.
    if (!choice.scores.empty() && choice.lens().coefficients <= 2 && choice.lens().px < DESCRIBED)
        return choice;
    const LensChoice fisheye = chooseCoefficients(data, images, true, richest, options, robust);
    if (fisheye.scores.empty())
        return choice;
    const bool better = choice.scores.empty()
        || fisheye.lens().px < (choice.lens().coefficients > POLYNOMIAL_LENS ? AS_GOOD : CLEARLY_BETTER)*choice.lens().px;
    const int before = (int)choice.scores.size();
    choice.direct = fisheye.direct;
    choice.byImages = fisheye.byImages;
    choice.scores.insert(choice.scores.end(), fisheye.scores.begin(), fisheye.scores.end());
    if (better)
    {
        choice.chosen = before + fisheye.chosen;
        choice.leftOut = fisheye.leftOut;
        choice.lenses = fisheye.lenses;
    }
    return choice;
}

void setLens(const LensChoice& choice, RigOptions& options, int richest)
{
    static const int LENGTHS[] = { 0, 4, 4, 4, 4, 5, 8, 8, 8 };     // of OpenCV's coefficients, among which are so many
    const bool isFisheye = choice.lens().model == "fisheye";
    options.lensCoefficients = isFisheye ? FISHEYE_LENS : LENGTHS[choice.lens().coefficients];
    options.flags |= choice.lens().flags;
    options.leftOut = choice.leftOut;
    if (!choice.direct)
        options.lensThroughWindow = choice.lenses;
    int longest = std::max(options.lensCoefficients, 0);
    for (const Mat& prior : choice.leftOut)
        for (int i = INTRINSICS; i < prior.rows; i++)
            if (prior.at<double>(i, i) > 0)
                longest = std::max(longest, LENGTHS[i - INTRINSICS + 1]);
    longest = std::min(longest, richest);
    for (Mat& prior : options.leftOut)
        if (prior.empty() || countNonZero(prior == prior) == 0)      // NaN: nothing
            prior = Mat();
        else if (!isFisheye)
            prior = prior(Rect(0, 0, INTRINSICS + longest, INTRINSICS + longest)).clone();
}

} // namespace tools
