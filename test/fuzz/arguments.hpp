// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_ARGUMENTS_HPP
#define REFRACT_FUZZ_ARGUMENTS_HPP

#include "bytes.hpp"
#include <opencv2/refract.hpp>
#include <functional>
#include <memory>
#include <vector>

/* The arguments of a call, made from the fuzzer's bytes: mostly what a caller means to pass, rarely what he passes by mistake. */
namespace fuzz {

//! An input array and the memory it is in: any type, shape and layout.
class Input
{
public:
    Input() : memory_(std::make_shared<Memory>()) {}
    operator const cv::_InputArray&() const { return array_; }
    cv::Mat mat() const { return memory_->mat; }

    /** `count` items of `channels` numbers. */
    static Input items(Bytes& bytes, int count, int channels, const std::function<double(int)>& numberOfChannel);
    //! A small matrix, most often rows x columns.
    static Input matrix(Bytes& bytes, int rows, int columns, const std::function<double(int, int)>& number);

private:
    void layOut(Bytes& bytes, const cv::Mat& plain);

    struct Memory
    {
        cv::Mat mat, whole;
        cv::UMat umat;
        std::vector<cv::Point2f> points2f;
        std::vector<cv::Point2d> points2d;
        std::vector<cv::Point3f> points3f;
        std::vector<cv::Point3d> points3d;
        std::vector<cv::Mat> mats;
    };
    std::shared_ptr<Memory> memory_;    // stays where it is when the argument is copied
    cv::_InputArray array_;
};

//! An output array in any state that a caller may leave it in.
class Output
{
public:
    //! `channels` of the items that are to come; `in`: an argument of the same call that it may be.
    Output(Bytes& bytes, int channels, const cv::Mat& in = cv::Mat());
    Output(const Output&) = delete;
    operator const cv::_OutputArray&() const { return array_; }
    operator const cv::_InputOutputArray&() const { return array_; }
    bool needed() const { return array_.needed(); }
    //! One item a row, also where it is a std::vector or was a row before.
    cv::Mat mat() const
    {
        const cv::Mat m = array_.getMat();
        return m.rows == 1 ? m.reshape(0, (int)m.total()) : m;
    }

private:
    cv::Mat mat_;
    cv::UMat umat_;
    std::vector<cv::Point2f> points2f_;
    std::vector<cv::Point2d> points2d_;
    std::vector<cv::Point3f> points3f_;
    std::vector<cv::Point3d> points3d_;
    std::vector<uchar> bytes_;
    cv::Matx33d fixed_;
    cv::_InputOutputArray array_;
};

int countOf(Bytes& bytes);                                      //!< of points: mostly few, rarely none or some thousands
cv::refract::GlassWindow windowOf(Bytes& bytes);                //!< mostly one that check() lets pass
cv::Ptr<cv::refract::RefractiveCamera> cameraOf(Bytes& bytes);  //!< any lens; rarely null; may throw cv::Exception

//! cameraMatrix, distCoeffs and window of the other overload.
struct Lens
{
    explicit Lens(Bytes& bytes);
    Input cameraMatrix, distCoeffs;
    cv::refract::GlassWindow window;
};

Input pixels(Bytes& bytes, int count);
Input objectPoints(Bytes& bytes, int count, bool flat = false);
Input rotation(Bytes& bytes, double size);      //!< vector or matrix
Input translation(Bytes& bytes, double size, double z);

} // namespace fuzz

#endif // REFRACT_FUZZ_ARGUMENTS_HPP
