// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/one_to_one.hpp"
#include <map>

namespace cv { namespace refract {

namespace {

//! Cells whose corners are regular, as far as they hang together with the middle.
Mat1b regularCells(const Mat1b& isRegular)
{
    const Range above(0, isRegular.rows - 1), below(1, isRegular.rows), left(0, isRegular.cols - 1), right(1, isRegular.cols);
    const Mat1b isFree = isRegular(above, left) & isRegular(above, right) & isRegular(below, left) & isRegular(below, right);
    Mat1b found = Mat1b::zeros(isFree.size());
    std::vector<Point> next(1, Point(isFree.cols/2, isFree.rows/2));
    while (!next.empty())
    {
        const Point cell = next.back();
        next.pop_back();
        if (!Rect(Point(), isFree.size()).contains(cell) || !isFree(cell) || found(cell))
            continue;
        found(cell) = 1;
        for (const Point& move : { Point(1, 0), Point(-1, 0), Point(0, 1), Point(0, -1) })
            next.push_back(cell + move);
    }
    return found;
}

//! Where a cell is seen.
Rect2d boxOf(const Mat2d& seen, const Point& cell)
{
    Vec2d low = seen(cell), high = low;
    for (const Point& corner : { Point(1, 0), Point(0, 1), Point(1, 1) })
        for (int k = 0; k < 2; k++)
        {
            low[k] = std::min(low[k], seen(cell + corner)[k]);
            high[k] = std::max(high[k], seen(cell + corner)[k]);
        }
    return Rect2d(Point2d(low[0], low[1]), Point2d(high[0], high[1]));
}

//! From the middle outwards, in units of cells, whatever their shape.
std::vector<Point> outwards(const Mat1b& cells)
{
    std::vector<Point> order;
    findNonZero(cells, order);
    const auto distance2 = [&](const Point& p)
    { return std::pow(p.x - 0.5*(cells.cols - 1), 2) + std::pow(p.y - 0.5*(cells.rows - 1), 2); };
    std::stable_sort(order.begin(), order.end(), [&](const Point& a, const Point& b) { return distance2(a) < distance2(b); });
    return order;
}

//! Cells by what they cover of the picture, in bins.
class Picture
{
public:
    explicit Picture(double bin) : bin_(bin) {}

    bool isFree(const Point& cell, const Rect2d& box) const
    {
        const int NEXT_TO = 2;
        bool isCovered = false;
        eachBin(box, [&](const std::pair<int, int>& bin)
        {
            const auto there = cells_.find(bin);
            for (size_t i = 0; there != cells_.end() && i < there->second.size() && !isCovered; i++)
            {
                const Point away = there->second[i].first - cell;
                isCovered = std::max(std::abs(away.x), std::abs(away.y)) > NEXT_TO && !(there->second[i].second & box).empty();
            }
        });
        return !isCovered;
    }

    void add(const Point& cell, const Rect2d& box)
    {
        eachBin(box, [&](const std::pair<int, int>& bin) { cells_[bin].push_back(std::make_pair(cell, box)); });
    }

private:
    template<typename Work> void eachBin(const Rect2d& box, const Work& work) const
    {
        for (int y = (int)std::floor(box.y/bin_); y*bin_ <= box.y + box.height; y++)
            for (int x = (int)std::floor(box.x/bin_); x*bin_ <= box.x + box.width; x++)
                work(std::make_pair(x, y));
    }

    const double bin_;
    std::map<std::pair<int, int>, std::vector<std::pair<Point, Rect2d> > > cells_;
};

} // namespace

Mat1b oneToOneCells(const Mat2d& seen, const Mat1b& isRegular)
{
    const double MOST_BINS = 100;           // across a cell: one that is larger is no part of any image
    const Mat1b candidates = regularCells(isRegular);
    const std::vector<Point> order = outwards(candidates);
    Mat1b kept = Mat1b::zeros(candidates.size());
    if (order.empty())
        return kept;
    const Rect2d middle = boxOf(seen, order[0]);
    const double bin = 2*std::max(middle.width, middle.height);
    Picture picture(bin);
    for (const Point& cell : order)
    {
        const Rect2d box = boxOf(seen, cell);
        if (std::max(box.width, box.height) > MOST_BINS*bin || !picture.isFree(cell, box))
            continue;
        picture.add(cell, box);
        kept(cell) = 1;
    }
    return kept;
}

}} // namespace
