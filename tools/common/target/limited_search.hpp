// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIMITED_SEARCH_HPP
#define REFRACT_TOOLS_LIMITED_SEARCH_HPP

#include <opencv2/core.hpp>
#include <functional>
#include <vector>

namespace tools {

/** Runs a search that may take for ever and cannot be interrupted, as cv::findChessboardCorners and cv::findCirclesGrid, for a
limited time: in a child process, which is ended when the time is over. The limit is of processor time, so that a busy machine
finds what an idle one does; four times as long on the clock is the end too.
@param most points that the search may return.
@return what the search returned; empty if it did not end. */
std::vector<cv::Point2f> searchLimited(int seconds, size_t most, const std::function<std::vector<cv::Point2f>()>& search);

} // namespace tools

#endif // REFRACT_TOOLS_LIMITED_SEARCH_HPP
