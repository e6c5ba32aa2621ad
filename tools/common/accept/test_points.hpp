// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TEST_POINTS_HPP
#define REFRACT_TOOLS_TEST_POINTS_HPP

#include "calibrate/calib_file.hpp"
#include "measure/point_error.hpp"
#include "target/target.hpp"

/* The measured points that an acceptance test is made of. */
namespace tools {

//! A point, by the names that lengths.csv calls it.
struct TestPoint
{
    std::string image, id;
    cv::Point3d X;                          //!< frame of camera 1; NaN: no answer
    std::vector<cv::Point2d> pixels;        //!< of each camera; NaN: not seen, or not known
    cv::Vec3d sigma;                        //!< one standard deviation; NaN: not known
    int status = 0;
};

struct TestPoints
{
    std::string source;                     //!< file, for texts
    std::vector<TestPoint> points;
    bool havePixels = false, haveSigma = false;

    std::vector<std::string> images() const;                                //!< in order
    RigPixels pixelsOf(const std::string& image, size_t cameras) const;     //!< of each camera
};

/** What refract_measure wrote, or any points: [image,]id,x,y,z, with u1,v1,... (raw pixels), sx,sy,sz and status where they are known.
Throws Failure that names file and line. */
TestPoints readTestPoints(const std::string& path, size_t cameras);

/** Throws Failure that names the images of points whose pixels are those of images that calibrated; of points without pixels, those where
the calibration sees them.
@return whether it can be told for certain */
bool requireOtherImages(const TestPoints& points, const std::vector<std::string>& images, const Calibration& calibration);

//! Those that have the name of an image that calibrated: all that can be told of points without pixels.
std::vector<std::string> namesThatCalibrated(const std::vector<std::string>& images, const Calibration& calibration);

//! Boards that a rig saw, measured as refract_measure does, and the files in which they were seen.
struct BoardPoints
{
    TestPoints points;
    std::vector<std::string> files;
};

/** @param images of each camera, a glob or a file of points @param pixelSigma of their noise
Throws Failure if no two cameras have images of one name with the board, or no point has an answer. */
BoardPoints measureBoards(const Calibration& calibration, const std::vector<std::string>& images, const Target& target, double pixelSigma,
                          bool quiet);

//! The noise of a pixel coordinate of a test, and what its reader should know of it, a sentence each.
struct PixelNoise
{
    double sigma;
    std::vector<std::string> remarks;
};

/** As the caller states it, or as the calibration's residuals have it; more where the points' own rays miss each other by more. Throws
Failure where they refute what is stated.
@param stated --pixel-sigma; 0: not stated */
PixelNoise pixelNoiseOf(const Calibration& calibration, const TestPoints& points, double stated);

} // namespace tools

#endif // REFRACT_TOOLS_TEST_POINTS_HPP
