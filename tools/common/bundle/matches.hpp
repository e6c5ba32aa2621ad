// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MATCHES_HPP
#define REFRACT_TOOLS_MATCHES_HPP

#include "calibrate/calib_file.hpp"
#include "measure/measurement.hpp"

/* Points that several cameras saw, and the lengths that are known between them: of a wand, of anything with marks on it. */
namespace tools {

//! A scene point by name. What has another image is another point, whatever its id: the wand has moved on.
struct PointName
{
    std::string image, id;          //!< image is empty where the table has no such column

    bool operator<(const PointName& other) const { return std::tie(image, id) < std::tie(other.image, other.id); }
    std::string text() const { return image.empty() ? id : image + " " + id; }
};

struct Matches
{
    std::vector<PointName> names;
    RigPixels pixels;               //!< per camera, per point; NaN: not seen
    std::vector<std::vector<double>> stds = {};     //!< of a coordinate of each pixel; empty: all are alike

    int cameraCount() const { return (int)pixels.size(); }
    int seenBy(int point) const;    //!< how many cameras saw it
    bool isSeen(int camera, int point) const { return pixels[camera][point].x == pixels[camera][point].x; }
    //! RMS of the stds of all pixels seen; 0: not known.
    double usualStd() const;
};

/** matches.csv: [image,]id,u1,v1,u2,v2,...[,std1,std2,...]; refract_measure's points.csv will do. Throws Failure that names
file and line, also where a pixel is outside its image, and where the cameras have nothing in common.
@param yFrom see PixelOrigin */
Matches readMatches(const std::string& path, const Calibration& start, const std::string& startPath, const std::string& yFrom = "");

struct GivenLength
{
    int a, b;                       //!< of Matches::names
    double length, std;             //!< as given
    int object;                     //!< rows with equal numbers are one object, which has one error at all times
    int line = 0;                   //!< of its table
};

struct GivenLengths
{
    std::vector<GivenLength> list;
    int objects = 0;
    double factorStd = 0.;          //!< relative, of a factor that all may share beside their own errors

    /** The relative error that all lengths share at the least: more moments do not average that of one wand. */
    double commonStd() const;
    /** As refractiveBundleAdjust takes them beside that error. An object's error beyond it counts once, however many moments
    there are; by itself, each moment has a twentieth (the wand bends, its marks turn). */
    std::vector<cv::Vec4d> rows() const;
    std::vector<int> rowsOfObjects() const;     //!< how many

private:
    double leastStd() const;
};

//! Some of the points, with those that lengths lead to, to try what fits; the others are seen by no camera.
Matches thinned(const Matches& matches, const GivenLengths& lengths);

//! lengths.csv: [image,]id1,id2,length,std; without an image a row is of every image that shows both points.
GivenLengths readLengths(const std::string& path, const std::string& matchesPath, const Matches& matches);

} // namespace tools

#endif // REFRACT_TOOLS_MATCHES_HPP
