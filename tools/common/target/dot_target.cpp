// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/dot_target.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "target/refine_points.hpp"

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

namespace tools {

namespace {

const size_t FEWEST = 8;            // what matchDots() needs

//! Four words, of which the last three are numbers: OpenPTV's; empty: another line.
std::vector<std::string> wordsOfDot(const std::string& line)
{
    std::istringstream in(line);
    std::vector<std::string> words;
    double number;
    for (std::string word; in >> word; )
        words.push_back(word);
    return words.size() == 4 && std::all_of(words.begin(), words.end(), [&](const std::string& w) { return parseNumber(w, number); })
        ? words : std::vector<std::string>();
}

CsvTable tableOf(const std::string& path)
{
    std::ifstream in(path);
    std::vector<CsvTable::Row> rows;
    std::string line;
    for (int number = 1; takeLine(in, line); number++)
    {
        const std::vector<std::string> words = wordsOfDot(line);
        if (words.empty() && number == 1)
            return CsvTable(path, {"id", "x", "y", "z"}, "a list of dots");
        if (words.empty() && line.find_first_not_of(" \t\r") != std::string::npos)
            throw Failure("'" + path + "' line " + std::to_string(number) + ": number, x, y and z of a dot are expected, as in the lines "
                          "before");
        if (!words.empty())
            rows.push_back({number, words});
    }
    return rows.empty() ? CsvTable(path, {"id", "x", "y", "z"}, "a list of dots") : CsvTable(path, {"id", "x", "y", "z"}, rows);
}

/** What is about as wide as a scale, brighter than what is round it (or darker): uneven light and much of what else is in a
picture is gone. */
std::vector<cv::KeyPoint> blobsOf(const cv::Mat& grey, double scale, bool bright)
{
    const double AROUND = 3.2, GAIN = 6.;
    cv::Mat fine, coarse, band, bytes;
    grey.convertTo(fine, CV_32F, bright ? GAIN : -GAIN);
    cv::GaussianBlur(fine, coarse, cv::Size(), AROUND*scale);
    cv::GaussianBlur(fine, fine, cv::Size(), scale);
    band = fine - coarse;
    band.convertTo(bytes, CV_8U);
    cv::SimpleBlobDetector::Params limits;
    limits.minThreshold = 20;
    limits.blobColor = 255;
    limits.minArea = (float)(4*scale*scale);
    limits.maxArea = (float)(60*scale*scale);
    limits.minDistBetweenBlobs = (float)(3*scale);
    std::vector<cv::KeyPoint> blobs;
    cv::SimpleBlobDetector::create(limits)->detect(bytes, blobs);
    return blobs;
}

std::vector<cv::Point2d> placesOf(const std::vector<cv::KeyPoint>& blobs)
{
    std::vector<cv::Point2d> places;
    for (const cv::KeyPoint& blob : blobs)
        places.emplace_back(blob.pt);
    return places;
}

//! To the edges of the dots in the image itself.
std::vector<cv::Point2d> refined(const cv::Mat& grey, const std::vector<cv::KeyPoint>& blobs, const std::vector<int>& dots)
{
    const double RIM = 0.1;         // of a radius, that is left to the next dot
    std::vector<DotImage> images;
    std::vector<double> reach;
    for (int dot : dots)
        if (dot >= 0)
            images.push_back({blobs[dot].pt, cv::Matx22d::eye()*(2/blobs[dot].size)});
    for (const DotImage& one : images)
    {
        double room = INFINITY;
        for (const DotImage& other : images)
            if (&other != &one)
                room = std::min(room, one.out(other.centre) - 1 - RIM);
        reach.push_back(room);
    }
    refineDots(grey, images, reach);
    std::vector<cv::Point2d> centres;
    for (size_t i = 0, next = 0; i < dots.size(); i++)
        centres.push_back(dots[i] >= 0 ? images[next++].centre : cv::Point2d(NAN, NAN));
    return centres;
}

} // namespace

ListedDots readListedDots(const std::string& path)
{
    const CsvTable table = tableOf(path);
    ListedDots dots;
    std::map<std::string, int> ids;
    std::map<std::tuple<double, double, double>, int> places;
    for (const CsvTable::Row& row : table.rows())
    {
        const cv::Point3d X(table.number(row, "x"), table.number(row, "y"), table.number(row, "z"));
        const auto id = ids.insert({table.text(row, "id"), row.line});
        const auto place = places.insert({{X.x, X.y, X.z}, row.line});
        if (!id.second || !place.second)
            throw Failure(table.where(row) + ": the same " + (id.second ? "place" : "id") + " as in line "
                          + std::to_string(id.second ? place.first->second : id.first->second));
        dots.ids.push_back(table.text(row, "id"));
        dots.points.push_back(X);
    }
    if (dots.points.size() < FEWEST)
        throw Failure("'" + path + "' has " + std::to_string(dots.points.size()) + " dots, and a target has 8 or more");
    return dots;
}

std::vector<cv::Point2d> detectListedDots(const cv::Mat& grey, const std::vector<cv::Point3d>& dots)
{
    const double ENOUGH = 0.9;
    std::vector<int> best;
    std::vector<cv::KeyPoint> bestBlobs;
    const auto countOf = [](const std::vector<int>& found) { return found.size() - (size_t)std::count(found.begin(), found.end(), -1); };
    for (double scale : {1.5, 2.5, 4., 6.5, 10.5})      // of dots with a diameter of 3 to 40 pixels
        for (bool bright : {true, false})
        {
            if ((double)countOf(best) >= ENOUGH*(double)dots.size())
                break;
            const std::vector<cv::KeyPoint> blobs = blobsOf(grey, scale, bright);
            const std::vector<int> found = matchDots(dots, placesOf(blobs), grey.size());
            if (countOf(found) <= countOf(best))
                continue;
            best = found;
            bestBlobs = blobs;
        }
    return best.empty() ? std::vector<cv::Point2d>() : refined(grey, bestBlobs, best);
}

} // namespace tools
