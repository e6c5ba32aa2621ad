// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/acceptance.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include <algorithm>
#include <cmath>
#include <map>

namespace tools {

namespace {

const char* const HEADING = "name,image1,id1,image2,id2,length,U";

//! Where points are, by their names; thousands of lengths ask.
class PointIndex
{
public:
    explicit PointIndex(const TestPoints& points) : points_(points), images_(points.images())
    {
        for (size_t i = 0; i < points.points.size(); i++)
            indices_.emplace(std::make_pair(points.points[i].image, points.points[i].id), (int)i);
    }
    const TestPoints& points() const { return points_; }
    const std::vector<std::string>& images() const { return images_; }
    int find(const std::string& image, const std::string& id) const
    {
        const auto found = indices_.find({image, id});
        return found == indices_.end() ? -1 : found->second;
    }

private:
    const TestPoints& points_;
    const std::vector<std::string> images_;
    std::map<std::pair<std::string, std::string>, int> indices_;
};

//! The points of one row: one pair, or one in each image.
class PairsOfRow
{
public:
    PairsOfRow(const CsvTable& table, const CsvTable::Row& row, const PointIndex& index)
        : table_(table), row_(row), index_(index), points_(index.points()) {}

    //! Indices into the points, and the image if it is one of many. @param untested gets images in which an end was not measured
    std::vector<std::pair<std::pair<size_t, size_t>, std::string>> all(std::vector<std::string>& untested) const
    {
        const std::string& image1 = table_.textOrNone(row_, "image1"), & image2 = table_.textOrNone(row_, "image2");
        const std::string& id1 = table_.text(row_, "id1"), & id2 = table_.text(row_, "id2");
        const std::vector<std::string>& images = index_.images();
        if (image1.empty() != image2.empty() && images.size() > 1)
            throw Failure(table_.where(row_) + ": give both images, or none for a length of each image");
        if (!image1.empty() || !image2.empty() || (images.size() == 1 && images[0].empty()))
            return {{{answered(image1, id1), answered(image2, id2)}, ""}};
        std::vector<std::pair<std::pair<size_t, size_t>, std::string>> pairs;
        for (const std::string& image : images)
        {
            const int end1 = index_.find(image, id1), end2 = index_.find(image, id2);
            if (isAnswered(end1) && isAnswered(end2))
                pairs.push_back({{end1, end2}, image});
            else if (end1 >= 0 || end2 >= 0)
                untested.push_back(image);
        }
        if (pairs.empty())
            throw Failure(table_.where(row_) + ": no image of '" + points_.source + "' shows both '" + id1 + "' and '" + id2
                          + "' with status 0");
        return pairs;
    }

private:
    bool isAnswered(int i) const
    {
        if (i < 0)
            return false;
        const TestPoint& p = points_.points[i];
        return p.status == 0 && std::isfinite(p.X.x + p.X.y + p.X.z);
    }

    size_t answered(const std::string& image, const std::string& id) const
    {
        const int i = index_.find(image, id);
        const std::string point = "the point '" + id + "'" + (image.empty() ? "" : " of the image '" + image + "'");
        if (i < 0)
            throw Failure(table_.where(row_) + ": " + point + " is not in '" + points_.source + "'");
        if (!isAnswered(i))
            throw Failure(table_.where(row_) + ": " + point + cv::format(" has status %d in '", points_.points[i].status) + points_.source
                          + "': it was not measured. Leave the length out, or measure it again");
        return (size_t)i;
    }

