// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TABLE_HPP
#define REFRACT_TOOLS_TABLE_HPP

#include <opencv2/core.hpp>
#include <iosfwd>
#include <string>
#include <vector>

namespace tools {

/** A plain text table: the first column flush left, the others flush right. Fits a terminal: where it is wider, the cells of the
widest columns are broken between words. */
class Table
{
public:
    //! @param screen columns of the terminal
    explicit Table(const std::vector<std::string>& heading, size_t screen = 100);
    void add(const std::vector<std::string>& row);      //!< missing cells are empty
    void print(std::ostream& out) const;
private:
    std::vector<size_t> columnWidths() const;

    std::vector<std::vector<std::string>> rows_;
    size_t screen_;
};

using cv::format;   //!< printf for a cell

//! "7.040 +- 0.020": two digits of the standard deviation, and the value as far.
std::string plusMinus(double value, double std);

} // namespace tools

#endif // REFRACT_TOOLS_TABLE_HPP
