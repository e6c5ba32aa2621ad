// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "camera/cameramodel.hpp"
#include "camera/storage.hpp"
#include <cstdio>
#include <fstream>
#ifdef _WIN32
#define NOMINMAX
#include <windows.h>
#else
#include <sys/stat.h>
#include <unistd.h>
#endif

/* RefractiveCamera <-> files: OpenCV's YAML/XML/JSON keys plus glass_window, and mrcal's .cameramodel. */

namespace cv { namespace refract {

void Camera::write(FileStorage& fs) const
{
    fs << "image_width" << size_.width << "image_height" << size_.height;
    fs << "camera_matrix" << cameraMatrix() << "distortion_coefficients" << distCoeffs();
    fs << "lens_model" << lensModel();
    fs << "glass_window";
    window_.write(fs);
}

static Ptr<RefractiveCamera> readNode(const FileNode& node, const String& filename)
{
    GlassWindow window;
    if (!node["glass_window"].empty())
        window.read(node["glass_window"]);
    const Mat K = readStoredMatrix(node, "camera_matrix", filename);
    const Mat D = readStoredMatrix(node, "distortion_coefficients", filename);
    if (K.empty())
        CV_Error_(Error::StsParseError, ("%s has no camera_matrix", filename.c_str()));
    const String model = node["lens_model"].empty() ? String("opencv") : (String)node["lens_model"];
    Ptr<RefractiveCamera> camera = makePtr<Camera>(makeLens(model, K, D), window);
    if (node["image_width"].isInt() && node["image_height"].isInt())
        camera->setImageSize(Size((int)node["image_width"], (int)node["image_height"]));
    return camera;
}

Ptr<RefractiveCamera> RefractiveCamera::read(const FileNode& node)
{
    CV_INSTRUMENT_REGION();

    if (!node.isMap())
        CV_Error(Error::StsBadArg, "node is not a map; it must hold camera_matrix and distortion_coefficients");
    return readNode(node, node.isNamed() ? node.name() : String("node"));
}

Ptr<RefractiveCamera> RefractiveCamera::read(const String& filename, const String& name)
{
    CV_INSTRUMENT_REGION();

    const String suffix = ".cameramodel";
    if (filename.size() > suffix.size() && filename.substr(filename.size() - suffix.size()) == suffix)
    {
        const CameraModel model = readCameraModel(filename);
        Ptr<RefractiveCamera> camera = createMrcal(model.lensModel, model.intrinsics);
        camera->setImageSize(model.imageSize);
        return camera;
    }
    const FileStorage fs = openStorage(filename);
    FileNode node = fs.root();
    if (node.isMap() && !name.empty())
        node = node[name];
    else if (node.isMap() && node["camera_matrix"].empty())
        node = node["camera1"];
    if (!node.isMap())
        CV_Error_(Error::StsParseError, ("%s holds no camera%s%s: camera_matrix and distortion_coefficients are missing",
                                         filename.c_str(), name.empty() ? "" : " ", name.c_str()));
    return readNode(node, filename);
}

//! path/name.yml -> path/name.part.yml: the extension chooses FileStorage's format.
static String partName(const String& filename)
{
    const size_t slash = filename.find_last_of("/\\"), dot = filename.rfind('.');
    const bool hasExtension = dot != String::npos && (slash == String::npos || dot > slash);
    return hasExtension ? filename.substr(0, dot) + ".part" + filename.substr(dot) : filename + ".part";
}

void RefractiveCamera::write(const Ptr<FileStorage>& fs, const String& name) const
{
    CV_INSTRUMENT_REGION();

    if (!fs || !fs->isOpened())
        CV_Error(Error::StsBadArg, "fs is not open for writing");
    if (!name.empty())
        *fs << name << "{";
    write(*fs);
    if (!name.empty())
        *fs << "}";
}

//! In one step where the system has one.
static bool moveOver(const String& from, const String& to)
{
#ifdef _WIN32
    return MoveFileExA(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
#else
    return std::rename(from.c_str(), to.c_str()) == 0;
#endif
}

//! Where links lead to: they stay, what they lead to is replaced.
static String targetOfLinks(const String& filename)
{
    String target = filename;
#ifndef _WIN32
    char next[4096];
    for (int i = 0; i < 40; i++)
    {
        const ssize_t length = readlink(target.c_str(), next, sizeof(next));
        if (length <= 0 || length == (ssize_t)sizeof(next))
            break;
        const size_t slash = next[0] == '/' ? String::npos : target.rfind('/');
        target = (slash == String::npos ? String() : target.substr(0, slash + 1)) + String(next, length);
    }
#endif
    return target;
}

//! A device or a pipe takes the bytes, and must not be replaced; a read-only file must stay, also if root asks.
static void askWhatIsThere(const String& filename, bool& special, bool& readOnly)
{
    special = readOnly = false;
#ifndef _WIN32
    struct stat there;
    if (stat(filename.c_str(), &there) != 0)
        return;
    special = !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode);
    readOnly = S_ISREG(there.st_mode) && (!(there.st_mode & 0222) || access(filename.c_str(), W_OK) != 0);
#endif
}

void RefractiveCamera::save(const String& filename) const
{
    CV_INSTRUMENT_REGION();

    bool special, readOnly;
    askWhatIsThere(filename, special, readOnly);
    const String target = targetOfLinks(filename), part = special ? filename : partName(target);
    // FileStorage would log a line of its own. A pipe is opened once: closed, it would end for its reader.
    if (readOnly || (!special && !std::ofstream(part.c_str())))
        CV_Error_(Error::StsError, ("%s cannot be written", filename.c_str()));
    FileStorage fs(part, FileStorage::WRITE);
    if (!fs.isOpened())
        CV_Error_(Error::StsError, ("%s cannot be written", filename.c_str()));
    write(fs);
    fs.release();
    if (!special && !moveOver(part, target))
    {
        std::remove(part.c_str());
        CV_Error_(Error::StsError, ("%s cannot be written", filename.c_str()));
    }
}

}} // namespace
