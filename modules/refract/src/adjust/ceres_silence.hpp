// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CERES_SILENCE_HPP
#define OPENCV_REFRACT_CERES_SILENCE_HPP

namespace cv { namespace refract {

/** While one exists, Ceres writes nothing. What it warns of (a step that cannot be computed, so that it is shortened) is usual, and
goes to standard error by glog, whatever the solver's options say. For glog itself this is a flag of the process. */
class Silence
{
public:
    Silence();
    ~Silence();
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
};

}} // namespace

#endif // OPENCV_REFRACT_CERES_SILENCE_HPP
