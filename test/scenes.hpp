// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Seeded random scenes for the tests: windows and lenses of every kind, and small helpers to check with.
#ifndef REFRACT_TEST_SCENES_HPP
#define REFRACT_TEST_SCENES_HPP

#include "paper.hpp"
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace scenes {

using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

const double NaN = std::numeric_limits<double>::quiet_NaN(), INF = std::numeric_limits<double>::infinity();

//! Seed of the run: REFRACT_TEST_SEED, or always the same.
inline unsigned seed()
{
    const char* given = std::getenv("REFRACT_TEST_SEED");
    return given ? (unsigned)std::strtoul(given, nullptr, 10) : 20240607u;
}

//! How often a random test is repeated: TRIALS, also in percent ("25%") of what the test says; at least once.
inline int trials(int otherwise)
{
    const char* given = std::getenv("TRIALS");
    if (!given)
        return otherwise;
    const int number = std::atoi(given);
    return std::max(1, std::string(given).back() == '%' ? otherwise*number/100 : number);
}

class Random
{
public:
    explicit Random(unsigned salt = 0) : engine_(seed() + salt) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    double logUniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(engine_); }
    int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }
    cv::Vec3d vector(double size) { return cv::Vec3d(uniform(-size, size), uniform(-size, size), uniform(-size, size)); }
private:
    std::mt19937_64 engine_;
};

// ---- windows

enum WindowKind { NO_WINDOW, PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, BARE_WATER, GLASS_ON_LENS, WATER_GLASS_AIR,
                  DOUBLE_GLAZING_IN_WATER, WEDGE_IN_AIR, WEDGE_IN_WATER, DOME_IN_AIR, DOME_IN_WATER, TUBE_IN_AIR, TUBE_IN_WATER,
                  BENT_IN_AIR, BENT_IN_WATER, WINDOW_KINDS };

inline const char* name(WindowKind kind)
{
    static const char* names[] = { "no window", "pane in air", "laminate", "air-glass-water", "bare water",
                                   "glass on the lens", "water-glass-air", "double glazing in water", "wedge in air", "wedges in water",
                                   "dome in air", "domes in water", "tube in air", "tubes in water", "bent pane in air",
                                   "bent panes in water" };
    return names[kind];
}

//! Unit vector up to maxDegrees from the optical axis.
inline cv::Vec3d randomNormal(Random& random, double maxDegrees)
{
    const double angle = random.uniform(0, maxDegrees*CV_PI/180), azimuth = random.uniform(0, 2*CV_PI);
    return cv::Vec3d(std::sin(angle)*std::cos(azimuth), std::sin(angle)*std::sin(azimuth), std::cos(angle));
}

inline GlassWindow makeWindow(WindowKind kind, Random& random, double maxTiltDegrees = 25)
{
    GlassWindow w;
    if (kind == NO_WINDOW)
        return w;
    if (kind == DOME_IN_AIR || kind == DOME_IN_WATER)
    {
        w.shape = cv::refract::WINDOW_DOME;
        w.radius = random.uniform(30, 120);
        const cv::Vec3d towards = random.vector(1);
        w.center = random.uniform(0, 0.6)*w.radius/cv::norm(towards)*towards;
        w.thickness = kind == DOME_IN_AIR ? std::vector<double>{ random.uniform(2, 20) } : std::vector<double>{ 8, 5 };
        w.index = kind == DOME_IN_AIR ? std::vector<double>{ 1.5168 } : std::vector<double>{ 1.49, 1.4 };
        w.outerIndex = kind == DOME_IN_AIR ? 1 : 1.333;
        return w;
    }
    if (kind == TUBE_IN_AIR || kind == TUBE_IN_WATER)
    {
        w.shape = cv::refract::WINDOW_TUBE;
        w.radius = random.uniform(30, 120);
        do      // the camera looks out of its side
            w.axis = cv::normalize(random.vector(1));
        while (std::abs(w.axis[2]) > 0.5);
        const cv::Vec3d towards = cv::normalize(w.axis.cross(random.vector(1)));
        w.center = random.uniform(0, 0.6)*w.radius*towards + random.uniform(-1, 1)*w.axis;
        w.thickness = kind == TUBE_IN_AIR ? std::vector<double>{ random.uniform(2, 20) } : std::vector<double>{ 8, 5 };
        w.index = kind == TUBE_IN_AIR ? std::vector<double>{ 1.5168 } : std::vector<double>{ 1.49, 1.4 };
        w.outerIndex = kind == TUBE_IN_AIR ? 1 : 1.333;
        return w;
    }
    w.normal = randomNormal(random, maxTiltDegrees);
    w.distance = kind == GLASS_ON_LENS ? 0 : random.uniform(5, 150);
    const auto layer = [&](double thickness, double index)
    {
        w.thickness.push_back(thickness*random.uniform(0.5, 1.5));
        w.index.push_back(index + random.uniform(-0.02, 0.02));
    };
    switch (kind)
    {
    case LAMINATE: layer(6, 1.52); layer(0.76, 1.48); layer(6, 1.52); break;
    case AIR_GLASS_WATER: layer(10, 1.49); w.outerIndex = 1.333; break;
    case BARE_WATER: w.outerIndex = 1.333; break;
    case GLASS_ON_LENS: layer(8, 1.52); w.outerIndex = 1.333; break;
    case WATER_GLASS_AIR: layer(12, 1.5); w.innerIndex = 1.333; break;
    case DOUBLE_GLAZING_IN_WATER:
        layer(5, 1.52); layer(10, 1.02); layer(5, 1.52); w.innerIndex = w.outerIndex = 1.333; break;
    case BENT_IN_WATER: case WEDGE_IN_WATER: layer(12, 1.49); layer(5, 1.4); w.outerIndex = 1.333; break;
    default: layer(20, 1.5437); break;
    }
    if (kind == BENT_IN_AIR || kind == BENT_IN_WATER)
    {
        w.shape = cv::refract::WINDOW_BENT;
        w.curvature = (random.below(2) ? 1 : -1)/random.logUniform(2e3, 1e5);
    }
    if (kind == WEDGE_IN_AIR || kind == WEDGE_IN_WATER || kind == BENT_IN_WATER)
        for (size_t i = 0; i < w.thickness.size(); i++)
            w.wedge.push_back(cv::Vec2d(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01)));
    return w;
}

