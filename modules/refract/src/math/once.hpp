// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ONCE_HPP
#define OPENCV_REFRACT_ONCE_HPP

#include <atomic>
#include <mutex>

namespace cv { namespace refract {

//! Work that waits for its first use. std::call_once alone costs, each time, as much as a kernel spends on ten points.
class Once
{
public:
    template<typename Work>
    void operator()(const Work& work)
    {
        if (done_.load(std::memory_order_acquire))
            return;
        std::call_once(flag_, work);
        done_.store(true, std::memory_order_release);
    }
private:
    std::once_flag flag_;
    std::atomic<bool> done_{false};
};

}} // namespace

#endif // OPENCV_REFRACT_ONCE_HPP
