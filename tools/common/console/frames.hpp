// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FRAMES_HPP
#define REFRACT_TOOLS_FRAMES_HPP

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

/* What one camera took, image by image, from files or from a video. */
namespace tools {

class Frames
{
public:
    /** Throws Failure if there is nothing.
    @param source an image, a glob, numbered images (left%04d.png) or a video file
    @param viewPattern where names have the moment, see momentOf(); empty: what takeOffCameras() finds */
    explicit Frames(const std::string& source, const std::string& viewPattern = "");

    int size() const { return (int)(isVideo() ? count_ : files_.size()); }
    //! Without a name of its own, but with a number: of a video or of numbered images.
    bool numbered() const { return isVideo() || !numbers_.empty(); }
    bool isVideo() const { return files_.empty(); }
    bool hasPattern() const { return !viewPattern_.empty() && !isVideo(); }

    //! What its results are called: the file's stem, or frame000012.
    std::string stem(int i) const;
    //! As read() takes it, for a sentence: the file's name, or "left.avi, frame 12".
    std::string name(int i) const;
    //! With all colours and bits. Frames in turn are fast; one before the last needs a video from its start again.
    cv::Mat read(int i, bool withAlpha = false);

    const std::string& source() const { return source_; }
    const std::vector<std::string>& files() const { return files_; }    //!< empty: a video
    std::vector<std::string> paths() const { return isVideo() ? std::vector<std::string>{source_} : files_; }
    //! What images of one moment are found by.
    std::vector<std::string> moments() const;

private:
    void open();
    cv::Mat readVideo(int i);

    std::string source_, viewPattern_;
    std::vector<std::string> files_;
    std::vector<long> numbers_;         //!< of numbered images
    cv::VideoCapture video_;
    int count_ = 0, next_ = 0;
};

//! What several cameras took at one moment.
struct Moment
{
    std::string stem;
    std::vector<int> frames;        //!< per camera; -1: none
};

/** Frames of several cameras by their number, images by their stem; single images are of one moment whatever their names. Throws
Failure if two videos are of different length, or if an image is given for two cameras. */
std::vector<Moment> momentsOf(const std::vector<const Frames*>& cameras);

struct FramePair
{
    std::string stem;
    int first, second;
};

struct FramePairs
{
    std::vector<FramePair> pairs;
    std::vector<std::string> unpaired1, unpaired2;  //!< stems without partner
};

//! The moments of two cameras that have both; throws Failure also if there are none.
FramePairs pairsOf(const Frames& first, const Frames& second);

//! The largest value in an image; of one of 8 bits 255.
double whiteOf(const cv::Mat& image);

//! 8 bits; more bits are made brighter or darker so that one value, and what is above it, is 255.
void makeEightBit(cv::Mat& image, double white);

//! 8 bits each, as matchers want them; more bits of both are made brighter or darker by one factor.
void makeEightBit(cv::Mat& image1, cv::Mat& image2);

} // namespace tools

#endif // REFRACT_TOOLS_FRAMES_HPP
