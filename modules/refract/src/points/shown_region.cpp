// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/shown_region.hpp"
#include "points/largest_rectangle.hpp"
#include "points/plane.hpp"
#include "opencv2/imgproc.hpp"

namespace cv { namespace refract {

namespace {

const double FARTHEST = 57.29;      // tan(89 degrees): a new image that reached farther would show next to nothing
const double ROUNDING = 1e-4;       // px that a pixel may be outside of the raw image, as maps of float32 are rounded

Rect2d rectangleBetween(const Point2d& tl, const Point2d& br) { return Rect2d(tl.x, tl.y, br.x - tl.x, br.y - tl.y); }

//! Of its sides, the one that is farthest from the axis.
double reachOf(const Rect2d& r)
{
    return std::max(std::max(-r.x, r.x + r.width), std::max(-r.y, r.y + r.height));
}

//! n places on each side of a rectangle, corners twice.
std::vector<Point2d> borderOf(const Rect2d& r, Size n)
{
    std::vector<Point2d> places;
    const int lastColumn = std::max(n.width - 1, 1), lastRow = std::max(n.height - 1, 1);
    for (int i = 0; i < n.width; i++)
        for (double y : { r.y, r.y + r.height })
            places.push_back(Point2d(r.x + i*r.width/lastColumn, y));
    for (int i = 0; i < n.height; i++)
        for (double x : { r.x, r.x + r.width })
            places.push_back(Point2d(x, r.y + i*r.height/lastRow));
    return places;
}

} // namespace

struct ShownRegion::Box
{
    Point2d tl = Point2d(DBL_MAX, DBL_MAX), br = Point2d(-DBL_MAX, -DBL_MAX);
    void add(const Point2d& p)
    {
        tl = Point2d(std::min(tl.x, p.x), std::min(tl.y, p.y));
        br = Point2d(std::max(br.x, p.x), std::max(br.y, p.y));
    }
};

ShownRegion::ShownRegion(const PinholeView& view, Size imageSize)
    : view_(view), cameraToNew_(view.newToCamera.t()), size_(imageSize)
{
    const double right = imageSize.width - 1, bottom = imageSize.height - 1;
    const Vec2d from[] = { Vec2d(0, 0), Vec2d(right, 0), Vec2d(0, 0), Vec2d(0, bottom) };
    const Vec2d to[] = { Vec2d(0, bottom), Vec2d(right, bottom), Vec2d(right, 0), Vec2d(right, bottom) };
    for (int side = 0; side < 4; side++)
    {
        double u[BLOCK], v[BLOCK];
        Point2d places[BLOCK];
        Seen seen[BLOCK];
        for (int i = 0; i < BLOCK; i++)
        {
            const Vec2d pixel = from[side] + (to[side] - from[side])*(i/(BLOCK - 1.));
            u[i] = pixel[0];
            v[i] = pixel[1];
        }
        placesOf(BLOCK, u, v, places, seen);
        for (int i = 0; i < BLOCK; i++)
            if (seen[i] == SHOWN)
                sides_[side].push_back(places[i]);
    }
}

void ShownRegion::placesOf(int n, const double* u, const double* v, Point2d* places, Seen* seen) const
{
    Rays rays;
    double x[BLOCK], y[BLOCK], z[BLOCK], mu[BLOCK], planeD[BLOCK];
    uchar hasRay[BLOCK], status[BLOCK];
    const Vec3d abc(view_.plane.val);
    const Vec3d normal = cameraToNew_*abc;
    const bool isFrontal = std::abs(normal[0]) + std::abs(normal[1]) < DBL_EPSILON*8*std::abs(normal[2]);
    std::fill(hasRay, hasRay + n, (uchar)REFRACT_OK);
    std::fill(planeD, planeD + n, view_.plane[3]);
    view_.camera.unproject(n, u, v, rays, hasRay);
    std::copy(hasRay, hasRay + n, status);
    meetPlane(view_.camera.layers(), n, abc, planeD, rays, x, y, z, mu, status);
    for (int i = 0; i < n; i++)
    {
        const Vec3d X = cameraToNew_*(Vec3d(x[i], y[i], z[i]) - mu[i]*view_.centre);
        places[i] = Point2d(X[0]/X[2], X[1]/X[2]);
        if (status[i] == REFRACT_OK)
            seen[i] = X[2] > 0 ? SHOWN : BEHIND;
        else        // next to rays along a frontal plane are those that see it infinitely far from the axis
            seen[i] = hasRay[i] == REFRACT_OK && isFrontal && !((cameraToNew_*rays.direction(i))[2] > 0) ? BEHIND : NOTHING;
    }
}

std::vector<uchar> ShownRegion::areShown(const std::vector<Point2d>& places) const
{
    std::vector<uchar> shown(places.size());
    forEachBlock((int)places.size(), [&](int begin, int n)
    {
        double x[BLOCK] = {}, y[BLOCK] = {}, u[BLOCK], v[BLOCK];    // g++ 12 at -O2 does not see that all n are set
        uchar status[BLOCK];
        for (int i = 0; i < n; i++)
        {
            x[i] = places[begin + i].x;
            y[i] = places[begin + i].y;
        }
        view_.toRaw(n, x, y, NULL, u, v, status);
        for (int i = 0; i < n; i++)
            shown[begin + i] = status[i] == REFRACT_OK && u[i] >= -ROUNDING && v[i] >= -ROUNDING &&
                               u[i] <= size_.width - 1 + ROUNDING && v[i] <= size_.height - 1 + ROUNDING;
    });
    return shown;
}

bool ShownRegion::isAllShown(const Rect2d& r, Size size) const
{
    const int INSIDE = 64;      // places across, where a hole would be seen, as that at the end of a tube
    std::vector<Point2d> inside;
    for (int i = 1; i < INSIDE*INSIDE; i++)
        inside.push_back(Point2d(r.x + (i % INSIDE)*r.width/INSIDE, r.y + i/INSIDE*r.height/INSIDE));
    for (const std::vector<Point2d>& places : { borderOf(r, Size(2, 2)), inside, borderOf(r, size) })
    {
        const std::vector<uchar> shown = areShown(places);
        if (std::find(shown.begin(), shown.end(), 0) != shown.end())
            return false;
    }
    return true;
}

//! The place of the raw pixel that is farthest from those that show nothing.
bool ShownRegion::findSeed(Point2d& seed) const
{
    enum { GRID = 33 };
    Mat1b isShown(GRID + 2, GRID + 2, (uchar)0);
    Point2d places[GRID][BLOCK];
    for (int row = 0; row < GRID; row++)
    {
        double u[GRID], v[GRID];
        Seen seen[GRID];
        for (int i = 0; i < GRID; i++)
        {
            u[i] = (size_.width - 1)*i/(GRID - 1.);
            v[i] = (size_.height - 1)*row/(GRID - 1.);
        }
        placesOf(GRID, u, v, places[row], seen);
        for (int i = 0; i < GRID; i++)
            isShown(row + 1, i + 1) = seen[i] == SHOWN ? 255 : 0;
    }
    Mat distance;
    double deepest;
    Point at;
    distanceTransform(isShown, distance, DIST_C, 3);
    minMaxLoc(distance, NULL, &deepest, NULL, &at);
    if (deepest == 0)
        return false;
    seed = places[at.y - 1][at.x - 1];
    return true;
}

//! Inside of all sides, as far as they are shown.
Rect2d ShownRegion::betweenSides(const Point2d& seed) const
{
    Point2d tl(seed.x - FARTHEST, seed.y - FARTHEST), br(seed.x + FARTHEST, seed.y + FARTHEST);
    const auto most = [&](int side, bool isY, int sign)
    {
        double result = -DBL_MAX;
        for (const Point2d& p : sides_[side])
            result = std::max(result, sign*(isY ? p.y : p.x));
        return sign*result;
    };
    const double left = most(0, false, 1), right = most(1, false, -1), top = most(2, true, 1), bottom = most(3, true, -1);
    // What a side shows beyond the seed does not bound what is round it.
    if (!sides_[0].empty() && left < seed.x)
        tl.x = std::max(tl.x, left);
    if (!sides_[1].empty() && right > seed.x)
        br.x = std::min(br.x, right);
    if (!sides_[2].empty() && top < seed.y)
        tl.y = std::max(tl.y, top);
    if (!sides_[3].empty() && bottom > seed.y)
        br.y = std::min(br.y, bottom);
    return rectangleBetween(tl, br);
}

//! Where the region ends on the ways from the seed to the targets; of a way that does not leave it, nothing.
std::vector<Point2d> ShownRegion::endsTowards(const Point2d& seed, const std::vector<Point2d>& targets) const
{
    const int STEPS = 64, BISECTIONS = 40;
    struct Way { Point2d step; double length, from, to; };
    std::vector<Way> ways;
    for (const Point2d& target : targets)
    {
        const double length = norm(target - seed);
        if (length > 0)
            ways.push_back({ (target - seed)/length, length, 0, 0 });
    }
    const auto look = [&](const std::vector<double>& at)
    {
        std::vector<Point2d> places;
        for (size_t i = 0; i < ways.size(); i++)
            places.push_back(seed + at[i]*ways[i].step);
        return areShown(places);
    };
    std::vector<double> at(ways.size());
    for (int k = 1; k <= STEPS; k++)        // equal steps of the angle
    {
        for (size_t i = 0; i < ways.size(); i++)
            at[i] = k == STEPS ? ways[i].length : std::tan(std::atan(ways[i].length)*k/STEPS);
        const std::vector<uchar> shown = look(at);
        for (size_t i = 0; i < ways.size(); i++)
            if (ways[i].to == 0)
                (shown[i] ? ways[i].from : ways[i].to) = at[i];
    }
    ways.erase(std::remove_if(ways.begin(), ways.end(), [](const Way& way) { return way.to == 0; }), ways.end());
    at.resize(ways.size());
    for (int k = 0; k < BISECTIONS; k++)
    {
        for (size_t i = 0; i < ways.size(); i++)
            at[i] = 0.5*(ways[i].from + ways[i].to);
        const std::vector<uchar> shown = look(at);
        for (size_t i = 0; i < ways.size(); i++)
            (shown[i] ? ways[i].from : ways[i].to) = at[i];
    }
    std::vector<Point2d> ends;
    for (const Way& way : ways)
        ends.push_back(seed + way.from*way.step);
    return ends;
}

bool ShownRegion::hasWholeBorder() const
{
    return std::all_of(sides_, sides_ + 4, [](const std::vector<Point2d>& side) { return side.size() == (size_t)BLOCK; });
}

bool ShownRegion::findInner(Size size, Rect2d& inner) const
{
    const int WAYS = 256, HALVINGS = 20;
    const double MARGIN = 1e-9;         // of the rectangle: where the lens folds there is no answer beyond the end
    Point2d seed;
    if (!findSeed(seed))
        return false;
    const Rect2d limits = betweenSides(seed);
    const auto isUnbounded = [&](const Rect2d& r) { return reachOf(r - seed) > (1 - MARGIN)*FARTHEST; };
    inner = limits;
    if (isAllShown(limits, size))
        return !isUnbounded(limits);
    const Rect2d largest = largestRectangle(seed, limits, endsTowards(seed, borderOf(limits, Size(WAYS, WAYS))));
    if (isUnbounded(largest))
        return false;
    // Between two ends the region may end a little before.
    const auto scaled = [&](double scale)
    {
        return Rect2d(seed.x + scale*(largest.x - seed.x), seed.y + scale*(largest.y - seed.y), scale*largest.width,
                      scale*largest.height);
    };
    double least = isAllShown(largest, size) ? 1 : 0, most = 1;
    for (int k = 0; k < HALVINGS && least < 1; k++)
    {
        const double scale = 0.5*(least + most);
        (isAllShown(scaled(scale), size) ? least : most) = scale;
    }
    inner = scaled(least - MARGIN);
    return inner.width > 0 && inner.height > 0;
}

//! Of raw pixels what they see, and round the places of those that are shown.
std::vector<uchar> ShownRegion::look(const std::vector<Point2d>& pixels, Box& box) const
{
    std::vector<uchar> result;
    for (size_t begin = 0; begin < pixels.size(); begin += BLOCK)
    {
        double u[BLOCK] = {}, v[BLOCK] = {};
        Point2d places[BLOCK];
        Seen seen[BLOCK];
        const int n = (int)std::min(pixels.size() - begin, (size_t)BLOCK);
        for (int i = 0; i < n; i++)
        {
            u[i] = pixels[begin + i].x;
            v[i] = pixels[begin + i].y;
        }
        placesOf(n, u, v, places, seen);
        for (int i = 0; i < n; i++)
        {
            result.push_back((uchar)seen[i]);
            if (seen[i] == SHOWN)
                box.add(places[i]);
        }
    }
    return result;
}

/** The raw pixels of all cells of a grid at whose corners some show the plane and others do not: there the region ends within the
image. What is farthest from the axis is at an end of the region. */
std::vector<Point2d> ShownRegion::pixelsAtEnds(Box& box) const
{
    const int CELL = 8;
    const auto cornersOf = [](int length)
    {
        std::vector<int> corners;
        for (int i = 0; i < length - 1; i += CELL)
            corners.push_back(i);
        corners.push_back(length - 1);
        return corners;
    };
    const std::vector<int> columns = cornersOf(size_.width), rows = cornersOf(size_.height);
    std::vector<Point2d> corners, pixels;
    for (int row : rows)
        for (int column : columns)
            corners.push_back(Point2d(column, row));
    const std::vector<uchar> seen = look(corners, box);
    for (size_t r = 0; r + 1 < rows.size(); r++)
        for (size_t c = 0; c + 1 < columns.size(); c++)
        {
            const uchar* above = &seen[r*columns.size() + c];
            const uchar* below = above + columns.size();
            if (above[0] == above[1] && above[0] == below[0] && above[0] == below[1])
                continue;
            for (int y = rows[r]; y <= rows[r + 1]; y++)
                for (int x = columns[c]; x <= columns[c + 1]; x++)
                    pixels.push_back(Point2d(x, y));
        }
    return pixels;
}

bool ShownRegion::findOuter(Rect2d& outer) const
{
    Box box;
    for (const std::vector<Point2d>& side : sides_)
        for (const Point2d& p : side)
            box.add(p);
    std::vector<uchar> seen = look(borderOf(Rect2d(0, 0, size_.width - 1, size_.height - 1), size_), box);
    const auto isAhead = [&] { return std::find(seen.begin(), seen.end(), BEHIND) == seen.end(); };
    if (!isAhead())
        return false;
    if (std::find(seen.begin(), seen.end(), NOTHING) != seen.end())
        seen = look(pixelsAtEnds(box), box);
    outer = rectangleBetween(box.tl, box.br);
    return isAhead() && outer.width > 0 && outer.height > 0 && reachOf(outer) < FARTHEST;
}

double scaleToImage(const Rect2d& r, const Vec2d& focal, const Point2d& principal, Size size, bool covers)
{
    const auto isInside = [](const Rect2d& in, const Point2d& p) { return p.x > in.x && p.y > in.y && p.x < in.br().x && p.y < in.br().y; };
    if (!isInside(r, Point2d()) || !isInside(Rect2d(0, 0, size.width - 1, size.height - 1), principal))
        return std::numeric_limits<double>::quiet_NaN();
    const double left = principal.x/focal[0], right = (size.width - 1 - principal.x)/focal[0];
    const double above = principal.y/focal[1], below = (size.height - 1 - principal.y)/focal[1];
    const double ratios[] = { -left/r.x, -above/r.y, right/(r.x + r.width), below/(r.y + r.height) };
    return covers ? *std::max_element(ratios, ratios + 4) : *std::min_element(ratios, ratios + 4);
}

Rect pixelsWithin(const Rect2d& r, const Vec2d& focal, const Point2d& principal, Size size)
{
    const double NOT_BELOW = 1e-9;      // px; the border itself is valid, whatever was rounded
    const Point tl(cvCeil(focal[0]*r.x + principal.x - NOT_BELOW), cvCeil(focal[1]*r.y + principal.y - NOT_BELOW));
    const Point br(cvFloor(focal[0]*(r.x + r.width) + principal.x + NOT_BELOW),
                   cvFloor(focal[1]*(r.y + r.height) + principal.y + NOT_BELOW));
    return Rect(tl, br + Point(1, 1)) & Rect(Point(), size);
}

}} // namespace
