// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/disparity.hpp"
#include "math/quantile.hpp"
#include "stereo/rectified_projection.hpp"
#include "opencv2/imgproc.hpp"

/* From a first, coarse disparity with gaps to the depth of every pixel of both rectified images, for maps that leave next to no
error of rows. What counts is that it is smooth, as maps that jump tear the images, and right to some percent.

All of it is done with the inverse of the distance from the pinholes, in which disparity is linear, in cells of some pixels. */

namespace cv { namespace refract {

namespace {

const int CELL = 4;     // pixels of the disparity

//! What P1 and P2 say of a pair: disparity = focal base/z + shift, z from the pinholes.
struct Geometry
{
    Geometry(InputArray P1, InputArray P2)
    {
        const RectifiedProjection first(P1, "P1"), second(P2, "P2");
        axis = axisOf(first, second);
        focal = first.K(0, 0);
        base = (second.centre - first.centre)[axis];
        shift = first.K(axis, 2) - second.K(axis, 2);
        centreZ = first.centre[2];
    }
    double focal, base, shift, centreZ;
    int axis;
};

//! The median of each cell that a quarter of its pixels have a value of; else 0.
Mat cellMedians(const Mat& inverse)
{
    Mat cells((inverse.rows + CELL - 1)/CELL, (inverse.cols + CELL - 1)/CELL, CV_32F);
    parallel_for_(Range(0, cells.rows), [&](const Range& range)
    {
        std::vector<float> values;
        for (int y = range.start; y < range.end; y++)
            for (int x = 0; x < cells.cols; x++)
            {
                const Mat cell = inverse(Rect(x*CELL, y*CELL, CELL, CELL) & Rect(Point(), inverse.size()));
                values.clear();
                for (int r = 0; r < cell.rows; r++)
                    std::copy_if(cell.ptr<float>(r), cell.ptr<float>(r) + cell.cols, std::back_inserter(values),
                                 [](float v) { return v > 0; });
                const bool enough = values.size()*4 >= cell.total();
                cells.at<float>(y, x) = enough ? (float)quantile(values, 0.5) : 0;
            }
    });
    return cells;
}

/* What is unknown (weight 0, else 1) gets what its surroundings, as large as it takes, are in the mean. Something is known. */
void fillUnknown(Mat& values, const Mat& weight)
{
    const Mat unknown = weight == 0;
    if (countNonZero(unknown) == 0)
        return;
    const Size half((values.cols + 1)/2, (values.rows + 1)/2);
    Mat coarse, share, wide;
    resize(values.mul(weight), coarse, half, 0, 0, INTER_AREA);
    resize(weight, share, half, 0, 0, INTER_AREA);
    const Mat isKnown = share > 0;
    coarse /= share;
    coarse.setTo(0, ~isKnown);
    isKnown.convertTo(share, CV_32F, 1./255);
    fillUnknown(coarse, share);
    resize(coarse, wide, values.size(), 0, 0, INTER_LINEAR);
    wide.copyTo(values, unknown);
}

//! What is not positive is unknown. Where all is, as in an image of darkness, all becomes NaN.
void fill(Mat& cells)
{
    const Mat isKnown = cells > 0;
    if (countNonZero(isKnown) == 0)
    {
        cells.setTo(std::numeric_limits<float>::quiet_NaN());
        return;
    }
    Mat weight;
    isKnown.convertTo(weight, CV_32F, 1./255);
    cells.setTo(0, ~isKnown);
    fillUnknown(cells, weight);
}

void smooth(Mat& cells)
{
    Mat median;
    medianBlur(cells, median, 5);
    GaussianBlur(median, cells, Size(), 1, 1, BORDER_REPLICATE);
}

//! The same surface as the other image sees it; disparity, in cells, is perUnit times the inverse distance + shift.
Mat inOtherImage(const Mat& cells, double perUnit, double shift, int axis)
{
    Mat other = Mat::zeros(cells.size(), CV_32F);
    for (int y = 0; y < cells.rows; y++)
        for (int x = 0; x < cells.cols; x++)
        {
            const float value = cells.at<float>(y, x);
            const double place = (axis == 0 ? x : y) - (perUnit*value + shift);
            if (!(std::abs(place) < 2*std::max(cells.cols, cells.rows)))
                continue;
            for (int k = cvFloor(place); k <= cvFloor(place) + 1; k++)
            {
                const Point p = axis == 0 ? Point(k, y) : Point(x, k);
                if (Rect(Point(), cells.size()).contains(p))
                    other.at<float>(p) = std::max(other.at<float>(p), value);     // the nearer one hides the other
            }
        }
    return other;
}

//! Of every pixel, from cells that are CELL/scale pixels wide.
void writeDepth(const Mat& cells, double scale, double centreZ, Size size, OutputArray depth)
{
    if (!depth.needed())
        return;
    Mat more, inverse, result;      // one cell more than the image may need, whatever was rounded
    copyMakeBorder(cells, more, 0, 1, 0, 1, BORDER_REPLICATE);
    resize(more, inverse, Size(), CELL/scale, CELL/scale, INTER_LINEAR);
    divide(1., inverse(Rect(Point(), size)), result);
    result += centreZ;
    result.copyTo(depth);
}

} // namespace

void refractiveRectifiedDepth(InputArray disparity_, InputArray P1, InputArray P2, Size size, OutputArray depth1,
                              OutputArray depth2, bool handleMissingValues)
{
    CV_INSTRUMENT_REGION();

    const Disparity disparity(disparity_, handleMissingValues);
    const Size coarse = disparity.size();
    const Geometry geometry(P1, P2);
    if (coarse.empty())
    {
        depth1.release();
        depth2.release();
        return;
    }
    if (size.width < coarse.width || size.height < coarse.height)
        CV_Error_(Error::StsBadSize, ("disparity is %dx%d; it must not be larger than size %dx%d", coarse.width,
                                      coarse.height, size.width, size.height));
    const double scale = (double)coarse.width/size.width;
    if (std::abs(scale*size.height - coarse.height) >= 1)
        CV_Error_(Error::StsBadSize, ("disparity is %dx%d; it must have the proportions of size %dx%d", coarse.width, coarse.height,
                                      size.width, size.height));
    // disparity = perUnit inverse distance + shift, in pixels of the coarse image
    const double perUnit = geometry.focal*geometry.base*scale, shift = geometry.shift*scale;
    Mat cells = cellMedians((disparity.image() - shift)/perUnit);
    fill(cells);
    smooth(cells);
    Mat other = inOtherImage(cells, perUnit/CELL, shift/CELL, geometry.axis);
    fill(other);
    smooth(other);
    writeDepth(cells, scale, geometry.centreZ, size, depth1);
    writeDepth(other, scale, geometry.centreZ, size, depth2);
}

}} // namespace
