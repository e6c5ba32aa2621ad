// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "camera/cameramodel.hpp"
#include "camera/storage.hpp"

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

static String lensModelIn(const FileNode& node, const String& filename)
{
    if (!node["lens_model"].empty())
        return (String)node["lens_model"];
    const FileNode ofRos = node["distortion_model"], ofSample = node["fisheye_model"];      // that of OpenCV, camera_calibration
    if (ofRos.empty())
        return ofSample.isInt() && (int)ofSample != 0 ? "fisheye" : "opencv";
    const String model = ofRos.isString() ? lensModelCalled((String)ofRos) : String();
    if (model.empty())
        CV_Error_(Error::StsParseError, ("%s: OpenCV has no lens for its distortion_model; it has for plumb_bob, rational_polynomial and "
                                         "equidistant", filename.c_str()));
    return model;
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
    const Ptr<Lens> lens = readLens(lensModelIn(node, filename), K, D, "camera_matrix", "distortion_coefficients");
    Ptr<RefractiveCamera> camera = makePtr<Camera>(lens, window);
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

    if (isCameraModel(filename))
        return cameraFrom(readCameraModel(filename));
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

void RefractiveCamera::save(const String& filename) const
{
    CV_INSTRUMENT_REGION();

    if (!isCameraModel(filename))
        return saveStorage(filename, [this](FileStorage& fs) { write(fs); });
    saveCameraModel(filename, cameraModelOf(*this, filename));
}

}} // namespace
