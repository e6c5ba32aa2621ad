// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"
#include "formats/foreign_file.hpp"
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

/* OpenPTV's cameras look along -z, their image's y points up, and lengths in the image are millimetres from its middle:

    q = dm^T (X - X0),  x = -c q0/q2 + xh,  y = -c q1/q2 + yh,
    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 x^2) + 2 p2 x y,  y' likewise from x' and y,
    column = (scx x' - sin(she) y')/pix_x + imx/2,  row = imy/2 - cos(she) y'/pix_y,

where pixels count from the corner of the first. Distortion is about the middle of the image, not about (xh, yh): OpenCV's model is the
same where one of both is 0. The glass is a vector from the origin of the world to the outer face of the window, square to it. */

namespace tools {

using cv::Matx33d;
using cv::Vec3d;

namespace {

namespace fs = std::filesystem;

const double CORNER = 0.5;      // its pixel (0, 0) is a corner, not a centre
const size_t WITHOUT_GLASS = 18, WITH_GLASS = 21;

bool isRotation(const Matx33d& R) { return cv::norm(R*R.t() - Matx33d::eye()) < 1e-3 && cv::determinant(R) > 0; }

struct AddedParameters
{
    double k1, k2, k3, p1, p2, scx, she;
};

AddedParameters readAdded(const fs::path& ori)
{
    const fs::path path = (ori.extension() == ".ori" ? fs::path(ori).replace_extension() : ori).string() + ".addpar";
    if (!fs::is_regular_file(path))
        throw Failure("its lens is missing: put '" + path.filename().string() + "' beside it (k1 k2 k3 p1 p2 scx she)");
    const std::vector<double> p = leadingNumbers(contentsOf(path.string()).bytes);
    if (p.size() < 7)
        throw Failure("'" + path.filename().string() + "' must have the numbers k1 k2 k3 p1 p2 scx she");
    return {p[0], p[1], p[2], p[3], p[4], p[5], p[6]};
}

//! What all cameras share.
struct ControlParameters
{
    cv::Size image;
    double pixelX, pixelY, n1, n2, n3, thickness;
};

//! ptv.par: images of each camera by name, then a number a line; the last are of the sizes and the window.
ControlParameters readControl(const fs::path& folder)
{
    for (const fs::path& path : {folder/"ptv.par", folder/".."/"parameters"/"ptv.par", folder/"parameters"/"ptv.par"})
    {
        if (!fs::is_regular_file(path))
            continue;
        std::istringstream in(contentsOf(path.string()).bytes);
        std::string line, rest;
        takeLine(in, line);
        const std::vector<double> count = leadingNumbers(line);
        for (int name = 0; count.size() == 1 && name < 2*count[0] && count[0] <= 100; name++)
            takeLine(in, line);
        while (takeLine(in, line))
            rest += line + "\n";
        // hp_flag allCam_flag tiff_flag imx imy pix_x pix_y chfield mmp_n1 mmp_n2 mmp_n3 mmp_d
        const std::vector<double> p = leadingNumbers(rest);
        if (p.size() < 12 || !(p[5] > 0 && p[6] > 0))
            throw Failure("'" + path.filename().string() + "' must have 12 numbers after the names of the images, imx, imy, pix_x and "
                          "pix_y among them");
        if (p[7] != 0)
            throw Failure("chfield of ptv.par is not 0: the halves of interlaced images are no image here");
        return {imageSizeOf(p[3], p[4]), p[5], p[6], p[8], p[9], p[10], p[11]};
    }
    throw Failure("it is in millimetres: put ptv.par, which has the size of the image and of a pixel, beside it or into ../parameters");
}

std::vector<double> coefficientsOf(const AddedParameters& a, double c, double xh, double yh)
{
    if (a.she != 0)
        throw Failure("its lens has a shear (she), and OpenCV's has none: set she to 0 and orient again");
    const bool bends = a.k1 != 0 || a.k2 != 0 || a.k3 != 0 || a.p1 != 0 || a.p2 != 0;
    if (bends && (xh != 0 || yh != 0))
        throw Failure("its distortion is about the middle of the image, and its principal point (xh, yh) is elsewhere, which OpenCV's lens "
                      "cannot be: orient again with one of both at 0");
    if (a.p1 != 0)
        throw Failure("its p1 is not as in OpenCV's lens (y is distorted by the distorted x): set it to 0 and orient again");
    return {a.k1*c*c, a.k2*std::pow(c, 4), -a.p2*c, 0., a.k3*std::pow(c, 6)};
}

} // namespace

bool isOpenPtv(const ForeignFile& file)
{
    bool all;
    const std::vector<double> p = leadingNumbers(file.bytes.substr(0, 4096), &all);
    return all && p.size() >= 15 && isRotation(Matx33d(p.data() + 6));
}

ForeignRig readOpenPtv(const ForeignFile& file)
{
    const std::vector<double> p = leadingNumbers(file.bytes);
    if (p.size() != WITHOUT_GLASS && p.size() != WITH_GLASS)
        throw Failure(cv::format("it must have 18 numbers, or 21 with the vector of the glass, and has %zu: is it cut short?", p.size()));
    const fs::path folder = fs::path(file.name).parent_path();
    const AddedParameters added = readAdded(file.name);
    const ControlParameters control = readControl(folder.empty() ? "." : folder);
    const double xh = p[15], yh = p[16], c = p[17];
    const Vec3d centre(p[0], p[1], p[2]);
    const Matx33d R = Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1)*Matx33d(p.data() + 6).t();
    const Matx33d K = cameraMatrixOf(added.scx*c/control.pixelX, c/control.pixelY, control.image.width/2. + added.scx*xh/control.pixelX
                                     - CORNER, control.image.height/2. - yh/control.pixelY - CORNER);
    const auto camera = makeCamera("opencv", K, coefficientsOf(added, c, xh, yh), control.image);
    const Vec3d glass = p.size() == WITH_GLASS ? Vec3d(p[18], p[19], p[20]) : Vec3d();
    const double toOrigin = cv::norm(glass);
    if (toOrigin > 0)
        possible("glass", [&] {
            const Vec3d n = glass*(1./toOrigin);
            cv::refract::GlassWindow window(-(R*n), control.thickness, control.n2, n.dot(centre) - toOrigin - control.thickness,
                                            control.n3);
            window.innerIndex = control.n1;
            camera->setWindow(window);
        });
    ForeignRig rig;
    rig.add(camera, R, -(R*centre));
    return rig;
}

/* OpenLPT: a line of '#' says what follows. PINPLATE is a pinhole behind plates: a point of the outermost face and the normal from the
camera to the scene, in the frame of the world; indices and widths from the scene to the camera. A focal length below 0 is a y axis
that points up: then the camera's frame here is the mirror image of theirs, for all cameras alike. */

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
