// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the tests of domes, tubes and bent panes do alike: vector Snell, files, refusals, arrays, instruction sets.
#ifndef REFRACT_TEST_CURVED_SCENES_HPP
#define REFRACT_TEST_CURVED_SCENES_HPP

#include "kernel_levels.hpp"
#include "scenes.hpp"
#include "window/curved_kernels.hpp"
#include "window/layers.hpp"

namespace scenes {

const cv::Matx33d CURVED_K(1000, 0, 640, 0, 1010, 480, 0, 0, 1);

inline cv::Vec3d unit(const cv::Vec3d& v) { return v/norm(v); }
inline cv::Vec3d across(const cv::Vec3d& v, const cv::Vec3d& axis) { return v - v.dot(axis)*axis; }

/** Vector Snell at a face with the unit normal m.
@param leastCosine of both angles, if it is less than what stands there
@return false: total reflection */
inline bool refractAt(cv::Vec3d& direction, const cv::Vec3d& m, double from, double to, double* leastCosine)
{
    const double ratio = from/to, c = m.dot(direction), square = 1 - ratio*ratio*(1 - c*c);
    if (!(square > 0))
        return false;
    direction = ratio*direction + (std::sqrt(square) - ratio*c)*m;
    if (leastCosine)
        *leastCosine = std::min(*leastCosine, std::min(c, std::sqrt(square)));
    return true;
}

inline uchar solveIn(const cv::refract::Layers& layers, const cv::Vec3d& X, double w, cv::Vec3d& direction)
{
    uchar status = cv::refract::REFRACT_OK;
    layers.solveIn(1, &X[0], &X[1], &X[2], &w, &direction[0], &direction[1], &direction[2], &status);
    return status;
}

//! The camera is in the rarest medium: no caustics.
inline bool isInnerRarest(const GlassWindow& w)
{
    return w.innerIndex <= std::min(w.outerIndex, *std::min_element(w.index.begin(), w.index.end()));
}

inline std::string refusal(const std::function<void()>& call, int code)
{
    try
    {
        call();
    }
    catch (const cv::Exception& e)
    {
        CHECK(e.code == code);
        return e.err;
    }
    return "no refusal";
}

//! Written and read again.
inline GlassWindow throughFile(const GlassWindow& window, cv::String& text)
{
    cv::FileStorage out(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    out << "glass_window" << window;
    text = out.releaseAndGetString();
    cv::FileStorage in(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    GlassWindow back;
    in["glass_window"] >> back;
    return back;
}

//! Why a file with this window is refused.
inline std::string refusalOfFile(const cv::String& map)
{
    return refusal([&]
    {
        GlassWindow window;
        cv::FileStorage file("%YAML:1.0\nglass_window: {" + map + "}\n", cv::FileStorage::READ | cv::FileStorage::MEMORY);
        file["glass_window"] >> window;
    }, cv::Error::StsParseError);
}

//! Dense, float32, every third row of a second column, empty: the same pixels, NaN where the status says so.
inline void checkProjectedArrays(const std::vector<cv::Point3d>& points, const std::vector<uchar>& expected, const GlassWindow& window)
{
    std::vector<cv::Point2d> exact, ofRounded, none;
    std::vector<cv::Point2f> single;
    std::vector<uchar> status;
    cv::refract::refractiveProjectPoints(points, cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, exact, status);
    CHECK(status == expected);
    const int count = (int)points.size();
    cv::Mat strided(3*count, 2, CV_64FC3), asFloat, rounded, fromView;
    for (int i = 0; i < count; i++)
        strided.at<cv::Point3d>(3*i, 1) = points[i];
    const cv::Mat view(count, 1, CV_64FC3, strided.ptr(0) + strided.elemSize(), 3*strided.step[0]);
    cv::refract::refractiveProjectPoints(view, cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, fromView);
    cv::Mat(points).convertTo(asFloat, CV_32F);
    asFloat.convertTo(rounded, CV_64F);
    cv::refract::refractiveProjectPoints(asFloat, cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, single);
    cv::refract::refractiveProjectPoints(rounded, cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, ofRounded);
    REQUIRE((int)single.size() == count);
    for (int i = 0; i < count; i++)
    {
        REQUIRE(std::isnan(exact[i].x) == (expected[i] != cv::refract::REFRACT_OK));
        REQUIRE((fromView.at<cv::Point2d>(i) == exact[i] || std::isnan(exact[i].x)));
        REQUIRE((single[i] == cv::Point2f(ofRounded[i]) || (std::isnan(single[i].x) && std::isnan(ofRounded[i].x))));
    }
    cv::refract::refractiveProjectPoints(std::vector<cv::Point3d>(), cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, none,
                                         status);
    CHECK(none.empty());
    CHECK(status.empty());
}

//! @param curvedOf the window of some radius whose face is at the flat one's
inline void checkLimitOfRadius(const std::string& name, const std::function<GlassWindow(const GlassWindow& flat, double radius)>& curvedOf)
{
    Random random;
    for (double outerIndex : { 1., 1.333 })
    {
        const GlassWindow flat(cv::Vec3d(0.1, -0.05, 1), 20, 1.5, 30, outerIndex);
        std::vector<cv::Point3d> points;
        for (int i = 0; i < 200; i++)
            points.push_back(cv::Point3d(random.uniform(-300, 300), random.uniform(-300, 300), random.uniform(600, 1000)));
        const auto pixelsOf = [&](const GlassWindow& window)
        {
            std::vector<cv::Point2d> pixels;
            cv::refract::refractiveProjectPoints(points, cv::Vec3d(), cv::Vec3d(), CURVED_K, cv::noArray(), window, pixels);
            return pixels;
        };
        const auto difference = [&](double radius) { return norm(pixelsOf(curvedOf(flat, radius)), pixelsOf(flat), cv::NORM_INF); };
        // What is left is the curvature's own: half of it at twice the radius.
        for (double radius : { 1e5, 1e6, 1e7 })
            CHECK(difference(radius)/difference(2*radius) == Approx(2).epsilon(1e-2));
        printNumber(name + cv::format(" of radius 1e6 against the flat window, outside %g", outerIndex), difference(1e6), "px");
    }
}

//! Directions and derivatives are those of the first instruction set.
inline void checkInstructionSets(const cv::refract::CurvedFaces& curved, const std::vector<cv::Vec3d>& points, double size)
{
    const int n = (int)points.size(), parameters = curved.at.count;
    std::vector<double> X[3], d[3], expected[3], jacobian[2];
    for (int i = 0; i < 3; i++)
        for (const cv::Vec3d& p : points)
            X[i].push_back(p[i]);
    for (const cv::refract::Kernels* level : kernelLevels())
    {
        CAPTURE(level->instructions);
        std::copy(X, X + 3, d);
        CHECK(level->curved.solveIn(curved, n, X[0].data(), X[1].data(), X[2].data(), NULL, d[0].data(), d[1].data(), d[2].data()));
        std::vector<double> byDirection(6*n, 1), byPoint(6*n), byWindow(2*n*parameters);
        level->curved.chain(curved, 2, n, X[0].data(), X[1].data(), X[2].data(), d[0].data(), d[1].data(), d[2].data(),
                            { byDirection.data(), 3, n }, { byPoint.data(), 3, n }, { byWindow.data(), parameters, n });
        if (expected[0].empty())
        {
            std::copy(d, d + 3, expected);
            jacobian[0] = byPoint;
            jacobian[1] = byWindow;
        }
        for (int k = 0; k < n; k++)
            REQUIRE(norm(unit({ d[0][k], d[1][k], d[2][k] }) - unit({ expected[0][k], expected[1][k], expected[2][k] })) < 1e-14);
        for (size_t k = 0; k < byPoint.size(); k++)
            REQUIRE(std::abs(byPoint[k] - jacobian[0][k]) < 1e-11*(1/size + std::abs(byPoint[k])));
        for (size_t k = 0; k < byWindow.size(); k++)
            REQUIRE(std::abs(byWindow[k] - jacobian[1][k]) < 1e-11*(1 + std::abs(byWindow[k])));
    }
}

} // namespace scenes

#endif // REFRACT_TEST_CURVED_SCENES_HPP
