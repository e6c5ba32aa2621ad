// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "arguments.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>

namespace fuzz {

using cv::Mat;
using namespace cv::refract;

namespace {

Mat withType(Bytes& bytes, const Mat& doubles)
{
    Mat result;
    if (bytes.rarely())
    {
        static const int others[] = {CV_8U, CV_8S, CV_16U, CV_16S, CV_32S, CV_16F};
        Mat clean = doubles.clone();
        for (double& number : cv::Mat_<double>(clean.reshape(1)))     // what an integer cannot hold is no argument
            number = std::isnan(number) ? 0. : std::min(std::max(number, -1e5), 1e5);
        clean.convertTo(result, others[bytes.below(6)]);
        return result;
    }
    doubles.convertTo(result, bytes.maybe() ? CV_32F : CV_64F);
    return result;
}

//! The same numbers in memory that is not continuous.
Mat spread(const Mat& m, Mat& whole)
{
    whole = Mat(m.rows + 2, m.cols + 3, m.type(), cv::Scalar::all(77));
    Mat part = whole(cv::Rect(1, 1, m.cols, m.rows));
    m.copyTo(part);
    return part;
}

template<typename Point>
void fill(std::vector<Point>& points, const Mat& m)
{
    points.resize(m.rows);
    for (int i = 0; i < m.rows; i++)
        points[i] = m.at<Point>(i);
}

} // namespace

void Input::layOut(Bytes& bytes, const Mat& plain)
{
    Memory& m = *memory_;
    m.mat = plain;
    switch (bytes.rarely() ? bytes.below(8) : bytes.below(3))
    {
    default: break;
    case 1: if (plain.dims == 2 && !plain.empty()) m.mat = spread(plain, m.whole); break;
    case 2:
        if (plain.dims == 2 && plain.cols == 1)
            switch (plain.type())
            {
            case CV_32FC2: fill(m.points2f, plain); array_ = cv::_InputArray(m.points2f); return;
            case CV_64FC2: fill(m.points2d, plain); array_ = cv::_InputArray(m.points2d); return;
            case CV_32FC3: fill(m.points3f, plain); array_ = cv::_InputArray(m.points3f); return;
            case CV_64FC3: fill(m.points3d, plain); array_ = cv::_InputArray(m.points3d); return;
            }
        break;
    case 3: plain.copyTo(m.umat); array_ = cv::_InputArray(m.umat); return;
    case 4: m.mat = Mat(); array_ = cv::_InputArray(); return;
    case 5: m.mats.assign(2, plain); array_ = cv::_InputArray(m.mats); return;
    case 6: if (plain.total() > 1 && plain.total() % 2 == 0 && plain.isContinuous())
            {
                const int sizes[] = {2, (int)plain.total()/2, 1};
                m.mat = Mat(3, sizes, plain.type(), plain.data).clone();
            }
            break;
    case 7: m.mat = Mat(0, 1, plain.type()); break;
    }
    array_ = cv::_InputArray(m.mat);
}

Input Input::items(Bytes& bytes, int count, int channels, const std::function<double(int)>& number)
{
    Mat m(count, 1, CV_64FC(channels));
    for (int i = 0; i < count; i++)
        for (int c = 0; c < channels; c++)
            m.ptr<double>(i)[c] = number(c);
    m = withType(bytes, m);
    if (count > 0)
        switch (bytes.rarely() ? bytes.below(6) : bytes.below(3))
        {
        default: break;
        case 1: m = m.reshape(channels, 1); break;
        case 2: m = m.reshape(1, count); break;
        case 3: m = m.reshape(1, 1); break;
        case 4: m = Mat(m.reshape(1, count).t()); break;
        case 5: m = m.reshape(1, count*channels); break;
        }
    Input result;
    result.layOut(bytes, m);
    return result;
}

Input Input::matrix(Bytes& bytes, int rows, int columns, const std::function<double(int, int)>& number)
{
    Mat m(rows, columns, CV_64F);
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++)
            m.at<double>(row, column) = number(row, column);
    m = withType(bytes, m);
    if (bytes.rarely() && !m.empty())
        switch (bytes.below(4))
        {
        case 0: m = m.reshape(1, 1); break;
        case 1: m = Mat(m.t()); break;
        case 2: m = m.reshape(columns); break;
        case 3: m = m.rowRange(0, bytes.below(rows + 1)); break;
        }
    Input result;
    result.layOut(bytes, m);
    return result;
}

