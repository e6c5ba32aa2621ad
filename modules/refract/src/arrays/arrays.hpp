// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ARRAYS_HPP
#define OPENCV_REFRACT_ARRAYS_HPP

#include "precomp.hpp"

/* InputArray <-> blocks of structure-of-arrays. The only file that knows both. */

namespace cv { namespace refract {

//! Lanes of one block: small enough that all arrays of a chain of kernels stay in the first-level cache, and that the
//! memory has its next points ready while a block is computed.
const int BLOCK = 64;

//! N points of 2 or 3 coordinates, read in blocks.
class PointReader
{
public:
    PointReader(InputArray points, int channels, const char* name);
    int size() const { return size_; }
    int depth() const { return depth_; }    //!< CV_32F or CV_64F
    //! Points begin ... begin + n - 1; z is null for 2-D points. A non-finite lane gets REFRACT_NOT_FINITE.
    void load(int begin, int n, double* x, double* y, double* z, uchar* status) const;
private:
    Mat points_;
    int size_, depth_;
};

//! N points of 2 or 3 coordinates, written in blocks; a lane with status != 0 becomes NaN.
class PointWriter
{
public:
    //! Depth: the caller's if fixed, else `depth`. Nx1 with channels.
    PointWriter(OutputArray points, int size, int channels, int depth);
    //! Announces what store() will write, some computation before it does.
    void prepare(int begin, int n) const;
    void store(int begin, int n, const double* x, const double* y, const double* z, const uchar* status);
private:
    Mat points_;        //!< perhaps a column of a wider matrix
};

//! The status array, or nothing if the caller does not want it.
class StatusWriter
{
public:
    StatusWriter(OutputArray status, int size);
    void store(int begin, int n, const uchar* status);
private:
    Mat status_;
};

//! z of the scene points: one for all, or many. One number must be positive; among many a bad one is that point's own
//! problem.
class DepthReader
{
public:
    //! Empty = infinity, if it is not needed or there are no points.
    DepthReader(InputArray depth, const char* name, int points, bool isNeeded);
    //! One number for all; 0 = infinity, if it is not needed: Python hands None over as 0 where a double is wanted.
    DepthReader(double depth, const char* name, bool isNeeded);
    int size() const { return size_; }
    double at(int i) const;
    void load(int begin, int n, double* depth) const;
private:
    void checkOne(const char* name) const;
    Mat depths_;
    int size_;
    double one_;
};

//! What a point costs about, ns, through one lens and one window.
const double POINT_COST = 6;

/** Calls body(begin, n) over [0, size) in blocks of at most BLOCK, in parallel.
@param cost of a point, ns: some 50 us are worth another thread */
template<typename Body>
void forEachBlock(int size, double cost, const Body& body)
{
    const double grain = 5e4/cost;
    const auto run = [&](const Range& range)
    {
        for (int b = range.start; b < range.end; b++)
            body(b*BLOCK, std::min(BLOCK, size - b*BLOCK));
    };
    const Range blocks(0, (size + BLOCK - 1)/BLOCK);
    if (size < 2*grain)     // a few points are done before a second thread has woken up
        run(blocks);
    else
        parallel_for_(blocks, run, size/grain);
}
template<typename Body>
void forEachBlock(int size, const Body& body) { forEachBlock(size, POINT_COST, body); }

// Small arguments. Each throws with the argument's name and value.
Matx33d readCameraMatrix(InputArray m, const char* name);
Matx33d readRotation(InputArray r, const char* name);                   //!< 3x3 or rotation vector
Matx33d readRotationOrNone(InputArray r, const char* name);             //!< the same; empty: the identity
//! The same as a rotation vector: one that is given is returned as it is, though it may turn the long way round.
Vec3d readRotationVector(InputArray r, const char* name);
Vec3d readVec3(InputArray v, const char* name);
/** A range of depths with a finite near end; the far one is infinity from DBL_MAX on, which is what a default argument can say.
@param mayBeZero so may near */
Vec2d readDepthRange(const Vec2d& range, bool mayBeZero);
Matx33d readProjection(InputArray p, const char* name);                 //!< 3x3 or 3x4; empty = identity
std::vector<double> readNumbers(InputArray a, const char* name);        //!< any shape, one channel or a Vec; empty = none
//! A vector of points (N x 3 or N x 2 coordinates) as plain structures; NaN allowed.
std::vector<Point2d> readPoints2(InputArray a, const char* name);
std::vector<Point3d> readPoints3(InputArray a, const char* name);

//! As calib3d writes them: a 3x1 array each, or one array of 3-vectors; nothing if they are not wanted.
void writeVectors(const std::vector<Vec3d>& vectors, OutputArrayOfArrays out);
//! CV_64F, of any sizes; nothing if they are not wanted.
void writeMatrices(const std::vector<Mat>& matrices, OutputArrayOfArrays out);

}} // namespace

#endif // OPENCV_REFRACT_ARRAYS_HPP
