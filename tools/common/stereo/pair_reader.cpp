// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/pair_reader.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"

using cv::format;

namespace tools {

std::pair<cv::Mat, cv::Mat> PairReader::read(const FramePair& pair)
{
    cv::Mat image1 = first_.read(pair.first), image2 = second_.read(pair.second);
    requireSize(image1, first_.name(pair.first), rig_.cameras[0].camera->imageSize());
    requireSize(image2, second_.name(pair.second), rig_.cameras[1].camera->imageSize());
    if (image1.size() != image2.size())
        throw Failure(format("the images of the cameras are %dx%d and %dx%d pixels: refract_stereo is for two of one size",
                             image1.cols, image1.rows, image2.cols, image2.rows));
    if (needsColour_ && (image1.channels() != 3 || image2.channels() != 3))
        throw Failure("'" + (image1.channels() != 3 ? first_.name(pair.first) : second_.name(pair.second))
                      + "' is a grey image: --channels is for colours, leave it out");
    makeEightBit(image1, image2);
    return {image1, image2};
}

} // namespace tools
