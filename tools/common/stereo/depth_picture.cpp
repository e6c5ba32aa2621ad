// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/depth_picture.hpp"
#include "console/file_output.hpp"
#include "console/table.hpp"
#include "math/quantile.hpp"
#include "report/drawing.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Point;
using cv::Rect;
using cv::Scalar;

namespace {

cv::Mat inColour(const cv::Mat& image)
{
    cv::Mat colour = image;
    if (image.channels() == 1)
        cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
    return colour;
}

const Scalar UNKNOWN = Scalar::all(0), GROUND = Scalar::all(28), INK = Scalar::all(230);

struct Range
{
    double near, far;

    //! Brightness that becomes a colour: 255 near, 0 far.
    double levelOf(double depth) const { return 255.*(far - depth)/(far - near); }
};

Range rangeOf(const cv::Mat& depth)
{
    const double rare = 0.01, flat = 0.005;     // a plane seen square keeps its noise from filling the scale
    const std::vector<float> sorted = sortedDepths(depth);
    if (sorted.empty())
        return {0, 1};
    const double near = cv::refract::quantile(sorted, rare), far = cv::refract::quantile(sorted, 1 - rare);
    const double middle = (near + far)/2, half = std::max((far - near)/2, flat*std::abs(middle) + 1e-30);
    return {middle - half, middle + half};
}

cv::Mat coloured(const cv::Mat& level)
{
    cv::Mat level8, colours;
    level.convertTo(level8, CV_8U);     // saturates
    cv::applyColorMap(level8, colours, cv::COLORMAP_VIRIDIS);
    return colours;
}

//! How large letters and lines are, so that they can be read in a picture of that height shown whole.
double scaleFor(int rows) { return std::max(0.4, rows/1000.); }

int decimalsOf(const std::vector<double>& ticks)
{
    return ticks.size() < 2 ? 0 : std::clamp(-(int)std::floor(std::log10(ticks[1] - ticks[0]) + 1e-9), 0, 9);
}

class ScaleBar
{
public:
    ScaleBar(const Range& range, const std::string& unit, int rows)
        : range_(range), title_(unit.empty() ? "depth z" : "depth z, " + unit), rows_(rows), scale_(scaleFor(rows)),
          letters_(cvRound(22*scale_)), thick_(std::max(1, cvRound(1.4*scale_)))
    {
        const int margin = 2*letters_;
        bar_ = Rect(letters_, margin + letters_, cvRound(1.2*letters_), 0);
        bar_.height = std::max(1, rows - bar_.y - margin);
        ticks_ = ticksOf(range.near, range.far, std::max(2, bar_.height/(4*letters_)));
    }

    cv::Mat draw() const
    {
        int widest = widthOf(title_) - (textLeft() - letters_);
        for (const double tick : ticks_)
            widest = std::max(widest, widthOf(textOf(tick)));
        cv::Mat strip(rows_, textLeft() + widest + letters_, CV_8UC3, GROUND);
        cv::Mat levels(bar_.size(), CV_32F);
        for (int y = 0; y < levels.rows; y++)       // far above, near below, as a floor runs
            levels.row(y).setTo(255.*(y + 0.5)/levels.rows);
        coloured(levels).copyTo(strip(bar_ & Rect(Point(), strip.size())));
        for (const double tick : ticks_)
        {
            const int y = bar_.y + cvRound(range_.levelOf(tick)/255.*(bar_.height - 1));
            cv::line(strip, Point(bar_.br().x, y), Point(bar_.br().x + letters_/2, y), INK, thick_);
            write(strip, textOf(tick), Point(textLeft(), y + letters_/2 - thick_));
        }
        write(strip, title_, Point(letters_, bar_.y - letters_));
        return strip;
    }

private:
    int textLeft() const { return bar_.br().x + letters_; }
    std::string textOf(double tick) const
    {
        return format("%.*f", decimalsOf(ticks_), tick);
    }
    int widthOf(const std::string& text) const
    {
        int baseline;
        return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale_, thick_, &baseline).width;
    }
    void write(cv::Mat& picture, const std::string& text, const Point& corner) const
    {
        cv::putText(picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, scale_, INK, thick_, cv::LINE_AA);
    }

    Range range_;
    std::string title_;
    int rows_;
    double scale_;
    int letters_, thick_;       // height of a letter, width of a line
    Rect bar_;
    std::vector<double> ticks_;
};

} // namespace

cv::Mat sideBySide(const cv::Mat& rectified1, const cv::Mat& rectified2, bool vertical)
{
    const int LINES = 16, GAP = 8;
    const cv::Mat first = inColour(rectified1), second = inColour(rectified2);
    cv::Mat picture;
    if (vertical)
    {
        const cv::Mat gap(GAP, first.cols, CV_8UC3, cv::Scalar::all(255));
        cv::vconcat(std::vector<cv::Mat>{first, gap, second}, picture);
    }
    else
    {
        const cv::Mat gap(first.rows, GAP, CV_8UC3, cv::Scalar::all(255));
        cv::hconcat(std::vector<cv::Mat>{first, gap, second}, picture);
    }
    const int across = vertical ? picture.cols : picture.rows, along = vertical ? picture.rows : picture.cols;
    for (int i = 0; i < LINES; i++)
    {
        const double at = (i + 0.5)*across/LINES;
        const cv::Point2d from = vertical ? cv::Point2d(at, 0) : cv::Point2d(0, at);
        const cv::Point2d to = vertical ? cv::Point2d(at, along - 1) : cv::Point2d(along - 1, at);
        drawCurve(picture, {from, to}, colourOf(i, LINES));
    }
    return picture;
}

std::vector<std::string> rectifiedFiles(const std::string& prefix)
{
    return {prefix + "left.png", prefix + "right.png", prefix + "pair.png", prefix + "disparity.tiff"};
}

void writeRectified(const std::string& prefix, const cv::Mat& rectified1, const cv::Mat& rectified2, const cv::Mat& disparity,
                    bool vertical)
{
    const std::vector<std::string> files = rectifiedFiles(prefix);
    writeImage(files[0], rectified1);
    writeImage(files[1], rectified2);
    writeImage(files[2], sideBySide(rectified1, rectified2, vertical));
    writeImage(files[3], disparity);
}

std::vector<float> sortedDepths(const cv::Mat& depth)
{
    std::vector<float> sorted;
    for (const float z : cv::Mat_<float>(depth))
        if (std::isfinite(z))
            sorted.push_back(z);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

std::vector<double> ticksOf(double from, double to, int about)
{
    const double ideal = (to - from)/about, power = std::pow(10., std::floor(std::log10(ideal)));
    double step = 10*power;
    for (const double digit : {5., 2., 1.})
        if (digit*power >= ideal*(1 - 1e-9))
            step = digit*power;
    std::vector<double> ticks;
    for (double k = std::ceil(from/step - 1e-9); k*step <= to + 1e-9*step; k++)
        ticks.push_back(k*step);
    return ticks;
}

cv::Mat depthPicture(const cv::Mat& depth, const std::string& unit)
{
    const Range range = rangeOf(depth);
    const double slope = -255./(range.far - range.near);
    cv::Mat level, picture;
    depth.convertTo(level, CV_32F, slope, -slope*range.far);
    const cv::Mat unknown = ~(depth == depth);      // != is not the opposite of == for NaN
    level.setTo(0, unknown);
    picture = coloured(level);
    picture.setTo(UNKNOWN, unknown);
    cv::hconcat(picture, ScaleBar(range, unit, depth.rows).draw(), picture);
    return picture;
}

} // namespace tools
