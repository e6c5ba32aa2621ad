// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/ridges.hpp"
#include "console/numbers.hpp"
#include "math/quantile.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

//! In grey values of 8 bits.
Mat scaled(const Mat& image)
{
    Mat result;
    image.convertTo(result, CV_32F, image.depth() == CV_16U ? 1./256. : 1.);
    return result;
}

Mat excessOf(const Mat& bgr, LaserColour colour)
{
    std::vector<Mat> channels;
    split(bgr, channels);
    const Mat own = channels[colour];
    channels.erase(channels.begin() + colour);
    return own - max(channels[0], channels[1]);
}

Mat brightnessOf(const Mat& image)
{
    if (image.channels() == 1)
        return image;
    Mat grey;
    cvtColor(image, grey, COLOR_BGR2GRAY);
    return grey;
}

const double SIGNIFICANT = 5.;          // standard deviations of the second derivative
const double BOTH_SIDES = 0.3;          // of the larger fall beside the line
const int NEWTON_STEPS = 2;
const double WITHIN = 0.5;              // of a pixel: there the point belongs to it
const double SCALES[] = {0.8, 1.1, 1.5, 2., 2.8, 4., 5.6};

struct Kernels
{
    Mat smooth, first, second;

    explicit Kernels(double s)
    {
        const int radius = (int)std::ceil(4*s);
        for (Mat* kernel : {&smooth, &first, &second})
            kernel->create(2*radius + 1, 1, CV_64F);
        double sum = 0.;
        for (int i = -radius; i <= radius; i++)
            sum += std::exp(-0.5*i*i/(s*s));
        for (int i = -radius; i <= radius; i++)
        {
            const double g = std::exp(-0.5*i*i/(s*s))/sum;
            smooth.at<double>(i + radius) = g;
            first.at<double>(i + radius) = i/(s*s)*g;           // as OpenCV's filters correlate
            second.at<double>(i + radius) = (i*i/(s*s) - 1.)/(s*s)*g;
        }
        second -= cv::sum(second)[0]*smooth;        // a constant has no second derivative, in samples too
    }
};

//! The first and second derivatives of the smoothed image.
struct Derivatives
{
    Mat x, y, xx, xy, yy;

    Derivatives(const Mat& signal, double scale)
    {
        const Kernels k(scale);
        const auto filter = [&](const Mat& alongX, const Mat& alongY, Mat& result) {
            sepFilter2D(signal, result, CV_32F, alongX, alongY, Point(-1, -1), 0., BORDER_REPLICATE);
        };
        filter(k.first, k.smooth, x);
        filter(k.smooth, k.first, y);
        filter(k.second, k.smooth, xx);
        filter(k.first, k.first, xy);
        filter(k.smooth, k.second, yy);
    }

    //! The most negative second derivative, and its direction.
    double across(int row, int column, Vec2d& direction) const
    {
        const double a = xx.at<float>(row, column), b = xy.at<float>(row, column), c = yy.at<float>(row, column);
        const double half = 0.5*(a - c), root = std::hypot(half, b), least = 0.5*(a + c) - root;
        // (A - least I) n = 0, by the row that is longer
        const Vec2d n = half >= 0. ? Vec2d(-b, half + root) : Vec2d(root - half, -b);
        direction = norm(n) > 0. ? n/norm(n) : Vec2d(1., 0.);
        return least;
    }
};

//! The first derivative along a direction, at any place: an interpolated one is off by hundredths of a pixel where lines are narrow.
double derivativeAlong(const Mat& signal, double scale, const Vec2d& direction, const Point2d& at)
{
    const int radius = (int)std::ceil(4*scale), left = cvRound(at.x) - radius, top = cvRound(at.y) - radius, count = 2*radius + 1;
    std::vector<double> gx(count), gy(count);
    for (int i = 0; i < count; i++)
    {
        gx[i] = std::exp(-0.5*std::pow((left + i - at.x)/scale, 2));
        gy[i] = std::exp(-0.5*std::pow((top + i - at.y)/scale, 2));
    }
    double sum = 0., weights = 0.;
    for (int i = 0; i < count; i++)
    {
        const float* row = signal.ptr<float>(std::clamp(top + i, 0, signal.rows - 1));
        for (int k = 0; k < count; k++)
        {
            const double g = gy[i]*gx[k], along = direction[0]*(left + k - at.x) + direction[1]*(top + i - at.y);
            weights += g;
            sum += along*g*row[std::clamp(left + k, 0, signal.cols - 1)];
        }
    }
    return sum/(weights*scale*scale);
}

