// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"

// Classes: a camera and a window asked and changed, written to a file in memory and read again.

using namespace cv::refract;
using namespace fuzz;

namespace {

GlassWindow written(const GlassWindow& window, int format)
{
    cv::FileStorage out(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | format);
    out << "glass_window";
    window.write(out);
    cv::FileStorage in(out.releaseAndGetString(), cv::FileStorage::READ | cv::FileStorage::MEMORY);
    GlassWindow result;
    read(in["glass_window"], result);
    return result;
}

} // namespace

void fuzz::tryInput(Bytes& bytes)
{
    const cv::Ptr<RefractiveCamera> camera = cameraOf(bytes);
    if (!camera)
        return;
    static const int formats[] = {cv::FileStorage::FORMAT_YAML, cv::FileStorage::FORMAT_XML, cv::FileStorage::FORMAT_JSON};
    const GlassWindow window = camera->window();
    window.check();
    const GlassWindow copy = written(window, formats[bytes.below(3)]);
    promise(copy.thickness == window.thickness && copy.index == window.index && copy.distance == window.distance
            && copy.innerIndex == window.innerIndex && copy.outerIndex == window.outerIndex, "a window that is read is what was written");

    const cv::Mat parameters = camera->lensParameters();
    promise(cv::checkRange(camera->cameraMatrix()) && cv::checkRange(parameters), "a camera's numbers are finite");
    camera->setLensParameters(parameters);
    promise(cv::norm(parameters, camera->lensParameters(), cv::NORM_INF) == 0, "set what was got: nothing changes");
    camera->setImageSize(cv::Size(bytes.below(5000), bytes.below(5000)));
    const int n = bytes.rarely() ? bytes.below(30) : (int)parameters.total();
    const Input others = Input::matrix(bytes, n, 1, [&](int i, int) {
        return i < (int)parameters.total() && !bytes.rarely() ? parameters.at<double>(i) : bytes.number(); });
    try
    {
        camera->setLensParameters(others);
    }
    catch (const cv::Exception&)
    {
        promise(cv::norm(parameters, camera->lensParameters(), cv::NORM_INF) == 0, "what is refused changes nothing");
    }
    const GlassWindow other = windowOf(bytes);
    camera->setWindow(other);
    const Input points = pixels(bytes, countOf(bytes));
    cv::Mat origins, directions, status;
    refractiveUnprojectPoints(points, origins, directions, camera, status);
    checkAnswer(directions, status);
}
