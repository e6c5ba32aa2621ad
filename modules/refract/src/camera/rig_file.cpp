// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/extrinsics.hpp"
#include "camera/camera.hpp"
#include "camera/cameramodel.hpp"
#include "camera/storage.hpp"
#include "math/covariance_matrix.hpp"
#include "math/rotation.hpp"
#include <fstream>

/* All cameras of a rig <-> one file: camera1, camera2, ... with R, T, R3, T3, ... beside them; one camera is at the top level.
Of mrcal, each camera has a file of its own, which says where it is in a frame that all share. */

namespace cv { namespace refract {

namespace {

const String CAMERA = "camera";

//! Cameras count from 1; `R` and `T` alone are those of camera 2.
String cameraKey(int number) { return CAMERA + std::to_string(number); }
String placeKey(const char* letter, int number) { return number == 2 ? String(letter) : letter + std::to_string(number); }

//! What goes wrong in `read` is told with the file's name and the part of it.
template<typename Read>
auto inFile(const String& filename, const String& part, const Read& read) -> decltype(read())
{
    try
    {
        return read();
    }
    catch (const Exception& e)
    {
        if (e.err.find(filename) != String::npos)
            throw;
        CV_Error_(e.code, ("%s, %s: %s", filename.c_str(), part.c_str(), e.err.c_str()));
    }
}

//! The number of a key that calls itself a camera, else 0.
int numberOf(const String& key)
{
    const bool isNumbered = key.size() > CAMERA.size() && key.size() < CAMERA.size() + 6 && key.compare(0, CAMERA.size(), CAMERA) == 0
                            && key.find_first_not_of("0123456789", CAMERA.size()) == String::npos;
    return isNumbered ? std::stoi(key.substr(CAMERA.size())) : 0;
}

//! camera1 ... cameraN; 0: the file has one, at its top level. A gap would leave out what comes after it.
int countCameras(const FileNode& root, const String& filename)
{
    int count = 0;
    while (!root[cameraKey(count + 1)].empty())
        count++;
    for (const FileNode& node : root)
        if (numberOf(node.name()) > count)
            CV_Error_(Error::StsParseError, ("%s has %s, but no camera%d", filename.c_str(), node.name().c_str(), count + 1));
    return count;
}

Mat readNeeded(const FileNode& root, const String& key, int number, const String& filename)
{
    const Mat m = readStoredMatrix(root, key.c_str(), filename);
    if (m.empty())
        CV_Error_(Error::StsParseError, ("%s has camera%d, but no %s, which is part of its pose", filename.c_str(), number, key.c_str()));
    return m;
}

RigidTransform readPlace(const FileNode& root, int number, const String& filename)
{
    RigidTransform place;
    const String R = placeKey("R", number), T = placeKey("T", number);
    place.R = inFile(filename, cameraKey(number), [&]
    { return readRotation(readNeeded(root, R, number, filename), R.c_str()); });
    place.t = inFile(filename, cameraKey(number), [&]
    { return readVec3(readNeeded(root, T, number, filename), T.c_str()); });
    return place;
}

//! Equal numbers share a window; empty where the file does not say.
std::vector<int> readWindows(const FileNode& root, size_t cameras, const String& filename)
{
    const FileNode node = root["window_of_camera"];
    std::vector<int> windows;
    if (node.isInt())       // in XML one number is no sequence
        windows.push_back((int)node);
    for (const FileNode& number : node.isSeq() ? node : FileNode())
        if (number.isInt())
            windows.push_back((int)number);
    if (!node.empty() && (windows.size() != cameras || (node.isSeq() && node.size() != cameras)))
        CV_Error_(Error::StsParseError, ("%s: window_of_camera must have one whole number for each of %d cameras",
                                         filename.c_str(), (int)cameras));
    return windows;
}

int parametersOf(const std::vector<Ptr<RefractiveCamera> >& cameras)
{
    int count = 6*((int)cameras.size() - 1);
    for (const Ptr<RefractiveCamera>& camera : cameras)
        count += cameraOf(camera).parameterCount();
    return count;
}

//! Throws unless a covariance, if there is one, is that of these cameras; `where` begins the text.
void checkRigCovariance(const Mat& C, const std::vector<Ptr<RefractiveCamera> >& cameras, const String& where)
{
    const int count = parametersOf(cameras);
    if (C.empty())
        return;
    if (C.size() != Size(count, count))
        CV_Error_(Error::StsBadSize, ("%scovariance is %dx%d; the cameras have %d parameters", where.c_str(), C.rows, C.cols,
                                      count));
    checkCovariance(C, where + "covariance");
}

//! The name of a numbered file, "camera-%d.cameramodel"; any other is that of all numbers.
String numberedFile(String filename, int number)
{
    const size_t at = filename.find("%d");
    return at == String::npos ? filename : filename.replace(at, 2, std::to_string(number));
}

bool isNumbered(const String& filename) { return numberedFile(filename, 0) != filename; }

bool isThere(const String& filename) { return std::ifstream(filename.c_str()).good(); }

//! Numbers begin with 0, as mrcal's do, or 1.
void readCameraModels(const String& filename, std::vector<Ptr<RefractiveCamera> >& cameras, std::vector<RigidTransform>& places)
{
    RigidTransform first;
    for (int number = isThere(numberedFile(filename, 0)) ? 0 : 1; ; number++)
    {
        const String file = numberedFile(filename, number);
        if (!cameras.empty() && (!isNumbered(filename) || !isThere(file)))
            break;
        const CameraModel model = readCameraModel(file);
        RigidTransform place;
        place.R = rotationMatrix(model.rvec);
        place.t = model.tvec;
        if (cameras.empty())
            first = place;
        place.R = place.R*first.R.t();
        place.t -= place.R*first.t;
        cameras.push_back(inFile(file, "lens", [&] { return cameraFrom(model); }));
        places.push_back(place);
    }
    places[0] = RigidTransform();
}

void writeCameraModels(const String& filename, const std::vector<Ptr<RefractiveCamera> >& cameras,
                       const std::vector<RigidTransform>& places)
{
    if (cameras.size() > 1 && !isNumbered(filename))
        CV_Error_(Error::StsBadArg, ("%s: a .cameramodel is of one camera; of %d, give a numbered name, as in camera-%%d.cameramodel",
                                     filename.c_str(), (int)cameras.size()));
    std::vector<CameraModel> models;
    for (size_t c = 0; c < cameras.size(); c++)
    {
        models.push_back(cameraModelOf(*cameras[c], numberedFile(filename, (int)c)));
        models[c].rvec = rotationVector(places[c].R);
        models[c].tvec = places[c].t;
    }
    for (size_t c = 0; c < models.size(); c++)
        saveCameraModel(numberedFile(filename, (int)c), models[c]);
}

//! windowOfCamera and covariance may be null.
void read(const String& filename, std::vector<Ptr<RefractiveCamera> >& cameras, OutputArrayOfArrays Rs, OutputArrayOfArrays Ts,
          std::vector<int>* windowOfCamera, Mat* covariance)
{
    std::vector<Ptr<RefractiveCamera> > found;
    std::vector<RigidTransform> places;
    const FileStorage fs = isCameraModel(filename) ? FileStorage() : openStorage(filename);
    const FileNode root = fs.isOpened() && fs.root().isMap() ? fs.root() : FileNode();
    const int count = countCameras(root, filename);
    if (isCameraModel(filename))
        readCameraModels(filename, found, places);
    else if (count == 0)
        found.push_back(inFile(filename, "top level", [&] { return RefractiveCamera::read(filename); }));
    places.resize(std::max(places.size(), (size_t)1));
    for (int number = 1; number <= count; number++)
    {
        found.push_back(inFile(filename, cameraKey(number), [&] { return RefractiveCamera::read(root[cameraKey(number)]); }));
        if (number > 1)
            places.push_back(readPlace(root, number, filename));
    }
    std::vector<int> windows;
    if (windowOfCamera)
        windows = readWindows(root, found.size(), filename);
    if (covariance)
    {
        *covariance = readStoredMatrix(root, "covariance", filename);
        checkRigCovariance(*covariance, found, filename + ": ");
    }
    writeExtrinsics(places, Rs, Ts);        // all or nothing: what may be refused comes first
    cameras = found;
    if (windowOfCamera)
        *windowOfCamera = windows;
}

} // namespace

void readRig(const String& filename, std::vector<Ptr<RefractiveCamera> >& cameras, OutputArrayOfArrays Rs, OutputArrayOfArrays Ts)
{
    CV_INSTRUMENT_REGION();

    read(filename, cameras, Rs, Ts, NULL, NULL);
}

void readRig(const String& filename, std::vector<Ptr<RefractiveCamera> >& cameras, OutputArrayOfArrays Rs, OutputArrayOfArrays Ts,
             std::vector<int>& windowOfCamera, OutputArray covariance)
{
    CV_INSTRUMENT_REGION();

    Mat C;
    read(filename, cameras, Rs, Ts, &windowOfCamera, &C);
    if (covariance.needed())
        C.copyTo(covariance);
}

void writeRig(const String& filename, const std::vector<Ptr<RefractiveCamera> >& cameras, InputArrayOfArrays Rs,
              InputArrayOfArrays Ts, const std::vector<int>& windowOfCamera, InputArray covariance)
{
    CV_INSTRUMENT_REGION();

    const int count = (int)cameras.size();
    if (count == 0)
        CV_Error(Error::StsBadArg, "cameras is empty; a rig has one or more");
    for (int c = 0; c < count; c++)
        cameraOf(cameras[c], numbered("cameras", c).c_str());
    const std::vector<RigidTransform> places = readExtrinsics(Rs, Ts, count);
    if (!windowOfCamera.empty() && (int)windowOfCamera.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("windowOfCamera has %d elements; cameras has %d", (int)windowOfCamera.size(), count));
    Mat C;
    covariance.getMat().convertTo(C, CV_64F);
    checkRigCovariance(C, cameras, "");
    if (isCameraModel(filename) && !C.empty())
        CV_Error_(Error::StsBadArg, ("%s: a .cameramodel cannot state a covariance; leave it out, or save the rig as YAML",
                                     filename.c_str()));
    if (isCameraModel(filename))
        return writeCameraModels(filename, cameras, places);
    saveStorage(filename, [&](FileStorage& fs)
    {
        if (count == 1)
            cameras[0]->write(fs);
        for (int c = 0; c < count && count > 1; c++)
        {
            fs << cameraKey(c + 1) << "{";
            cameras[c]->write(fs);
            fs << "}";
        }
        for (int c = 1; c < count; c++)
            fs << placeKey("R", c + 1) << Mat(places[c].R) << placeKey("T", c + 1) << Mat(places[c].t);
        if (!windowOfCamera.empty())
            fs << "window_of_camera" << windowOfCamera;
        if (!C.empty())
            fs << "covariance" << C;
    });
}

}} // namespace
