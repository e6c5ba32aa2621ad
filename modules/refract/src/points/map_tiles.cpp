// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/map.hpp"
#include "arrays/array_kernels.hpp"
#include "points/point_kernels.hpp"
#include <climits>
#include <mutex>

/* Pixels of the pinhole camera without window -> raw pixels, for whole images (initRefractiveUndistortRectifyMap).

The map is smooth almost everywhere and is wanted to float32 or 1/32 px. So the new image is cut into tiles; in each
the exact answer is found at Chebyshev's nodes only, and the pixels follow from the polynomial through them. Whether
it is good enough is measured where the error of such a polynomial is largest, corners, middles of the sides and
centre of the tile: it must be below TOLERANCE, a tenth of the rounding to float32 beyond pixel 16. A tile where it is
not, or where a pixel that is asked has no answer, is solved pixel by pixel. */

namespace cv { namespace refract {

namespace {

const int TILE = 64;
const double TOLERANCE = 1e-7;

double nodeAngle(int k) { return CV_PI*(k + 0.5)/NODES; }

/* What the values at the nodes contribute at some places of a tile's row or column: Lagrange's polynomials of
Chebyshev's nodes, L_k(x) = (1 + 2 sum T_m(x_k) T_m(x))/NODES. x = -1 and 1 are one pixel outside the tile: the
border of what has an answer, should it bend, does not pass between the places that are asked. */
template<int N>
struct Weights
{
    double place[N], node[NODES];       //!< px from the tile's first
    double byNode[NODES][N], byPlace[N][NODES];

    Weights(double first, double step)
    {
        for (int k = 0; k < NODES; k++)
            node[k] = CENTRE + HALF*std::cos(nodeAngle(k));
        for (int i = 0; i < N; i++)
        {
            place[i] = first + step*i;
            const double angle = std::acos((place[i] - CENTRE)/HALF);
            for (int k = 0; k < NODES; k++)
            {
                double sum = 1;
                for (int m = 1; m < NODES; m++)
                    sum += 2*std::cos(m*nodeAngle(k))*std::cos(m*angle);
                byNode[k][i] = byPlace[i][k] = sum/NODES;
            }
        }
    }
    static constexpr double CENTRE = (TILE - 1)/2., HALF = (TILE + 1)/2.;
};

typedef Weights<TILE> PixelWeights;
typedef Weights<3> CheckWeights;

//! Raw pixels at a tile's nodes, row by row.
struct Nodes { double u[NODES*NODES], v[NODES*NODES]; };

//! False if the polynomial through the nodes is not the map of this tile.
bool findNodes(const PinholeView& view, Point tile, Nodes& nodes)
{
    static const CheckWeights check(-1, PixelWeights::HALF);
    enum { GRID = NODES*NODES, CHECKS = 9, ALL = GRID + CHECKS };
    static_assert(GRID <= BLOCK, "one block");
    double column[ALL], row[ALL], u[ALL], v[ALL];
    uchar status[ALL];
    for (int i = 0; i < ALL; i++)
    {
        const int c = i - GRID;
        column[i] = tile.x + (c < 0 ? check.node[i % NODES] : check.place[c % 3]);
        row[i] = tile.y + (c < 0 ? check.node[i/NODES] : check.place[c/3]);
    }
    view.toRaw(GRID, column, row, NULL, u, v, status);
    view.toRaw(CHECKS, column + GRID, row + GRID, NULL, u + GRID, v + GRID, status + GRID);
    bool good = std::count(status, status + ALL, (uchar)REFRACT_OK) == ALL;
    for (int r = 0; r < 3; r++)
    {
        double a[3], b[3];
        pointKernels().interpolate(u, check.byPlace[r], check.byNode[0], 3, a);
        pointKernels().interpolate(v, check.byPlace[r], check.byNode[0], 3, b);
        for (int c = 0; c < 3; c++)
            good = good && std::hypot(a[c] - u[GRID + 3*r + c], b[c] - v[GRID + 3*r + c]) < TOLERANCE;
    }
    std::copy(u, u + GRID, nodes.u);
    std::copy(v, v + GRID, nodes.v);
    return good;
}

//! The type that m1type means, whether counted as by OpenCV 4 or 5: a Python program's cv2 need not be the OpenCV inside.
int typeOfMap(int m1type)
{
    if (m1type <= 0)
        return CV_16SC2;
    for (int known : { CV_16SC2, CV_32FC1, CV_32FC2 })
        for (int channelShift : { 3, 5 })
            if (m1type == CV_MAT_DEPTH(known) + ((CV_MAT_CN(known) - 1) << channelShift))
                return known;
    CV_Error_(Error::StsUnsupportedFormat, ("m1type is %s; it must be CV_16SC2, CV_32FC1 or CV_32FC2",
                                            typeToString(m1type).c_str()));
}

/** The maps to fill, of the types that m1type means.

16 bits hold pixels up to 32767. What is farther is outside of most images, and saturated it still is: cv::remap does not tell the
difference. Of a larger image it would be another pixel, so that there it is refused. */
class Maps
{
public:
    Maps(const Camera& camera, Size size, int m1type, OutputArray first_, OutputArray second_)
    {
        m1type = typeOfMap(m1type);
        if (size.width < 0 || size.height < 0)
            CV_Error_(Error::StsBadSize, ("size is %dx%d; it must not be negative", size.width, size.height));
        first_.create(size, m1type);
        first = first_.getMat();
        if (m1type == CV_32FC2)
            second_.release();
        else
        {
            second_.create(size, m1type == CV_32FC1 ? CV_32FC1 : CV_16UC1);
            second = second_.getMat();
        }
        const std::vector<double> lens = camera.lens().parameters();
        const Size known = camera.imageSize();      // else its middle is at the principal point
        const double width = known.empty() ? 2*lens[2] : known.width, height = known.empty() ? 2*lens[3] : known.height;
        isLarge = std::max(width, height) > SHRT_MAX;
    }