inline std::vector<WindowKind> allWindows()
{
    std::vector<WindowKind> kinds;
    for (int k = 0; k < WINDOW_KINDS; k++)
        kinds.push_back((WindowKind)k);
    return kinds;
}

//! Those whose faces are parallel.
inline std::vector<WindowKind> parallelWindows()
{
    std::vector<WindowKind> kinds = allWindows();
    kinds.resize(WEDGE_IN_AIR);
    return kinds;
}

// ---- lenses

struct LensKind
{
    const char* name;
    std::string model;          //!< as lensModel() says
    cv::Matx33d K;
    std::vector<double> coefficients;
    double halfField;           //!< degrees from the axis within which the model is one-to-one

    bool isMrcal() const { return model.find("LENSMODEL_") == 0; }
    bool isSplined() const { return model.find("SPLINED") != std::string::npos; }
    //! As mrcal and RefractiveCamera::lensParameters order them, splined ones' control points included.
    std::vector<double> intrinsics() const
    {
        std::vector<double> all = { K(0, 0), K(1, 1), K(0, 2), K(1, 2) };
        all.insert(all.end(), coefficients.begin(), coefficients.end());
        return all;
    }
    //! lensParameters(): without a splined lens's control points and the centre of CAHVORE that does not move.
    std::vector<double> parameters() const
    {
        const std::vector<double> all = intrinsics();
        const size_t count = isSplined() ? 4 : model.find("CAHVORE") != std::string::npos ? 9 : all.size();
        return std::vector<double>(all.begin(), all.begin() + count);
    }
};

//! A barrel with bumps, different in x and y.
inline LensKind splinedLens(const char* name, int order, int nx, int ny, int fovX, double halfField)
{
    LensKind kind = { name,
                      cv::format("LENSMODEL_SPLINED_STEREOGRAPHIC_order=%d_Nx=%d_Ny=%d_fov_x_deg=%d", order, nx, ny, fovX),
                      { 1200, 0, 640.25, 0, 1195, 512.5, 0, 0, 1 }, {}, halfField };
    const double perUnit = (nx - order)/(4*std::tan(fovX*CV_PI/720));
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
        {
            const double x = (i - 0.5*(nx - 1))/perUnit, y = (j - 0.5*(ny - 1))/perUnit, barrel = -0.08*(x*x + y*y);
            kind.coefficients.push_back(barrel*x + 0.03/perUnit*std::sin(2.3*i + 1.1*j));
            kind.coefficients.push_back(barrel*y + 0.03/perUnit*std::cos(1.7*i - 2.9*j));
        }
    return kind;
}

