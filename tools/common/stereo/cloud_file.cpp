// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/cloud_file.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

namespace tools {

using cv::Vec3b;
using cv::Vec3f;

namespace {

//! Of the image at that place: red, green, blue.
Vec3b colourAt(const cv::Mat& image, int y, int x)
{
    if (image.channels() == 1)
        return Vec3b::all(image.at<uchar>(y, x));
    const Vec3b bgr = image.at<Vec3b>(y, x);
    return Vec3b(bgr[2], bgr[1], bgr[0]);
}

std::string headerOf(const Cloud& cloud, const std::string& unit)
{
    std::ostringstream header;
    header.imbue(std::locale::classic());
    header << "ply\nformat binary_little_endian 1.0\n"
           << "comment refract_stereo " REFRACT_VERSION "; the frame of camera 1; s*: one standard deviation\n";
    if (!unit.empty())
        header << "comment unit " << unit << '\n';
    header << "element vertex " << cloud.size() << '\n';
    for (const char* name : {"x", "y", "z"})
        header << "property float " << name << '\n';
    for (const char* name : {"red", "green", "blue"})
        header << "property uchar " << name << '\n';
    for (const char* name : {"sx", "sy", "sz"})
        header << "property float " << name << '\n';
    header << "end_header\n";
    return header.str();
}

//! Least byte first, whatever this machine does.
void append(std::vector<char>& bytes, const Vec3f& numbers)
{
    for (int i = 0; i < 3; i++)
    {
        uint32_t bits;
        std::memcpy(&bits, &numbers.val[i], sizeof bits);
        for (int shift = 0; shift < 32; shift += 8)
            bytes.push_back((char)(bits >> shift & 0xFF));
    }
}

void writePoints(std::ostream& out, const Cloud& cloud)
{
    std::vector<char> bytes;
    bytes.reserve(27*cloud.size());
    for (const CloudPoint& point : cloud)
    {
        append(bytes, point.position);
        for (int i = 0; i < 3; i++)
            bytes.push_back((char)point.colour[i]);
        append(bytes, point.sigma);
    }
    out.write(bytes.data(), (std::streamsize)bytes.size());
}

} // namespace

Cloud cloudOf(const cv::Mat& points, const cv::Mat& image, const cv::Mat& sigma)
{
    Cloud cloud;
    for (int y = 0; y < points.rows; y++)
        for (int x = 0; x < points.cols; x++)
        {
            const Vec3f X = points.at<Vec3f>(y, x);
            if (std::isfinite(X[0]) && std::isfinite(X[1]) && std::isfinite(X[2]))
                cloud.push_back({X, sigma.empty() ? Vec3f::all(std::numeric_limits<float>::quiet_NaN()) : sigma.at<Vec3f>(y, x),
                                 colourAt(image, y, x)});
        }
    return cloud;
}

void writeCloud(const std::string& path, const Cloud& cloud, const std::string& unit)
{
    OutputFile file(path, ".ply");
    std::ofstream out(file.temporary(), std::ios::binary);
    out << headerOf(cloud, unit);
    writePoints(out, cloud);
    out.close();
    if (!out)
        throw Failure("cannot write '" + path + "': is the disk full?");
    file.commit();
}

} // namespace tools
