// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/csv.hpp"
#include "console/byte_order_mark.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace tools {

namespace {

std::string trimmed(const std::string& text)
{
    const char* blanks = " \t\r";
    const size_t first = text.find_first_not_of(blanks);
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

//! 3,5 is a number where commas do not part cells, as spreadsheets of most of Europe have it.
std::string withPoint(const std::string& cell)
{
    std::string number = cell;
    double value;
    std::replace(number.begin(), number.end(), ',', '.');
    return number != cell && parseNumber(number, value) ? number : cell;
}

//! A quote in a quoted cell is doubled.
std::vector<std::string> cellsOf(const std::string& line, char separator)
{
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (size_t i = 0; i < line.size(); i++)
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            cells.back() += line[i++];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == separator && !quoted)
            cells.emplace_back();
        else
            cells.back() += line[i];
    for (std::string& cell : cells)
        cell = trimmed(cell);
    return cells;
}

//! 1,234 is another number where commas mark thousands.
bool maySeparateThousands(const std::string& cell)
{
    const size_t comma = cell.find(','), first = cell.find_first_not_of("+-");
    return comma != std::string::npos && withPoint(cell) != cell && cell.size() - comma == 4 && cell[first] != '0' && comma - first <= 3
           && cell.find_first_not_of("0123456789", comma + 1) == std::string::npos;
}

std::string joined(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ",") + name;
    return text;
}

//! One line.
bool readLine(std::istream& in, std::string& line, int number)
{
    if (!takeLine(in, line))
        return false;
    if (number == 1)
        line = withoutByteOrderMark(line);
    return true;
}

char separatorOf(const std::string& heading)
{
    for (const char separator : {',', ';', '\t'})
        if (heading.find(separator) != std::string::npos)
            return separator;
    return ',';
}

//! Names of columns are told from each other whatever their case is. @param known names, spelt as they are asked for
std::vector<std::string> namesOf(const std::string& heading, const std::vector<std::string>& known)
{
    const std::vector<std::string> given = cellsOf(heading, separatorOf(heading));
    std::vector<std::string> names, lower;
    for (const std::string& name : given)
        lower.push_back(inLowerCase(name));
    for (size_t i = 0; i < given.size(); i++)
    {
        const bool isOne = std::count(lower.begin(), lower.end(), lower[i]) == 1;      // X beside x is another
        names.push_back(isOne ? lower[i] : given[i]);
        for (const std::string& one : known)
            if (isOne && inLowerCase(one) == lower[i])
                names.back() = one;
    }
    return names;
}

bool isNothing(const std::string& line) { return trimmed(line).empty() || trimmed(line)[0] == '#'; }

//! Cells with blanks, commas or semicolons between; what stands in quotes is one cell.
std::vector<std::string> cellsOf(const std::string& line)
{
    std::vector<std::string> cells;
    bool quoted = false, between = true;
    for (const char c : line)
    {
        if (c == '"')
            quoted = !quoted;
        const bool separates = !quoted && (c == ',' || c == ';' || std::isspace((unsigned char)c));
        if (!separates && between)
            cells.emplace_back();
        if (!separates)
            cells.back() += c;
        between = separates;
    }
    return cells;
}

//! Index of the column called `name` or `name`1, or the number of columns.
size_t columnOf(const std::vector<std::string>& names, const std::string& name)
{
    return std::find_if(names.begin(), names.end(),
                        [&](const std::string& n) { return inLowerCase(n) == name || inLowerCase(n) == name + "1"; }) - names.begin();
}

} // namespace

std::vector<std::string> headingOf(const std::string& path)
{
    std::ifstream in(path);
    std::string line;
    for (int number = 1; readLine(in, line, number) && isNothing(line); number++) {}
    return namesOf(line, {});
}

CsvTable::CsvTable(const std::string& path, const std::vector<std::string>& required, const std::string& what) : path_(path)
{
    std::ifstream in(path);
    if (std::filesystem::is_directory(path))
        throw Failure("'" + path + "' is a folder: " + what + " is wanted");
    if (!in)
        throw Failure("there is no file '" + path + "' that can be read");
    char separator = ',';
    std::string line;
    for (int number = 1; readLine(in, line, number); number++)
    {
        if (number == 1 && (line.compare(0, 2, "\xFF\xFE") == 0 || line.compare(0, 2, "\xFE\xFF") == 0))
            throw Failure("'" + path + "' is UTF-16, as the shell of Windows writes it: save it as UTF-8");
        if (isNothing(line))
            continue;
        if (!names_.empty())
        {
            rows_.push_back({number, cellsOf(line, separator)});
            if (!isUtf8(line))
                throw Failure(where(rows_.back()) + ": a letter is not UTF-8: save the file in that encoding (often it is Latin-1)");
            if (rows_.back().cells.size() != names_.size())
                throw Failure(where(rows_.back()) + ": " + std::to_string(names_.size()) + " cells expected, as the heading has "
                              "names; is the file cut short?");
            continue;
        }
        separator = separatorOf(line);
        names_ = namesOf(line, required);
        for (const std::string& name : required)
            if (find(name) < 0)
                throw Failure("'" + path + "' line " + std::to_string(number) + ": there is no column '" + name + "': " + what
                              + " begins with the line " + joined(required));
    }
    if (rows_.empty())
        throw Failure("'" + path + "' has no rows: " + what + " begins with the line " + joined(required)
                      + ", and one row a line follows");
    if (separator != ',')
        takeDecimalCommas();
}