Output::Output(Bytes& bytes, int channels, const Mat& in)
{
    array_ = cv::_InputOutputArray(mat_);
    if (!bytes.rarely())
        return;
    switch (bytes.below(9))
    {
    case 0: array_ = cv::_InputOutputArray(); break;
    case 1: mat_ = Mat(bytes.below(8), bytes.below(8), CV_MAKETYPE(bytes.below(8), 1 + bytes.below(4)), cv::Scalar(7)); break;
    case 2: mat_ = Mat(9, 9, CV_64FC(channels), cv::Scalar(7))(cv::Rect(1, 1, 1, 1 + bytes.below(7))); break;
    case 3: array_ = cv::_InputOutputArray(umat_); break;
    case 4:
        array_ = channels == 3 ? cv::_InputOutputArray(points3f_) : cv::_InputOutputArray(points2f_);
        break;
    case 5:
        array_ = channels == 3 ? cv::_InputOutputArray(points3d_) : cv::_InputOutputArray(points2d_);
        break;
    case 6: array_ = cv::_InputOutputArray(bytes_); break;
    case 7: array_ = cv::_InputOutputArray(fixed_); break;
    case 8: mat_ = in; break;                  // the same memory as an input
    }
}

int countOf(Bytes& bytes)
{
    return bytes.rarely() ? bytes.below(3000) : bytes.below(8);
}

GlassWindow windowOf(Bytes& bytes)
{
    GlassWindow window;
    const int layers = bytes.rarely() ? bytes.below(300) : bytes.below(4);
    window.normal = cv::normalize(cv::Vec3d(bytes.about(-0.5, 0.5), bytes.about(-0.5, 0.5), 1));
    if (bytes.rarely())
        window.normal = cv::Vec3d(bytes.number(), bytes.number(), bytes.number());
    window.distance = bytes.about(0, 200);
    const double thickness = bytes.about(0, 40), index = bytes.about(1, 2);
    for (int i = 0; i < layers; i++)
    {
        window.thickness.push_back(layers > 8 ? thickness : bytes.about(0, 40));
        window.index.push_back(layers > 8 ? index : bytes.about(1, 2));
    }
    if (bytes.rarely())
        window.index.resize(bytes.below(4), 1.5);
    if (bytes.maybe())
        window.outerIndex = bytes.about(1, 1.6);
    if (bytes.rarely())
        window.innerIndex = bytes.about(1, 1.6);
    return window;
}

namespace {

int coefficientsOf(Bytes& bytes)
{
    static const int counts[] = {0, 4, 5, 8, 12, 14};
    return bytes.rarely() ? bytes.below(20) : counts[bytes.below(6)];
}

double coefficient(Bytes& bytes, int i)
{
    static const double sizes[] = {0.5, 0.5, 0.01, 0.01, 0.2, 0.5, 0.3, 0.1, 0.01, 0.01, 0.01, 0.01, 0.05, 0.05};
    const double size = sizes[i % 14];
    return bytes.about(-size, size);
}

Input intrinsicsOf(Bytes& bytes, bool skew)
{
    const double f = bytes.about(300, 3000), aspect = bytes.about(0.9, 1.1), cx = bytes.about(0, 1500), cy = bytes.about(0, 1000);
    const double alpha = skew ? bytes.about(-5, 5) : bytes.rarely() ? bytes.number() : 0.;
    const double K[] = {f, alpha, cx, 0, f*aspect, cy, 0, 0, 1};
    const int broken = bytes.rarely() ? bytes.below(9) : -1;
    const double instead = broken < 0 ? 0. : bytes.number();
    return Input::matrix(bytes, 3, 3, [&](int r, int c) { return 3*r + c == broken ? instead : K[3*r + c]; });
}

} // namespace

Lens::Lens(Bytes& bytes)
{
    cameraMatrix = intrinsicsOf(bytes, false);
    const int n = coefficientsOf(bytes);
    distCoeffs = Input::matrix(bytes, n, 1, [&](int i, int) { return coefficient(bytes, i); });
    window = windowOf(bytes);
}

