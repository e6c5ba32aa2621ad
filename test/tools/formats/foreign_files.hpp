// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_FOREIGN_FILES_HPP
#define REFRACT_TEST_FOREIGN_FILES_HPP

#include "formats/foreign_rig.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>

/* Files as other programs write them, and the pixels that those programs would compute: their formulas, written out once more. */

const double SAME = 1e-9;           // px

inline std::string saved(const TemporaryFolder& folder, const std::string& name, const std::string& bytes)
{
    std::ofstream(folder/name, std::ios::binary) << bytes;
    return folder/name;
}

//! The cameras of a text.
inline tools::ForeignRig rigOf(const TemporaryFolder& folder, const std::string& text, const std::string& name = "file")
{
    const auto rig = tools::readForeignRig(saved(folder, name, text));
    REQUIRE(rig);
    return *rig;
}

//! x, y in the plane z = 1 -> the same, distorted.
typedef std::function<cv::Point2d(double x, double y)> Distortion;

inline Distortion brown(double k1, double k2, double p1, double p2, double k3 = 0, double k4 = 0, double k5 = 0, double k6 = 0)
{
    return [=](double x, double y) {
        const double r2 = x*x + y*y, radial = (1 + r2*(k1 + r2*(k2 + r2*k3)))/(1 + r2*(k4 + r2*(k5 + r2*k6)));
        return cv::Point2d(x*radial + 2*p1*x*y + p2*(r2 + 2*x*x), y*radial + p1*(r2 + 2*y*y) + 2*p2*x*y);
    };
}

inline Distortion equidistant(double k1, double k2, double k3, double k4)
{
    return [=](double x, double y) {
        const double r = std::hypot(x, y), a = std::atan(r), a2 = a*a, b = a*(1 + a2*(k1 + a2*(k2 + a2*(k3 + a2*k4))));
        return r > 0 ? cv::Point2d(x*b/r, y*b/r) : cv::Point2d();
    };
}

//! Of what another program says where a ray is seen, and what the camera that was read of its file says.
inline void requireLens(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const Distortion& distorted, double fx, double fy, double cx,
                        double cy)
{
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (double x = -0.5; x < 0.51; x += 0.125)
        for (double y = -0.4; y < 0.41; y += 0.1)
            points.push_back({x*700, y*700, 700});
    cv::refract::refractiveProjectPoints(points, cv::Vec3d(), cv::Vec3d(), camera, pixels);
    for (size_t i = 0; i < points.size(); i++)
    {
        const cv::Point2d p = distorted(points[i].x/points[i].z, points[i].y/points[i].z);
        CHECK(cv::norm(pixels[i] - cv::Point2d(fx*p.x + cx, fy*p.y + cy)) < SAME);
    }
}

//! A ray through a plane with the normal n, at which n.X = d: where it meets it, and where it goes.
inline void refractAt(const cv::Vec3d& n, double d, double before, double after, cv::Vec3d& origin, cv::Vec3d& direction)
{
    origin += direction*((d - n.dot(origin))/n.dot(direction));
    direction /= cv::norm(direction);
    const double c = n.dot(direction), ratio = before/after;
    direction = ratio*direction + n*(std::sqrt(1 - ratio*ratio*(1 - c*c)) - ratio*c);
}

inline std::string refusal(const std::string& file)
{
    try
    {
        const auto rig = tools::readForeignRig(file);
        return rig ? "read" : "";
    }
    catch (const std::exception& e)
    {
        return e.what();
    }
}

//! Numbers of one kind as they are in memory.
template<typename T> std::string raw(const std::vector<T>& numbers)
{
    return std::string((const char*)numbers.data(), numbers.size()*sizeof(T));
}
template<typename T> std::string raw(T number) { return raw(std::vector<T>{number}); }

#endif // REFRACT_TEST_FOREIGN_FILES_HPP
