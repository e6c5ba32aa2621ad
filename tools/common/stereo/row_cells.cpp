// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/row_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Point;

static bool isPoint(const cv::Vec3f& X) { return X[2] == X[2]; }

std::vector<RowCell> rowCellsOf(const DenseStereo& stereo)
{
    const Mat& values = stereo.rowOffset;
    const int PATCH = 13*13, SIDE = 80, EVERY = 2, MOST = 8, ENOUGH = 200;
    const int columns = std::clamp(values.cols/SIDE, 1, MOST), rows = std::clamp(values.rows/SIDE, 1, MOST);
    std::vector<RowCell> result;
    for (int i = 0; i < columns*rows; i++)
    {
        const int column = i % columns, row = i/columns;
        std::vector<std::pair<float, Point>> cell;
        for (int y = values.rows*row/rows; y < values.rows*(row + 1)/rows; y += EVERY)
            for (int x = values.cols*column/columns; x < values.cols*(column + 1)/columns; x += EVERY)
                if (values.at<float>(y, x) == values.at<float>(y, x) && isPoint(stereo.points.at<cv::Vec3f>(y, x)))
                    cell.push_back({values.at<float>(y, x), Point(x, y)});
        if ((int)cell.size() < ENOUGH)
            continue;
        const auto less = [](const std::pair<float, Point>& a, const std::pair<float, Point>& b) { return a.first < b.first; };
        const auto at = [&](double part) {
            const auto place = cell.begin() + (int)(part*((double)cell.size() - 1));
            std::nth_element(cell.begin(), place, cell.end(), less);
            return *place;
        };
        // Half of normal numbers are within 0.6745 sigma, and the median of n has 1.2533 times the mean's deviation.
        const double spread = (at(0.75).first - at(0.25).first)/(2*0.6745);
        const double independent = std::max(1., (double)cell.size()*EVERY*EVERY/PATCH);
        const auto median = at(0.5);
        result.push_back({median.second, median.first, 1.2533*spread/std::sqrt(independent)});
    }
    return result;
}

double rowOffsetOf(const std::vector<RowCell>& cells)
{
    double squares = 0;
    for (const RowCell& cell : cells)
        squares += cell.offset*cell.offset;
    return cells.empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(squares/(double)cells.size());
}

} // namespace tools
