// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_KEYS_HPP
#define REFRACT_TOOLS_KEYS_HPP

#include <opencv2/core.hpp>
#include <cmath>
#include <string>
#include <vector>

namespace tools {

//! The keys of one map of a file. Throws Failure that names the map and the key.
class Keys
{
public:
    //! @param node a map, or empty: then it has no keys
    Keys(const cv::FileNode& node, const std::string& name);

    const std::string& name() const { return name_; }
    bool has(const std::string& key) const { return !node_[key].empty(); }
    double number(const std::string& key, double least, double most, double otherwise = NAN) const;
    std::string text(const std::string& key, const std::string& otherwise) const;
    std::vector<double> numbers(const std::string& key, size_t count) const;
    cv::Vec3d vector(const std::string& key) const;
    cv::Vec3d vector(const std::string& key, const cv::Vec3d& otherwise) const;

    //! Throws Failure for any other key: it is a typing error.
    void allowOnly(const std::vector<std::string>& known) const;

private:
    cv::FileNode node_;
    std::string name_;
};

/** Of files that may have other programs' keys, too: throws Failure for a key that is nearly a known one (two letters less, more or other,
of a short one one), and no other's, so that a typing error does not become a default.
@param shortest letters: of a shorter name few make another */
void requireNoMisspelling(const cv::FileNode& node, const std::vector<std::string>& known, const std::string& filename,
                          size_t shortest = 9);

} // namespace tools

#endif // REFRACT_TOOLS_KEYS_HPP