//! Every lens model with every number of coefficients; the battery of test_lens.cpp runs over all of them.
inline const std::vector<LensKind>& allLenses()
{
    const cv::Matx33d K(1200, 0, 640.25, 0, 1195, 512.5, 0, 0, 1), wide(2070, 0, 3004, 0, 2075, 1997, 0, 0, 1);
    static const std::vector<LensKind> lenses = {
        { "0 coefficients", "opencv", K, {}, 60 },
        { "the paper's", "opencv", paper::K1, paper::D1, 35 },
        { "4 coefficients", "opencv", K, { -0.28, 0.09, 7e-4, -4e-4 }, 40 },
        { "5 coefficients", "opencv", K, { -0.3, 0.12, 1e-3, -5e-4, -0.01 }, 42 },
        { "8 coefficients", "opencv", wide, { 0.5, 0.03, 1e-4, -2e-4, 1e-4, 0.8, 0.1, 0.002 }, 60 },
        { "12 coefficients", "opencv", K, { 0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001, 1e-3, -2e-4, -8e-4, 1e-4 }, 45 },
        { "14 coefficients", "opencv", K, { 0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001, 1e-3, -2e-4, -8e-4, 1e-4,
                                         0.03, -0.02 }, 40 },
        { "fisheye", "fisheye", { 400, 0, 640, 0, 410, 512, 0, 0, 1 }, { -0.02, 0.004, -0.001, 0.0001 }, 89.95 },
        { "fisheye with skew", "fisheye", { 400, 4, 640, 0, 410, 512, 0, 0, 1 }, { 0.01, -0.003, 0.0005, 0 }, 80 },
        { "stereographic", "LENSMODEL_STEREOGRAPHIC", K, {}, 89 },
        { "lonlat", "LENSMODEL_LONLAT", K, {}, 85 },
        { "latlon", "LENSMODEL_LATLON", K, {}, 85 },
        { "CAHVOR", "LENSMODEL_CAHVOR", K, { 0.01, -0.02, 0.003, -0.2, 0.05 }, 40 },
        { "CAHVORE, sine", "LENSMODEL_CAHVORE_linearity=-0.7", K, { -0.02, 0.01, 0.01, -0.1, 0.02, 0, 0, 0 }, 60 },
        { "CAHVORE, tangent", "LENSMODEL_CAHVORE_linearity=0.6", K, { 0.01, 0.02, -0.01, 0.1, 0.02, 0, 0, 0 }, 60 },
        { "CAHVORE, linear", "LENSMODEL_CAHVORE_linearity=0", K, { 0, 0, 0.01, -0.02, 0.001, 0, 0, 0 }, 80 },
        splinedLens("quadratic splines", 2, 12, 10, 120, 45),
        splinedLens("cubic splines", 3, 11, 9, 120, 42) };
    return lenses;
}

//! The one of allLenses() that is called so.
inline const LensKind& lensNamed(const std::string& name)
{
    for (const LensKind& kind : allLenses())
        if (kind.name == name)
            return kind;
    throw std::invalid_argument("allLenses() has no " + name);
}

inline cv::Ptr<RefractiveCamera> makeCamera(const LensKind& lens, const GlassWindow& window)
{
    return RefractiveCamera::createByName(lens.model, lens.K, lens.coefficients, window);
}

//! Unit direction within the lens's field.
inline cv::Vec3d randomDirection(const LensKind& lens, Random& random) { return randomNormal(random, lens.halfField); }

// ---- checks

//! Of a camera without distortion.
const cv::Matx33d PLAIN_K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);

//! The same lists of points of another type.
template<typename To, typename From> std::vector<std::vector<To> > as(const std::vector<std::vector<From> >& lists)
{
    std::vector<std::vector<To> > out;
    for (const std::vector<From>& list : lists)
        out.emplace_back(list.begin(), list.end());
    return out;
}

//! The text of the cv::Exception that f throws, or "" if it throws none.
template<typename F>
std::string thrown(const F& f)
{
    try { f(); }
    catch (const cv::Exception& e) { return e.what(); }
    return "";
}

//! Largest absolute difference, channels included; NaN if any element is NaN in one of the two only.
inline double largestDifference(cv::InputArray a_, cv::InputArray b_)
{
    cv::Mat a, b;
    a_.getMat().clone().reshape(1, 1).convertTo(a, CV_64F);
    b_.getMat().clone().reshape(1, 1).convertTo(b, CV_64F);
    REQUIRE(a.total() == b.total());
    double largest = 0;
    for (int i = 0; i < (int)a.total(); i++)
    {
        const double x = a.at<double>(i), y = b.at<double>(i);
        if (std::isnan(x) && std::isnan(y))
            continue;
        if (!(std::abs(x - y) <= largest))
            largest = std::abs(x - y);
        if (std::isnan(largest))
            return largest;
    }
    return largest;
}

//! One line per headline number; test/run.sh shows them.
template<typename T>
void printNumber(const std::string& what, const T& value, const std::string& unit)
{
    std::cout << "[numbers] " << what << ": " << value << " " << unit << std::endl;
}

} // namespace scenes

#endif // REFRACT_TEST_SCENES_HPP
