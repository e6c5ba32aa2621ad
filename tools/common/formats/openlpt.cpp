// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"
#include "formats/foreign_file.hpp"

#include <map>
#include <sstream>

/* OpenLPT: a line of '#' says what follows. PINPLATE is a pinhole behind plates: a point of the outermost face and the normal from the
camera to the scene, in the frame of the world; indices and widths from the scene to the camera. A focal length below 0 is a y axis
that points up: then the camera's frame here is the mirror image of theirs, for all cameras alike. */

namespace tools {

using cv::Matx33d;
using cv::Vec3d;

namespace {

//! What follows each line of '#', by the line's words as far as its colon.
typedef std::map<std::string, std::string> Sections;

Sections sectionsOf(const std::string& text)
{
    Sections sections;
    std::istringstream in(text);
    std::string name;
    for (std::string line; takeLine(in, line); )
        if (line.compare(0, 1, "#") == 0)
        {
            name = line.substr(0, line.find(':'));
            name.erase(0, name.find_first_not_of("# "));
        }
        else
            sections[name] += line + "\n";
    return sections;
}

const std::string& textOf(const Sections& file, const std::string& name)
{
    if (!file.count(name))
        throw Failure("'# " + name + ":' is missing; is it cut short?");
    return file.at(name);
}

//! @param count 0: any
std::vector<double> numbersOf(const Sections& file, const std::string& name, size_t count)
{
    bool all;
    const std::vector<double> numbers = leadingNumbers(textOf(file, name), &all);
    if (!all || (count > 0 && numbers.size() != count))
        throw Failure("'# " + name + ":' must be followed by " + (count ? std::to_string(count) + " numbers" : "numbers"));
    return numbers;
}

//! @param R, t the world to the camera
cv::refract::GlassWindow windowOf(const Sections& file, const Matx33d& R, const Vec3d& t)
{
    const Vec3d face = R*Vec3d(numbersOf(file, "Reference Point of Refractive Plate", 3).data()) + t;
    const Vec3d normal = normalize(R*Vec3d(numbersOf(file, "Normal Vector of Refractive Plate", 3).data()));
    const std::vector<double> index = numbersOf(file, "Refractive Index Array", 0);
    const std::vector<double> width = numbersOf(file, "Width of the Refractive Plate", 0);
    if (index.size() != width.size() + 2)
        throw Failure("it must have two indices more than plates: of the scene, of each plate, and of the air");
    cv::refract::GlassWindow window;
    window.normal = normal;
    window.distance = normal.dot(face);
    for (double w : width)
        window.distance -= w;
    window.thickness.assign(width.rbegin(), width.rend());
    window.index.assign(index.rbegin() + 1, index.rend() - 1);
    window.innerIndex = index.back();
    window.outerIndex = index.front();
    return window;
}

} // namespace

bool isOpenLpt(const ForeignFile& file) { return file.bytes.substr(0, 200).find("# Camera Model:") != std::string::npos; }

ForeignRig readOpenLpt(const ForeignFile& file)
{
    const Sections sections = sectionsOf(file.bytes);
    std::string model;
    std::istringstream(textOf(sections, "Camera Model")) >> model;
    if (model != "PINHOLE" && model != "PINPLATE")
        throw Failure("its model " + model + " has no equal among OpenCV's: PINHOLE and PINPLATE have");
    const std::vector<double> rowsColumns = numbersOf(sections, "Image Size", 2);
    Matx33d K(numbersOf(sections, "Camera Matrix", 9).data());
    const double up = K(1, 1) < 0 ? -1. : 1.;
    const Matx33d axes(1, 0, 0, 0, up, 0, 0, 0, 1);
    K(1, 1) *= up;
    std::vector<double> D = numbersOf(sections, "Distortion Coefficients", 0);
    if (D.size() > 2)
        D[2] *= up;                 // p1 bends along y
    if (D.size() > 8 && up < 0)
        throw Failure("its y axis points up, and its lens has more than eight coefficients: the mirror image of that is not made here");
    const Matx33d R = axes*Matx33d(numbersOf(sections, "Rotation Matrix", 9).data());
    const Vec3d t = axes*Vec3d(numbersOf(sections, "Translation Vector", 3).data());
    const auto camera = makeCamera("opencv", K, D, imageSizeOf(rowsColumns[1], rowsColumns[0]));
    if (model == "PINPLATE")
        possible("plate", [&] { camera->setWindow(windowOf(sections, R, t)); });
    ForeignRig rig;
    rig.add(camera, R, t);
    return rig;
}

} // namespace tools
