// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where the real data sets are, and how their files are read.
#ifndef REFRACT_TEST_REAL_DATA_HPP
#define REFRACT_TEST_REAL_DATA_HPP

#include "scenes.hpp"
#include "paths.hpp"
#include <nlohmann/json.hpp>
#include <fstream>

namespace real_data {

using nlohmann::json;

typedef std::vector<cv::Point2d> Pixels;
typedef std::vector<cv::Point3d> Object;

//! Not open (and a word on why) where the data set is absent.
inline std::ifstream open(const std::string& path)
{
    const std::string full = paths::data() + "/" + path;
    std::ifstream file(full);
    if (!file)
        WARN("SKIPPED: " << full << " is not there");
    return file;
}

inline bool load(const std::string& path, json& data)
{
    std::ifstream file = open(path);
    if (!file)
        return false;
    file >> data;
    return true;
}

//! Points of a target and where a camera saw them: lines "u v x y z", perhaps under a heading. Empty where there is no such file.
struct Dots
{
    Object object;
    Pixels pixels;
};

inline Dots readDots(const std::string& path)
{
    Dots dots;
    std::ifstream file = open(path);
    std::string heading;
    if (file.peek() == '#')
        std::getline(file, heading);
    for (double u, v, x, y, z; file >> u >> v >> x >> y >> z;)
    {
        dots.object.emplace_back(x, y, z);
        dots.pixels.emplace_back(u, v);
    }
    return dots;
}

inline Pixels pixelsOf(const json& list)
{
    Pixels pixels;
    for (const json& p : list)
        pixels.emplace_back(p[0], p[1]);
    return pixels;
}

inline Object objectOf(const json& list)
{
    Object points;
    for (const json& p : list)
        points.emplace_back(p[0], p[1], p[2]);
    return points;
}

} // namespace real_data

#endif // REFRACT_TEST_REAL_DATA_HPP