    //! Stores one run of a row in the formats of cv::initUndistortRectifyMap.
    void store(int row, int column, int n, const double* u, const double* v)
    {
        const int BITS = 5, SIZE = 1 << BITS;   // INTER_BITS, INTER_TAB_SIZE of imgproc
        if (first.type() == CV_32FC2)
            arrayKernels().store(first.ptr<Vec2f>(row) + column, true, n, u, v, NULL);
        else if (first.type() == CV_32FC1)
        {
            std::transform(u, u + n, first.ptr<float>(row) + column, [](double a) { return (float)a; });
            std::transform(v, v + n, second.ptr<float>(row) + column, [](double a) { return (float)a; });
        }
        else
        {
            Vec2s* whole = first.ptr<Vec2s>(row) + column;
            ushort* part = second.ptr<ushort>(row) + column;
            for (int i = 0; i < n; i++)
            {
                const int a = saturate_cast<int>(u[i]*SIZE), b = saturate_cast<int>(v[i]*SIZE);
                whole[i] = Vec2s(saturate_cast<short>(a >> BITS), saturate_cast<short>(b >> BITS));
                part[i] = (ushort)((b & (SIZE - 1))*SIZE + (a & (SIZE - 1)));
                if (isLarge && std::max(a, b) >> BITS > SHRT_MAX)
                    addTooFar(Point(column + i, row), Point2d(u[i], v[i]));
            }
        }
    }

    //! Throws with the first pixel that did not fit.
    void check() const
    {
        if (hasTooFar)
            CV_Error_(Error::StsOutOfRange, ("m1type is CV_16SC2, which holds raw pixels up to %d; that of the new pixel (%d, %d) is (%g, "
                                             "%g). Use CV_32FC1 or CV_32FC2", SHRT_MAX, tooFar.x, tooFar.y, tooFarRaw.x, tooFarRaw.y));
    }

private:
    void addTooFar(const Point& pixel, const Point2d& raw)
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (hasTooFar && (tooFar.y < pixel.y || (tooFar.y == pixel.y && tooFar.x < pixel.x)))
            return;
        hasTooFar = true;
        tooFar = pixel;
        tooFarRaw = raw;
    }

