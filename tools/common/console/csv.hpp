// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CSV_HPP
#define REFRACT_TOOLS_CSV_HPP

#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace tools {

/** A table from a text file with commas between the cells: a line of column names, in any case, then one row a line. Quotes as
spreadsheets write them; empty lines and those with '#' first are skipped; where the heading has semicolons and no comma, or tabs and none
of these, they separate, and numbers may have decimal commas: not 1,234 where others have decimal points.
Everything throws Failure that names file and line. */
class CsvTable
{
public:
    struct Row
    {
        int line;
        std::vector<std::string> cells;
    };

    /** @param required columns; @param what the file is, for the text where one is missing */
    CsvTable(const std::string& path, const std::vector<std::string>& required, const std::string& what);

    //! Of what was read from a file in another form.
    CsvTable(const std::string& path, const std::vector<std::string>& names, const std::vector<Row>& rows)
        : path_(path), names_(names), rows_(rows) {}

    const std::vector<Row>& rows() const { return rows_; }
    const std::vector<std::string>& names() const { return names_; }
    int find(const std::string& name) const;            //!< column; -1: there is none
    std::string where(const Row& row) const;            //!< "'file' line 12"

    const std::string& text(const Row& row, const std::string& name) const;
    const std::string& textOrNone(const Row& row, const std::string& name) const;       //!< may be empty
    double number(const Row& row, const std::string& name) const;               //!< finite
    double numberOrNone(const Row& row, const std::string& name) const;         //!< NaN where the cell is empty or nan
    //! Where a point was seen: two numbers, or both NaN.
    cv::Point2d pixelOrNone(const Row& row, const std::string& u, const std::string& v) const;

private:
    const std::string& cellOf(const Row& row, const std::string& name) const;
    void takeDecimalCommas();       //!< Failure if commas may mark thousands

    std::string path_;
    std::vector<std::string> names_;
    std::vector<Row> rows_;
};

//! The column names that a file begins with, in lower case; an empty one: there is nothing to read.
std::vector<std::string> headingOf(const std::string& path);

//! A cell of a table with commas between; blanks are quoted too, for readers that split at them.
std::string cellOf(const std::string& text);

/** Pixels from a text file, one "u v" or "u,v" a line; lines with '#' are comments. A first line with the column names u, v
(or u1, v1: the points.csv of refract_measure) tells which columns to take; otherwise it is the first two.
Throws Failure that names file and line. */
std::vector<cv::Point2d> readPixels(const std::string& path);

//! Numbers of a row, each with a comma before it; NaN as nan.
void putNumbers(std::ostream& csv, const std::vector<double>& numbers);

//! A table of measured points: image,id,u1,v1,...[,std1,...],x,y,z,sx,sy,sz,status.
class PointsCsv
{
public:
    //! @param stds how many columns there are of a pixel's standard deviation
    explicit PointsCsv(size_t cameras, size_t stds = 0);
    //! @param seen pixels of all cameras, then their deviations
    void add(const std::string& image, const std::string& id, const std::vector<double>& seen, const cv::Point3d& X,
             const cv::Vec3d& sigma, int status);
    std::string text() const { return csv_.str(); }

private:
    std::ostringstream csv_;
};

} // namespace tools

#endif // REFRACT_TOOLS_CSV_HPP
