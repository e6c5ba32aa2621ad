// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COLUMNS_HPP
#define OPENCV_REFRACT_COLUMNS_HPP

namespace cv { namespace refract {

/** Where a matrix of each lane goes, one array for each element: element (r, c) of lane i is at(r, c)[i]. With stride 1 that
is one lane's matrix, row-major. */
struct Columns
{
    double* data;       //!< null: not wanted
    int perRow;         //!< columns of a row
    int stride;         //!< from one array to the next
    double* at(int r, int c) const { return data + (r*perRow + c)*stride; }
    //! The same rows from column c on.
    Columns from(int c) const { const Columns rest = { data ? data + c*stride : nullptr, perRow, stride }; return rest; }
};

}} // namespace

#endif // OPENCV_REFRACT_COLUMNS_HPP