namespace {

//! How many coefficients a model takes, of few: 0 to 19.
std::vector<int> countsOf(const std::string& model)
{
    std::vector<int> counts;
    for (int n = 0; n < 20; n++)
        try
        {
            RefractiveCamera::createByName(model, cv::Matx33d(1000, 0, 640, 0, 1000, 480, 0, 0, 1), Mat::zeros(n, 1, CV_64F));
            counts.push_back(n);
        }
        catch (const cv::Exception&) {}
    return counts;
}

//! A number for each "..." in it.
std::string filled(Bytes& bytes, std::string model)
{
    for (size_t at; (at = model.find("...")) != std::string::npos; )
        model.replace(at, 3, std::to_string(bytes.below(bytes.rarely() ? 256 : 12)));
    return model;
}

//! A lens of any model that there is.
cv::Ptr<RefractiveCamera> anyModel(Bytes& bytes)
{
    static const std::vector<cv::String> models = RefractiveCamera::lensModels();
    const std::string model = filled(bytes, models[bytes.below((int)models.size())]);
    const std::vector<int> counts = countsOf(model);
    const int n = counts.empty() || bytes.rarely() ? bytes.below(400) : counts[bytes.below((int)counts.size())];
    const Input K = intrinsicsOf(bytes, false);
    const Input D = Input::matrix(bytes, n, 1, [&](int i, int) { return coefficient(bytes, i); });
    return RefractiveCamera::createByName(model, K, D, windowOf(bytes));
}

} // namespace

cv::Ptr<RefractiveCamera> cameraOf(Bytes& bytes)
{
    if (bytes.rarely())
        return cv::Ptr<RefractiveCamera>();
    switch (bytes.below(4))
    {
    default:
    {
        const Lens lens(bytes);
        return RefractiveCamera::create(lens.cameraMatrix, lens.distCoeffs, lens.window);
    }
    case 1:
    {
        const Input K = intrinsicsOf(bytes, true);
        const Input D = Input::matrix(bytes, bytes.rarely() ? bytes.below(6) : 4, 1,
                                      [&](int, int) { return bytes.about(-0.1, 0.1); });
        return RefractiveCamera::createFisheye(K, D, windowOf(bytes));
    }
    case 2:
    {
        static const char* models[] = {"LENSMODEL_PINHOLE", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8",
                                       "LENSMODEL_OPENCV12", "LENSMODEL_OPENCV14", "", "LENSMODEL_SPLINED_STEREOGRAPHIC"};
        static const int counts[] = {0, 4, 5, 8, 12, 14, 0, 9};
        const int model = bytes.below(bytes.rarely() ? 8 : 5);
        const int n = 4 + (bytes.rarely() ? bytes.below(20) : counts[model]);
        const Input numbers = Input::matrix(bytes, n, 1, [&](int i, int) {
            return i < 2 ? bytes.about(300, 3000) : i < 4 ? bytes.about(0, 1500) : coefficient(bytes, i - 4); });
        return RefractiveCamera::createMrcal(models[model], numbers, windowOf(bytes));
    }
    case 3: return anyModel(bytes);
    }
}

Input pixels(Bytes& bytes, int count)
{
    return Input::items(bytes, count, 2, [&](int) { return bytes.about(-200, 2000); });
}

Input objectPoints(Bytes& bytes, int count, bool flat)
{
    return Input::items(bytes, count, 3, [&](int c) { return c == 2 && flat ? bytes.rarely() ? bytes.number() : 0.
                                                                            : bytes.about(-300, 300); });
}

Input rotation(Bytes& bytes, double size)
{
    const cv::Vec3d rvec(bytes.about(-size, size), bytes.about(-size, size), bytes.about(-size, size));
    if (!bytes.maybe())
        return Input::matrix(bytes, 3, 1, [&](int i, int) { return rvec[i]; });
    cv::Matx33d R = cv::Matx33d::eye();
    if (cv::norm(rvec) < 100)
        cv::Rodrigues(rvec, R);
    const int broken = bytes.rarely() ? bytes.below(9) : -1;
    const double instead = broken < 0 ? 0. : bytes.number();
    return Input::matrix(bytes, 3, 3, [&](int r, int c) { return 3*r + c == broken ? instead : R(r, c); });
}

Input translation(Bytes& bytes, double size, double z)
{
    return Input::matrix(bytes, 3, 1, [&](int i, int) { return i == 2 ? z + bytes.about(-size, size) : bytes.about(-size, size); });
}

} // namespace fuzz