    Mat first, second;
    bool isLarge, hasTooFar = false;
    Point tooFar;
    Point2d tooFarRaw;
    std::mutex mutex;
};

//! One run of a row, every pixel by itself; (-1, -1) where there is no answer. planeD: of each pixel, or null.
void solveRow(const PinholeView& view, int row, int column, int n, const double* planeD, double* u, double* v)
{
    double columns[TILE] = {}, rows[TILE] = {};    // g++ 12 at -O2 does not see that all n are set
    uchar status[TILE];
    for (int i = 0; i < n; i++)
    {
        columns[i] = column + i;
        rows[i] = row;
    }
    view.toRaw(n, columns, rows, planeD, u, v, status);
    for (int i = 0; i < n; i++)
        if (status[i] != REFRACT_OK)
            u[i] = v[i] = -1;
}

/* Where each pixel has a depth of its own, the map is a polynomial of second order in the inverse of the distance from the
pinhole, whose coefficients are those of a tile (SurfaceTile). It must be good enough where its error is largest in the inverse
distance, too. */
const double SURFACE_TOLERANCE = 1e-5;

//! Between the nearest and the farthest of a tile; false: not all are before the pinhole.
bool findRange(const std::vector<double>& planeD, SurfaceTile& tile)
{
    double least = planeD[0], most = planeD[0];
    bool before = true;     // false for NaN, too
    for (double d : planeD)
    {
        least = d < least ? d : least;
        most = d > most ? d : most;
        before &= d > tile.atCentre;
    }
    const double near = 1/(least - tile.atCentre), far = 1/(most - tile.atCentre);
    tile.middle = 0.5*(near + far);
    tile.scale = 1/std::max(0.5*(near - far), 1e-6*tile.middle);
    return before && std::isfinite(tile.middle);
}

//! Raw pixels of a square of places, all on one plane; false where there is no answer.
bool solveSquare(const PinholeView& view, Point corner, const double* place, int side, double planeD, double* u, double* v)
{
    double column[BLOCK], row[BLOCK], d[BLOCK];
    uchar status[BLOCK];
    const int n = side*side;
    CV_Assert(n <= BLOCK);
    for (int i = 0; i < n; i++)
    {
        column[i] = corner.x + place[i % side];
        row[i] = corner.y + place[i/side];
        d[i] = planeD;
    }
    view.toRaw(n, column, row, d, u, v, status);
    return std::count(status, status + n, (uchar)REFRACT_OK) == n;
}

//! False if the polynomial, whose range is known, is not the map of this tile.
bool findSurface(const PinholeView& view, Point corner, SurfaceTile& tile)
{
    static const CheckWeights check(-1, PixelWeights::HALF);
    const auto planeDAt = [&](double s) { return tile.atCentre + 1/(tile.middle + s/tile.scale); };
    Nodes at[3];        // s = -1, 0, 1
    for (int k = 0; k < 3; k++)
        if (!solveSquare(view, corner, check.node, NODES, planeDAt(k - 1), at[k].u, at[k].v))
            return false;
    for (int i = 0; i < NODES*NODES; i++)
    {
        tile.u[0][i] = at[1].u[i];
        tile.v[0][i] = at[1].v[i];
        tile.u[1][i] = 0.5*(at[2].u[i] - at[0].u[i]);
        tile.v[1][i] = 0.5*(at[2].v[i] - at[0].v[i]);
        tile.u[2][i] = 0.5*(at[2].u[i] + at[0].u[i]) - at[1].u[i];
        tile.v[2][i] = 0.5*(at[2].v[i] + at[0].v[i]) - at[1].v[i];
    }
    for (double s : { -0.577, 0.577 })      // where a term of third order would be largest
    {
        double u[9], v[9];
        if (!solveSquare(view, corner, check.place, 3, planeDAt(s), u, v))
            return false;
        const double d = planeDAt(s), planeD[] = { d, d, d };
        for (int r = 0; r < 3; r++)
        {
            double a[3], b[3];
            pointKernels().interpolateSurface(tile, check.byPlace[r], check.byNode[0], planeD, 3, a, b);
            for (int c = 0; c < 3; c++)
                if (!(std::hypot(a[c] - u[3*r + c], b[c] - v[3*r + c]) < SURFACE_TOLERANCE))
                    return false;
        }
    }
    return true;
}

//! A tile, or what of it is in the new image.
void mapTile(const PinholeView& view, const Rect& tile, Maps& maps)
{
    static const PixelWeights pixels(0, 1);
    Nodes nodes;
    const bool smooth = findNodes(view, tile.tl(), nodes);
    for (int r = 0; r < tile.height; r++)
    {
        double u[TILE], v[TILE];
        if (smooth)
        {
            pointKernels().interpolate(nodes.u, pixels.byPlace[r], pixels.byNode[0], TILE, u);
            pointKernels().interpolate(nodes.v, pixels.byPlace[r], pixels.byNode[0], TILE, v);
        }
        else
            solveRow(view, tile.y + r, tile.x, tile.width, NULL, u, v);
        maps.store(tile.y + r, tile.x, tile.width, u, v);
    }
}

//! A tile whose pixels have planes of their own.
void mapSurfaceTile(const PinholeView& view, const PlaneReader& read, const Rect& tile, Maps& maps)
{
    static const PixelWeights pixels(0, 1);
    std::vector<double> planeD(TILE*tile.height);
    for (int r = 0; r < tile.height; r++)
    {
        double* row = &planeD[TILE*r];
        read(tile.y + r, tile.x, tile.width, row);
        std::fill(row + tile.width, row + TILE, row[tile.width - 1]);       // what is beyond the image
    }
    SurfaceTile surface;
    surface.atCentre = Vec3d(view.plane.val).dot(view.centre);
    const bool smooth = findRange(planeD, surface) && findSurface(view, tile.tl(), surface);
    for (int r = 0; r < tile.height; r++)
    {
        double u[TILE], v[TILE];
        const double* row = &planeD[TILE*r];
        if (smooth)
            pointKernels().interpolateSurface(surface, pixels.byPlace[r], pixels.byNode[0], row, TILE, u, v);
        else
            solveRow(view, tile.y + r, tile.x, tile.width, row, u, v);
        maps.store(tile.y + r, tile.x, tile.width, u, v);
    }
}

template<typename Body>
void forEachTile(Size size, const Body& body)
{
    parallel_for_(Range(0, (size.height + TILE - 1)/TILE), [&](const Range& range)
    {
        for (int t = range.start; t < range.end; t++)
            for (int column = 0; column < size.width; column += TILE)
                body(Rect(column, t*TILE, TILE, TILE) & Rect(Point(), size));
    });
}

} // namespace

void PinholeView::toRaw(int n, const double* column, const double* row, const double* planeD, double* u, double* v,
                        uchar* status) const
{
    double x[BLOCK], y[BLOCK], z[BLOCK], w[BLOCK];
    const double none[] = { 0, 0, 0 }, a = plane[0], b = plane[1], c = plane[2];
    const double cx = centre[0], cy = centre[1], cz = centre[2], atCentre = a*cx + b*cy + c*cz;
    std::copy(column, column + n, x);
    std::copy(row, row + n, y);
    std::fill(z, z + n, 1.);
    pointKernels().transform(newToCamera.val, none, n, x, y, z);
    for (int i = 0; i < n; i++)
        w[i] = (a*x[i] + b*y[i] + c*z[i])/((planeD ? planeD[i] : plane[3]) - atCentre);
    for (int i = 0; i < n; i++)
    {
        x[i] += w[i]*cx;
        y[i] += w[i]*cy;
        z[i] += w[i]*cz;
    }
    for (int i = 0; i < n; i++)
        status[i] = w[i] >= 0 && std::isfinite(w[i]) ? REFRACT_OK : REFRACT_NO_INTERSECTION;
    camera.project(n, x, y, z, w, u, v, status);
}

void mapPlane(const PinholeView& view, Size size, int m1type, OutputArray map1, OutputArray map2)
{
    Maps maps(view.camera, size, m1type, map1, map2);
    forEachTile(size, [&](const Rect& tile) { mapTile(view, tile, maps); });
    maps.check();
}

void mapSurface(const PinholeView& view, const PlaneReader& planeD, Size size, int m1type, OutputArray map1, OutputArray map2)
{
    Maps maps(view.camera, size, m1type, map1, map2);
    forEachTile(size, [&](const Rect& tile) { mapSurfaceTile(view, planeD, tile, maps); });
    maps.check();
}

}} // namespace