//! The signal falls on both sides, and by about as much: at a step it falls on one.
bool fallsOnBothSides(const Mat& smooth, const Point2d& pixel, const Vec2d& across, double scale)
{
    const auto at = [&](double t) {
        const Point p(cvRound(pixel.x + t*across[0]), cvRound(pixel.y + t*across[1]));
        return smooth.at<float>(std::clamp(p.y, 0, smooth.rows - 1), std::clamp(p.x, 0, smooth.cols - 1));
    };
    const double far = std::max(2., 2.5*scale), peak = at(0.), one = peak - at(-far), other = peak - at(far);
    return std::min(one, other) > BOTH_SIDES*std::max(one, other);
}

} // namespace

std::vector<std::string> laserColourNames() { return {"blue", "green", "red", "any"}; }

LaserColour laserColourOf(const std::string& name)
{
    const std::vector<std::string> names = laserColourNames();
    return (LaserColour)(std::find(names.begin(), names.end(), name) - names.begin());
}

Mat laserSignal(const Mat& image, LaserColour colour, const Mat& without)
{
    const auto signalOf = [&](const Mat& from) {
        return colour == LASER_ANY || from.channels() == 1 ? brightnessOf(scaled(from)) : excessOf(scaled(from), colour);
    };
    return without.empty() ? signalOf(image) : Mat(signalOf(image) - signalOf(without));
}

int borderOf(double scale) { return (int)std::ceil(3*scale); }

std::vector<RidgePoint> findRidges(const Mat& signal, double scale, double noise)
{
    const Derivatives d(signal, scale);
    const double ofFirst = noise/(std::sqrt(8*CV_PI)*scale*scale), ofSecond = noise*std::sqrt(3/(16*CV_PI))/(scale*scale*scale);
    const int border = borderOf(scale);
    Mat smooth;
    GaussianBlur(signal, smooth, Size(), 0.7*scale);
    std::vector<RidgePoint> points;
    for (int row = border; row < signal.rows - border; row++)
        for (int column = border; column < signal.cols - border; column++)
        {
            Vec2d n;
            const double least = d.across(row, column, n);
            if (!(-least > SIGNIFICANT*ofSecond))
                continue;
            // Where the first derivative is zero, by Newton: half a pixel away it is no longer linear.
            const Point2d middle(column, row);
            double t = -(d.x.at<float>(row, column)*n[0] + d.y.at<float>(row, column)*n[1])/least;
            for (int step = 0; step < NEWTON_STEPS && std::abs(t) < 1.; step++)
                t -= derivativeAlong(signal, scale, n, middle + t*Point2d(n))/least;
            const Point2d pixel = middle + t*Point2d(n);
            if (std::abs(t*n[0]) <= WITHIN && std::abs(t*n[1]) <= WITHIN && fallsOnBothSides(smooth, pixel, n, scale))
                points.push_back({pixel, n, -least, ofFirst/-least});
        }
    return points;
}

double noiseOf(const Mat& signal)
{
    const Matx33d difference(1, -2, 1, -2, 4, -2, 1, -2, 1);        // a noise of 1 becomes 6
    Mat filtered;
    filter2D(signal, filtered, CV_32F, difference);
    std::vector<float> values;
    for (int row = 1; row < filtered.rows - 1; row++)
        for (int column = 1; column < filtered.cols - 1; column++)
            values.push_back(std::abs(filtered.at<float>(row, column)));
    if (values.empty())
        return 0.;
    const double QUANTISED = 1/std::sqrt(12.);      // a grey value is rounded
    return std::max(QUANTISED, cv::refract::quantile(std::move(values), 0.5)/(0.6745*6));
}

/* The response of a Gaussian line of standard deviation s is s / (s^2 + scale^2)^(3/2), which times scale^(3/2) is largest at scale = s
(T. Lindeberg, Edge detection and ridge detection with automatic scale selection, IJCV 30, 1998). */
double scaleOfLine(const Mat& signal, const std::vector<Point2d>& pixels)
{
    if (pixels.empty())
        return 0.;
    std::vector<double> best(pixels.size(), 0.), scaleAt(pixels.size(), SCALES[0]);
    for (double scale : SCALES)
    {
        const Derivatives d(signal, scale);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            const Point at(cvRound(pixels[i].x), cvRound(pixels[i].y));
            Vec2d n;
            const double response = -d.across(at.y, at.x, n)*std::pow(scale, 1.5);
            if (response > best[i])
            {
                best[i] = response;
                scaleAt[i] = scale;
            }
        }
    }
    return median(scaleAt);
}

double excessNoise(const std::vector<double>& residuals, const std::vector<double>& variances)
{
    const double MEDIAN = 0.6745, LARGEST = 5.;
    const auto isEnough = [&](double excess) {
        std::vector<double> ratios;
        for (size_t i = 0; i < residuals.size(); i++)
            ratios.push_back(std::abs(residuals[i])/std::sqrt(variances[i] + excess*excess));
        return median(ratios) <= MEDIAN;
    };
    if (residuals.empty() || isEnough(0.))
        return 0.;
    double low = 0., high = LARGEST;
    for (int i = 0; i < 30; i++)
    {
        const double middle = 0.5*(low + high);
        (isEnough(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace tools
