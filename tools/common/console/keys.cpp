// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/keys.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <numeric>

namespace tools {

using cv::FileNode;

Keys::Keys(const FileNode& node, const std::string& name) : node_(node), name_(name)
{
    if (!node.empty() && !node.isMap())
        throw Failure(name + " must be keys with values, as in { key: value }");
}

double Keys::number(const std::string& key, double least, double most, double otherwise) const
{
    const FileNode node = node_[key];
    if (node.empty() && !std::isnan(otherwise))
        return otherwise;
    const double value = node.isReal() || node.isInt() ? (double)node : NAN;
    if (!(value >= least && value <= most))
        throw Failure(name_ + ": '" + key + "' must be a number" + cv::format(" from %g to %g", least, most));
    return value;
}

std::string Keys::text(const std::string& key, const std::string& otherwise) const
{
    const FileNode node = node_[key];
    if (!node.empty() && !node.isString())
        throw Failure(name_ + ": '" + key + "' must be a text");
    return node.empty() ? otherwise : (std::string)node;
}

std::vector<double> Keys::numbers(const std::string& key, size_t count) const
{
    std::vector<double> values;
    if (node_[key].isSeq())
        node_[key] >> values;
    if (values.size() != count || !cv::checkRange(values))
        throw Failure(name_ + ": '" + key + "' must be a list of " + std::to_string(count) + " numbers");
    return values;
}

cv::Vec3d Keys::vector(const std::string& key) const
{
    return cv::Vec3d(numbers(key, 3).data());
}

cv::Vec3d Keys::vector(const std::string& key, const cv::Vec3d& otherwise) const
{
    return has(key) ? vector(key) : otherwise;
}

void Keys::allowOnly(const std::vector<std::string>& known) const
{
    std::string names;
    for (const std::string& name : known)
        names += (names.empty() ? "" : ", ") + name;
    for (const std::string& key : node_.empty() ? std::vector<std::string>() : node_.keys())
        if (std::find(known.begin(), known.end(), key) == known.end())
            throw Failure(name_ + ": there is no key '" + key + "'; it takes " + names);
}

namespace {

//! Levenshtein's distance: letters to insert, delete or replace.
size_t editDistance(const std::string& a, const std::string& b)
{
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t(0));
    for (size_t i = 1; i <= a.size(); i++)
    {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); j++)
        {
            const size_t above = row[j];
            row[j] = std::min(std::min(above, row[j - 1]) + 1, diagonal + (a[i - 1] != b[j - 1]));
            diagonal = above;
        }
    }
    return row[b.size()];
}

} // namespace

void requireNoMisspelling(const FileNode& node, const std::vector<std::string>& known, const std::string& filename, size_t shortest)
{
    const size_t FEW = 2, SHORT = 6;    // letters, of a shorter name one
    const auto isKnown = [&known](const std::string& key) {         // with a number it is that of another camera
        return std::find(known.begin(), known.end(), key.substr(0, key.find_last_not_of("0123456789") + 1)) != known.end(); };
    for (const std::string& key : node.isMap() ? node.keys() : std::vector<std::string>())
        for (const std::string& name : known)
            if (name.size() >= shortest && !isKnown(key) && editDistance(key, name) <= (name.size() < SHORT ? 1 : FEW))
                throw Failure("'" + filename + "' has a key '" + key + "', which nothing reads: is it '" + name + "'?");
}

} // namespace tools