    const CsvTable& table_;
    const CsvTable::Row& row_;
    const PointIndex& index_;
    const TestPoints& points_;
};

//! Of a length of each image.
std::string nameIn(const std::string& name, const std::string& image) { return image.empty() ? name : name + ", " + image; }

double positive(const CsvTable& table, const CsvTable::Row& row, const std::string& name, const std::string& advice)
{
    const double number = table.numberOrNone(row, name);
    if (!(number > 0))
        throw Failure(table.where(row) + ": " + name + " must be more than 0: " + advice);
    return number;
}

} // namespace

std::vector<CertifiedSource> sourcesOf(const CalibratedLength& length)
{
    std::vector<CertifiedSource> sources = {{"the length as certified", "", 0.5*length.U, 1.}};
    sources.insert(sources.end(), length.ofTemperature.begin(), length.ofTemperature.end());
    return sources;
}

CalibratedLength StandardTemperature::applied(const CalibratedLength& length) const
{
    CalibratedLength result = length;
    const double warmer = temperature - reference;
    result.length *= 1. + expansion*warmer;
    result.ofTemperature = {{"temperature of the standard", cv::format("%.2g K", std), std, length.length*expansion},
                            {"expansion of the standard", cv::format("%.2g ppm/K", 1e6*expansionStd), expansionStd, length.length*warmer}};
    return result;
}

std::string remarkOfUntested(const std::vector<std::string>& untested)
{
    const size_t MOST = 5;
    if (untested.empty())
        return "";
    std::string names;
    for (size_t i = 0; i < std::min(untested.size(), MOST); i++)
        names += (i ? "; " : "") + untested[i];
    return cv::format("%zu length%s not tested, as an end was not measured (%s%s)",
                      untested.size(), untested.size() == 1 ? " was" : "s were", names.c_str(), untested.size() > MOST ? "; ..." : "");
}

std::vector<CalibratedLength> readLengths(const std::string& path, const TestPoints& points, std::vector<std::string>& untested)
{
    const CsvTable table(path, splitAtCommas(HEADING), "a file of calibrated lengths");
    const PointIndex index(points);
    std::vector<CalibratedLength> lengths;
    std::map<std::string, int> lineOfName;
    std::map<std::pair<size_t, size_t>, int> lineOfPair;
    for (const CsvTable::Row& row : table.rows())
    {
        const std::string& name = table.text(row, "name");
        const double length = positive(table, row, "length", "give what the certificate says");
        const double U = positive(table, row, "U", "a length without an uncertainty proves nothing; give its expanded uncertainty (k = 2), "
                                                   "as its certificate says");
        if (U >= length)
            throw Failure(table.where(row) + ": U is as large as the length: is it in the unit of the length?");
        if (!lineOfName.emplace(name, row.line).second)
            throw Failure(table.where(row) + ": the name '" + name + cv::format("' stands in line %d already", lineOfName[name]));
        std::vector<std::string> missing;
        const auto pairs = PairsOfRow(table, row, index).all(missing);
        for (const std::string& image : missing)
            untested.push_back(nameIn(name, image));
        for (const auto& pair : pairs)
        {
            const size_t a = pair.first.first, b = pair.first.second;
            if (a == b)
                throw Failure(table.where(row) + ": both ends are the same point");
            const auto first = lineOfPair.emplace(std::minmax(a, b), row.line);
            if (!first.second)
                throw Failure(table.where(row) + cv::format(": the length between these points stands in line %d already",
                                                                first.first->second));
            lengths.push_back({nameIn(name, pair.second), {a, b}, length, U});
        }
    }
    return lengths;
}

PermissibleError::PermissibleError(const std::string& text) : text_(text)
{
    const size_t plus = text.find('+', 1), over = text.find("L/");
    const bool isSum = over != std::string::npos;
    const std::string constant = isSum ? (over == 0 ? "0" : text.substr(0, plus)) : text;
    const bool good = parseNumber(constant, constant_) && (!isSum || (parseNumber(text.substr(over + 2), perLength_)
                                                                      && perLength_ > 0 && (over == 0 || plus + 1 == over)));
    if (!good || !(constant_ >= 0 && std::isfinite(constant_ + perLength_)) || !(constant_ + perLength_ > 0))
        throw Failure("--max-error=" + text + ": give a length, as in --max-error=0.05, or one that grows with the tested length L, as in "
                      "--max-error=0.02+L/5000");
}

} // namespace tools