void CsvTable::takeDecimalCommas()
{
    const Row *withPoints = nullptr, *withThousands = nullptr;
    std::string thousands;
    double value;
    for (Row& row : rows_)
        for (std::string& cell : row.cells)
        {
            if (cell.find('.') != std::string::npos && parseNumber(cell, value))
                withPoints = &row;
            if (!withThousands && maySeparateThousands(cell))
            {
                withThousands = &row;
                thousands = cell;
            }
            cell = withPoint(cell);
        }
    if (!withPoints || !withThousands)
        return;
    std::string whole = thousands;
    whole.erase(whole.find(','), 1);
    throw Failure(where(*withThousands) + ": '" + thousands + "' may be " + whole + " or " + withPoint(thousands) + ", as line "
                  + std::to_string(withPoints->line) + " has a decimal point: write numbers in one way, without marks of thousands");
}

int CsvTable::find(const std::string& name) const
{
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? -1 : (int)(found - names_.begin());
}

std::string CsvTable::where(const Row& row) const
{
    return "'" + path_ + "' line " + std::to_string(row.line);
}

const std::string& CsvTable::cellOf(const Row& row, const std::string& name) const
{
    const int column = find(name);
    if (column < 0)
        throw Failure("'" + path_ + "': there is no column '" + name + "'");
    return row.cells[column];
}

const std::string& CsvTable::text(const Row& row, const std::string& name) const
{
    const std::string& cell = cellOf(row, name);
    if (cell.empty())
        throw Failure(where(row) + ": " + name + " is empty");
    return cell;
}

const std::string& CsvTable::textOrNone(const Row& row, const std::string& name) const { return cellOf(row, name); }

double CsvTable::number(const Row& row, const std::string& name) const
{
    double value;
    if (!parseNumber(text(row, name), value) || !std::isfinite(value))
        throw Failure(where(row) + ": " + name + " must be a number, not '" + text(row, name) + "'");
    return value;
}

double CsvTable::numberOrNone(const Row& row, const std::string& name) const
{
    const std::string& cell = cellOf(row, name);
    return cell.empty() || cell == "nan" || cell == "NaN" ? std::numeric_limits<double>::quiet_NaN() : number(row, name);
}

cv::Point2d CsvTable::pixelOrNone(const Row& row, const std::string& u, const std::string& v) const
{
    const cv::Point2d pixel(numberOrNone(row, u), numberOrNone(row, v));
    if (std::isnan(pixel.x) != std::isnan(pixel.y))
        throw Failure(where(row) + ": " + u + " and " + v + " must both be numbers, or both empty");
    return pixel;
}

std::string cellOf(const std::string& text)
{
    if (text.find_first_of(", ;\t\"\n\r") == std::string::npos)
        return text;
    std::string cell = "\"";
    for (char c : text)
        cell += c == '"' ? std::string("\"\"") : std::string(1, c);
    return cell + "\"";
}

std::vector<cv::Point2d> readPixels(const std::string& path)
{
    std::ifstream in(path);
    if (!in)
        throw Failure("there is no file '" + path + "' that can be read");
    std::vector<cv::Point2d> pixels;
    size_t u = 0, v = 1;
    std::string line;
    bool first = true;
    for (int number = 1; takeLine(in, line); number++)
    {
        const std::vector<std::string> cells = cellsOf(line);
        if (cells.empty() || cells[0][0] == '#')
            continue;
        const bool heading = first && columnOf(cells, "u") < cells.size() && columnOf(cells, "v") < cells.size();
        first = false;
        if (heading)
        {
            u = columnOf(cells, "u");
            v = columnOf(cells, "v");
            continue;
        }
        cv::Point2d pixel;
        if (std::max(u, v) >= cells.size() || !parseNumber(cells[u], pixel.x)
            || !parseNumber(cells[v], pixel.y))
            throw Failure("'" + path + "' line " + std::to_string(number) + ": two numbers u v are needed");
        if (std::isfinite(pixel.x) && std::isfinite(pixel.y))       // nan: not seen
            pixels.push_back(pixel);
    }
    if (pixels.empty())
        throw Failure("'" + path + "' has no points: give one 'u v' a line");
    return pixels;
}

void putNumbers(std::ostream& csv, const std::vector<double>& numbers)
{
    for (double number : numbers)
        std::isnan(number) ? csv << ",nan" : csv << ',' << number;
}

PointsCsv::PointsCsv(size_t cameras, size_t stds)
{
    csv_.precision(12);
    csv_ << "image,id";
    for (size_t c = 1; c <= cameras; c++)
        csv_ << ",u" << c << ",v" << c;
    for (size_t c = 1; c <= stds; c++)
        csv_ << ",std" << c;
    csv_ << ",x,y,z,sx,sy,sz,status\n";
}

void PointsCsv::add(const std::string& image, const std::string& id, const std::vector<double>& seen, const cv::Point3d& X,
                    const cv::Vec3d& sigma, int status)
{
    csv_ << cellOf(image) << ',' << cellOf(id);
    putNumbers(csv_, seen);
    putNumbers(csv_, {X.x, X.y, X.z, sigma[0], sigma[1], sigma[2]});
    csv_ << ',' << status << '\n';
}

} // namespace tools
