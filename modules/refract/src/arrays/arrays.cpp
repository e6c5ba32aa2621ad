// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "arrays/array_kernels.hpp"
#include "arrays/column_output.hpp"
#include "math/rotation.hpp"
#include <cstring>

namespace cv { namespace refract {

//! How far ahead of the block being read the memory is asked for the next.
const int AHEAD = 2*BLOCK;

/* Asks for memory that will be read or written soon. It comes while something else is computed; stores would otherwise wait
for it one after the other. */
static void prefetch(const uchar* memory, size_t bytes)
{
#ifdef __GNUC__
    const size_t LINE = 64;
    for (size_t i = 0; i < bytes; i += LINE)
        __builtin_prefetch(memory + i);
#else
    CV_UNUSED(memory); CV_UNUSED(bytes);
#endif
}

//! Prefetches what follows block begin ... begin + n - 1 of an array that is read from its start to its end.
static void prefetchAhead(const uchar* array, size_t itemSize, int size, int begin, int n)
{
    if (begin + AHEAD < size)
        prefetch(array + (begin + AHEAD)*itemSize, n*itemSize);
}

static String describe(const Mat& m)
{
    String shape;
    for (int i = 0; i < m.dims; i++)
        shape += format(i ? "x%d" : "%d", m.size[i]);
    return shape + " " + typeToString(m.type());
}

//! The points of an array as a continuous Mat, and how many there are.
static Mat pointsOf(InputArray a, int channels, const char* name, int& size)
{
    Mat m = a.getMat();
    size = 0;
    if (m.empty())
        return m;
    if (m.depth() != CV_32F && m.depth() != CV_64F)
        CV_Error_(Error::StsUnsupportedFormat, ("%s is %s; it must be float32 or float64", name, describe(m).c_str()));
    size = m.checkVector(channels, -1, false);
    if (size < 0 && m.dims == 2 && m.channels() == 1 && m.rows == channels)     // a point a column
    {
        m = m.t();
        size = m.rows;
    }
    if (size < 0)
        CV_Error_(Error::StsBadSize, ("%s is %s; it must be Nx1 or 1xN with %d channels, or Nx%d or %dxN with one",
                                      name, describe(m).c_str(), channels, channels, channels));
    return m.isContinuous() ? m : m.clone();
}

PointReader::PointReader(InputArray points, int channels, const char* name)
{
    points_ = pointsOf(points, channels, name, size_);
    depth_ = points_.empty() ? (points.depth() == CV_32F ? CV_32F : CV_64F) : points_.depth();
}

void PointReader::load(int begin, int n, double* x, double* y, double* z, uchar* status) const
{
    std::fill(status, status + n, (uchar)REFRACT_OK);
    const size_t pointSize = (size_t)(z ? 3 : 2)*points_.elemSize1();
    const bool finite = arrayKernels().load(points_.data + begin*pointSize, depth_ == CV_32F, n, x, y, z);
    prefetchAhead(points_.data, pointSize, size_, begin, n);
    if (finite)
        return;
    for (int i = 0; i < n; i++)
        if (!std::isfinite(x[i]) || !std::isfinite(y[i]) || (z && !std::isfinite(z[i])))
            status[i] = REFRACT_NOT_FINITE;
}

PointWriter::PointWriter(OutputArray points, int size, int channels, int depth)
{
    if (!points.needed())
        return;
    if (points.fixedType())
        depth = CV_MAT_DEPTH(points.type());
    if (depth != CV_32F && depth != CV_64F)
        CV_Error_(Error::StsUnsupportedFormat, ("an output array is %s; it must be float32 or float64, as it may have "
                                                "to hold NaN", typeToString(points.type()).c_str()));
    points.create(size, 1, CV_MAKETYPE(depth, channels), -1, true);
    points_ = points.getMat();
}

template<typename T>
static void setNaN(T* points, int channels, int n, const uchar* status)
{
    for (int i = 0; i < n; i++)
        if (status[i] != REFRACT_OK)
            std::fill(points + channels*i, points + channels*(i + 1), std::numeric_limits<T>::quiet_NaN());
}

void PointWriter::store(int begin, int n, const double* x, const double* y, const double* z, const uchar* status)
{
    if (points_.empty())
        return;
    const bool isFloat = points_.depth() == CV_32F, isContinuous = points_.isContinuous();
    const int channels = z ? 3 : 2;
    const size_t itemSize = points_.elemSize();
    double row[3*BLOCK];
    uchar* const points = isContinuous ? points_.data + begin*itemSize : (uchar*)row;
    arrayKernels().store(points, isFloat, n, x, y, z);
    uchar reasons = 0;
    for (int i = 0; i < n; i++)
        reasons |= status[i];
    if (reasons != REFRACT_OK && isFloat)
        setNaN((float*)points, channels, n, status);
    else if (reasons != REFRACT_OK)
        setNaN((double*)points, channels, n, status);
    for (int i = 0; i < n && !isContinuous; i++)
        std::memcpy(points_.ptr(begin + i), points + i*itemSize, itemSize);
}

void PointWriter::prepare(int begin, int n) const
{
    if (!points_.empty() && points_.isContinuous())
        prefetch(points_.data + begin*points_.elemSize(), n*points_.elemSize());
}

StatusWriter::StatusWriter(OutputArray status, int size)
{
    if (!status.needed())
        return;
    status.create(size, 1, CV_8U, -1, true);
    status_ = status.getMat();
}

void StatusWriter::store(int begin, int n, const uchar* status)
{
    if (status_.empty())
        return;
    if (status_.isContinuous())
        std::copy(status, status + n, status_.ptr<uchar>() + begin);
    else
        for (int i = 0; i < n; i++)
            *status_.ptr<uchar>(begin + i) = status[i];
}

static void checkFloat(const Mat& m, const char* name)
{
    if (m.depth() != CV_32F && m.depth() != CV_64F && !m.empty())
        CV_Error_(Error::StsUnsupportedFormat, ("%s is %s; it must be float32 or float64", name, describe(m).c_str()));
}

//! Number i of an array of at most two dimensions, channels counted, row by row.
static double numberAt(const Mat& m, int i)
{
    const int columns = m.cols*m.channels();
    return m.depth() == CV_32F ? m.ptr<float>(i/columns)[i % columns] : m.ptr<double>(i/columns)[i % columns];
}

/* The numbers of a small argument, which must be finite, into an array of `capacity`; nothing is allocated. Returns how
many there are, 0 for an empty argument. */
static int readSmall(InputArray a, int capacity, double* numbers, const char* name)
{
    const Mat m = a.getMat();
    checkFloat(m, name);
    if (m.dims > 2)
        CV_Error_(Error::StsBadSize, ("%s is %s; it must have one or two dimensions", name, describe(m).c_str()));
    const int count = (int)m.total()*m.channels();
    for (int i = 0; i < count; i++)
    {
        const double number = numberAt(m, i);
        if (!std::isfinite(number))
            CV_Error_(Error::StsBadArg, ("%s[%d] is %g; it must be finite", name, i, number));
        if (i < capacity)
            numbers[i] = number;
    }
    return count;
}

static void wrongShape(InputArray a, const char* name, const char* wanted)
{
    CV_Error_(Error::StsBadSize, ("%s is %s; it must be %s", name,
                                  a.empty() ? "empty" : describe(a.getMat()).c_str(), wanted));
}

//! True for rows x columns in one channel.
static bool hasShape(InputArray a, int rows, int columns)
{
    return a.dims() == 2 && a.rows() == rows && a.cols() == columns && a.channels() == 1;
}

Matx33d readCameraMatrix(InputArray a, const char* name)
{
    Matx33d K;
    readSmall(a, 9, K.val, name);
    if (!hasShape(a, 3, 3))
        wrongShape(a, name, "3x3");
    if (!(K(0, 0) > 0) || !(K(1, 1) > 0))
        CV_Error_(Error::StsBadArg, ("%s has focal lengths (%g, %g); they must be positive", name, K(0, 0), K(1, 1)));
    if (K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1)
        CV_Error_(Error::StsBadArg, ("%s is not upper triangular with (2, 2) = 1; (2, 2) is %g", name, K(2, 2)));
    return K;
}

std::vector<double> readNumbers(InputArray a, const char* name)
{
    std::vector<double> numbers(a.empty() ? 0 : a.total()*a.channels());
    readSmall(a, (int)numbers.size(), numbers.data(), name);
    return numbers;
}

DepthReader::DepthReader(InputArray depth, const char* name, int points, bool isNeeded)
    : size_(1), one_(std::numeric_limits<double>::infinity())
{
    if (depth.empty() && (!isNeeded || points == 0))
        return;
    if (depth.empty())
        CV_Error_(Error::StsBadArg, ("%s is empty; give the depth of the scene, as the window's effect depends on it (infinity "
                                     "is allowed)", name));
    depths_ = depth.getMat();
    if (depths_.depth() != CV_32F && depths_.depth() != CV_64F)     // millimetres as whole numbers, as depth cameras have them
        depths_.convertTo(depths_, CV_64F);
    if (!depths_.isContinuous())
        depths_ = depths_.clone();
    size_ = (int)depths_.total()*depths_.channels();
    // One number comes from Python as cv::Scalar, (d, 0, 0, 0): 0 is no depth, and (d, 0, 0, 0) no plane one can see.
    if (size_ == 4 && at(1) == 0 && at(2) == 0 && at(3) == 0)
    {
        if (points == 4)
            CV_Error_(Error::StsBadArg, ("%s is (%g, 0, 0, 0) for four points, which is ambiguous: one number, as Python passes it, or "
                                         "four depths; give an array of one number or of four", name,
                                         at(0)));
        size_ = 1;
    }
    one_ = at(0);
    if (size_ == 1)
        checkOne(name);
}

DepthReader::DepthReader(double depth, const char* name, bool isNeeded)
    : size_(1), one_(depth != 0 || isNeeded ? depth : std::numeric_limits<double>::infinity())
{
    if (one_ == 0)
        CV_Error_(Error::StsOutOfRange, ("%s is 0 (Python: None); give the depth of the scene, as the window's effect depends on it "
                                         "(infinity is allowed)", name));
    checkOne(name);
}

void DepthReader::checkOne(const char* name) const
{
    if (!(one_ > 0))
        CV_Error_(Error::StsOutOfRange, ("%s is %g; it must be positive", name, one_));
}

double DepthReader::at(int i) const
{
    if (depths_.empty())
        return one_;
    return depths_.depth() == CV_32F ? depths_.ptr<float>()[i] : depths_.ptr<double>()[i];
}

void DepthReader::load(int begin, int n, double* depth) const
{
    if (size_ == 1)
        std::fill(depth, depth + n, one_);
    else if (depths_.depth() == CV_32F)
        std::copy(depths_.ptr<float>() + begin, depths_.ptr<float>() + begin + n, depth);
    else
        std::copy(depths_.ptr<double>() + begin, depths_.ptr<double>() + begin + n, depth);
    prefetchAhead(depths_.data, depths_.elemSize1(), size_, begin, n);
}

//! The rotation next to a matrix that is one but for a few digits: Newton's iteration for the polar decomposition.
static Matx33d nearestRotation(Matx33d R)
{
    for (int i = 0; i < 4; i++)
        R = 0.5*(R + R.inv().t());
    return R;
}

Matx33d readRotation(InputArray a, const char* name)
{
    double r[9];
    const int count = a.empty() ? 0 : readSmall(a, 9, r, name);
    if (count == 3)
        return rotationMatrix(Vec3d(r));
    if (count != 9)
        wrongShape(a, name, "3x3 or a rotation vector of 3");
    const Matx33d R(r);
    const double off = cv::norm(R*R.t() - Matx33d::eye());
    if (!(off <= 1e-3))
        CV_Error_(Error::StsBadArg, ("%s is not a rotation: |R R^T - I| = %g", name, off));
    if (determinant(R) < 0)
        CV_Error_(Error::StsBadArg, ("%s is not a rotation: its determinant is %g", name, determinant(R)));
    // Printed matrices are rotations to a few digits only; inverses by the transpose need one to all digits.
    return nearestRotation(R);
}

Matx33d readRotationOrNone(InputArray a, const char* name)
{
    return a.empty() ? Matx33d::eye() : readRotation(a, name);
}

Vec3d readRotationVector(InputArray a, const char* name)
{
    const double ROUNDING = 1e-6;
    const Vec3d shortest = rotationVector(readRotation(a, name));
    if (a.total()*a.channels() != 3)
        return shortest;
    const Vec3d given = readVec3(a, name);
    return norm(given - shortest) < ROUNDING ? shortest : given;
}

Vec3d readVec3(InputArray a, const char* name)
{
    Vec3d v;
    if (readSmall(a, 3, v.val, name) != 3)
        wrongShape(a, name, "a vector of 3");
    return v;
}

Vec2d readDepthRange(const Vec2d& range, bool mayBeZero)
{
    if (!(range[0] > 0 || (mayBeZero && range[0] == 0)) || !(range[1] > range[0]) || !std::isfinite(range[0]))
        CV_Error_(Error::StsOutOfRange, ("depthRange is (%g, %g); it must be 0 %s near < far", range[0], range[1],
                                         mayBeZero ? "<=" : "<"));
    return Vec2d(range[0], range[1] < DBL_MAX ? range[1] : std::numeric_limits<double>::infinity());
}

Matx33d readProjection(InputArray a, const char* name)
{
    if (a.empty())
        return Matx33d::eye();
    Matx34d P;
    const int count = readSmall(a, 12, P.val, name);
    if (!hasShape(a, 3, 3) && (count != 12 || !hasShape(a, 3, 4)))
        wrongShape(a, name, "3x3 or 3x4");
    const Matx33d projection = hasShape(a, 3, 3) ? Matx33d(P.val) : P.get_minor<3, 3>(0, 0);
    if (determinant(projection) == 0)
        CV_Error_(Error::StsBadArg, ("%s is singular", name));
    return projection;
}

template<typename Float, typename Double>
static std::vector<Double> readPoints(InputArray a, int channels, const char* name)
{
    int n;
    const Mat m = pointsOf(a, channels, name, n);
    std::vector<Double> points(n);
    for (int i = 0; i < n; i++)
        points[i] = m.depth() == CV_32F ? Double(m.ptr<Float>()[i]) : m.ptr<Double>()[i];
    return points;
}

std::vector<Point2d> readPoints2(InputArray a, const char* name) { return readPoints<Point2f, Point2d>(a, 2, name); }
std::vector<Point3d> readPoints3(InputArray a, const char* name) { return readPoints<Point3f, Point3d>(a, 3, name); }

void writeColumn(const Mat& column, OutputArray out)
{
    if (!out.needed())
        return;
    const int type = out.fixedType() ? out.type() : column.type();
    out.create(column.rows, 1, type, -1, true);
    Mat given = out.getMat();
    column.reshape(0, given.rows).convertTo(given, type);
}

void writeVectors(const std::vector<Vec3d>& vectors, OutputArrayOfArrays out)
{
    if (!out.needed())
        return;
    const int count = (int)vectors.size();
    if (!out.isMatVector())
        return writeColumn(Mat(vectors), out);
    out.create(count, 1, CV_64FC3);
    for (int i = 0; i < count; i++)
    {
        out.create(3, 1, CV_64F, i, true);
        Mat(vectors[i]).copyTo(out.getMat(i));
    }
}

void writeMatrices(const std::vector<Mat>& matrices, OutputArrayOfArrays out)
{
    if (!out.needed())
        return;
    out.create((int)matrices.size(), 1, CV_64F);
    for (int i = 0; i < (int)matrices.size(); i++)
    {
        out.create(matrices[i].size(), CV_64F, i, true);
        matrices[i].copyTo(out.getMat(i));
    }
}

}} // namespace
