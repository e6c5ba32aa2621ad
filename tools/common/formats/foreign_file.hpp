// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FOREIGN_FILE_HPP
#define REFRACT_TOOLS_FOREIGN_FILE_HPP

#include "console/failure.hpp"
#include "console/json.hpp"
#include "formats/foreign_rig.hpp"

#include <cstring>

/* What the table of formats in foreign_rig.cpp calls. Each throws Failure, or Json::Error, that says what is wrong, without the file's
name. is...() says whether a file looks like one, be it cut short or damaged. */
namespace tools {

//! A file of another program, as its reader takes it.
struct ForeignFile
{
    std::string name, bytes;

    //! Lines with something on them that is no comment of '#'.
    std::vector<std::string> lines() const;
    //! The first of them; empty: there is none.
    std::string firstLine() const;
};
ForeignFile contentsOf(const std::string& name);        //!< no bytes: it is no file, or larger than those of cameras are

//! Reads a binary file, little endian, from its beginning to its end. Throws Failure where it is too short.
class ByteReader
{
public:
    explicit ByteReader(const std::string& bytes, size_t at = 0) : bytes_(bytes) { skip(at); }

    size_t left() const { return bytes_.size() - at_; }
    void skip(size_t count)
    {
        if (count > left())
            throw Failure("it ends too early: is it cut short?");
        at_ += count;
    }
    std::string take(size_t count)
    {
        skip(count);
        return bytes_.substr(at_ - count, count);
    }
    template<typename T> T number()
    {
        T value;
        skip(sizeof value);
        std::memcpy(&value, bytes_.data() + at_ - sizeof value, sizeof value);
        return value;
    }

private:
    const std::string& bytes_;
    size_t at_ = 0;
};

//! All numbers of a text, whatever is between them; a word that is none ends them. @param whole receives whether all was numbers
std::vector<double> leadingNumbers(const std::string& text, bool* whole = nullptr);

// ---- cameras of numbers

//! What `make` makes of a file's numbers; Failure "its WHAT cannot be one" where the module refuses them.
template<typename Make> auto possible(const std::string& what, const Make& make) -> decltype(make())
{
    try
    {
        return make();
    }
    catch (const cv::Exception& e)
    {
        throw Failure("its " + what + " cannot be one: " + e.err);
    }
}

/** A camera without a window. @param model "opencv" or "fisheye"
@param coefficients zeros may follow, where the model has fewer places
@param size 0x0 where the file does not say. Throws Failure. */
cv::Ptr<cv::refract::RefractiveCamera> makeCamera(const std::string& model, const cv::Matx33d& cameraMatrix,
                                                  std::vector<double> coefficients, const cv::Size& size);

//! Of an image. Throws Failure for one that cannot be.
cv::Size imageSizeOf(double width, double height);

//! fx, fy, cx, cy as a matrix.
inline cv::Matx33d cameraMatrixOf(double fx, double fy, double cx, double cy) { return {fx, 0, cx, 0, fy, cy, 0, 0, 1}; }

// ---- files of lines or bytes

//! COLMAP's list of cameras, cameras.txt and cameras.bin, also with the ports of its fork for cameras under water.
bool isColmapText(const ForeignFile& file);
ForeignRig readColmapText(const ForeignFile& file);
bool isColmapBinary(const ForeignFile& file);
ForeignRig readColmapBinary(const ForeignFile& file);

/** OpenPTV's NAME.ori, with NAME.addpar and ptv.par beside it, or ptv.par in ../parameters: only this has the size of the image and of a
pixel, and the window's indices. */
bool isOpenPtv(const ForeignFile& file);
ForeignRig readOpenPtv(const ForeignFile& file);

//! OpenLPT's camera, a pinhole (PINHOLE) or one behind plates (PINPLATE). Where its y axis points up, so does that of the frame here.
bool isOpenLpt(const ForeignFile& file);
ForeignRig readOpenLpt(const ForeignFile& file);

// ---- files of names and values, as a tree

/** MATLAB's file of variables (level 5, as save -v6 and -v7 write it): numbers by name, matrices as lists of rows, structs as
objects. In place of an object of a class stands the text "object"; cells are passed over. */
Json readMat(const ForeignFile& file);

/** NumPy's archive of arrays, as savez and savez_compressed write it: its numbers by name, each array as lists of rows; arrays
of objects and texts are passed over. */
Json readNpz(const ForeignFile& file);

/** YAML as programs write numbers with it: maps, lists, both in either style, numbers and texts. cv::FileStorage takes only what OpenCV
writes: a heading, and lists that are indented. Tags are passed over; anchors, and texts of several lines, are refused. Throws Json::Error
that names the line. */
Json readYaml(const ForeignFile& file);

/** The cameras of such a tree, and where they are, if it says. No cameras: it has none.
@param format receives whose file it looks like, before anything is thrown */
ForeignRig readKeyedCameras(const Json& file, std::string& format);

//! All numbers of a list of lists, or of a map's data; empty where it has others than numbers.
std::vector<double> numbersOf(const Json& json);

} // namespace tools

#endif // REFRACT_TOOLS_FOREIGN_FILE_HPP
