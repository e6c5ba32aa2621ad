// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MISSING_HPP
#define OPENCV_REFRACT_MISSING_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** For each lane that a kernel left without an answer, NaN in its first output: the answer, or why there is none.
@param answer of lane i, returns the lane's status */
template<typename Answer>
void answerMissing(int n, const double* output, uchar* status, const Answer& answer)
{
    for (int i = 0; i < n; i++)
        if (status[i] == REFRACT_OK && std::isnan(output[i]))
            status[i] = answer(i);
}

}} // namespace

#endif // OPENCV_REFRACT_MISSING_HPP
