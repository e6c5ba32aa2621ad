// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/emitter_prior.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/rigid_transform.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include "window/parameters.hpp"
#include <opencv2/core/persistence.hpp>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int POSE = 6;
const double LEAST = 1e-12, MOST_DEGREES = 45., MOST = 1e9;

//! Lens and window in the order of the camera's parameters.
VectorXd parametersOf(const RefractiveCamera& camera)
{
    std::vector<double> q = camera.lensParameters();
    const std::vector<double> window = windowParameters(camera.window());
    q.insert(q.end(), window.begin(), window.end());
    return VectorXd::Map(q.data(), q.size());
}

Ptr<RefractiveCamera> withWindow(const RefractiveCamera& camera, const VectorXd& q)
{
    GlassWindow w = withParameters(camera.window(), q.data() + columnsOf(camera).window);
    w.distance = std::max(w.distance, 0.);
    const Ptr<RefractiveCamera> moved = copyWithWindow(camera.clone(), w);
    moved->setImageSize(camera.imageSize());
    return moved;
}

} // namespace

EmitterPrior::EmitterPrior(const std::string& filename) : filename_(filename)
{
    const FileStorage fs = openDescription(filename, "the emitter: camera_matrix, distortion_coefficients, glass_window, rvec, tvec, line, "
                                                     "rotation_std_deg, position_std");
    const Keys keys(fs.root(), "'" + filename + "'");
    std::vector<std::string> known = emitterKeys();
    known.insert(known.end(), {"rotation_std_deg", "position_std", "glass_window_std"});
    keys.allowOnly(known);
    emitter_ = readEmitter(fs.root(), keys.name(), true);
    basis_ = MatrixXd::Zero(POSE + columnsOf(*emitter_.camera).end, 0);
    const double rotation = keys.number("rotation_std_deg", LEAST, MOST_DEGREES)*CV_PI/180;
    const double position = keys.number("position_std", LEAST, MOST);
    for (int i = 0; i < POSE; i++)
        free({1.}, i, i < 3 ? rotation : position);
    if (keys.has("glass_window_std"))
        addWindow(Keys(fs["glass_window_std"], keys.name() + ", glass_window_std"));
}

void EmitterPrior::free(const std::vector<double>& direction, int first, double std)
{
    if (!(std > 0.))
        return;
    basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
    basis_.rightCols(1).setZero();
    for (size_t i = 0; i < direction.size(); i++)
        basis_(first + (int)i, basis_.cols() - 1) = std*direction[i];
}

void EmitterPrior::addWindow(const Keys& keys)
{
    keys.allowOnly({"normal_deg", "distance", "thickness", "index", "outer_index"});
    const ParameterColumns at = columnsOf(*emitter_.camera);
    if (!at.has(at.normal))
        throw Failure(keys.name() + ": the emitter is in a " + nameOfShape(emitter_.camera->window()) + ", and only what is known of flat "
                      "windows can be told here. Leave glass_window_std out: the window is then exact");
    const Matx32d across = tangents(emitter_.camera->window().normal);
    const auto one = [&](const char* key) { return keys.number(key, 0., MOST, 0.); };
    if (keys.has("normal_deg"))
    {
        const std::vector<double> degrees = keys.numbers("normal_deg", 2);
        for (int k = 0; k < 2; k++)
            free({across(0, k), across(1, k), across(2, k)}, POSE + at.normal, degrees[k]*CV_PI/180);
    }
    free({1.}, POSE + at.distance, one("distance"));
    for (const char* key : {"thickness", "index"})
        if (keys.has(key))
        {
            const std::vector<double> stds = keys.numbers(key, at.layers);
            for (int i = 0; i < at.layers; i++)
                free({1.}, POSE + (key[0] == 't' ? at.thickness : at.index) + i, stds[i]);
        }
    free({1.}, POSE + at.outerIndex, one("outer_index"));
}

VectorXd EmitterPrior::deviation(const Emitter& other) const
{
    VectorXd difference(basis_.rows());
    const Vec3d r = rotationVector(other.R*emitter_.R.t()), c = other.position - emitter_.position;
    difference << r[0], r[1], r[2], c[0], c[1], c[2], parametersOf(*other.camera) - parametersOf(*emitter_.camera);
    return PivotedQR(basis_).solve(difference);
}

Emitter EmitterPrior::moved(const Emitter& from, const VectorXd& step) const
{
    const VectorXd by = timesVector(basis_, step);
    Emitter result = from;
    result.R = rotationMatrix(Vec3d(by[0], by[1], by[2]))*from.R;
    result.position += Vec3d(by[3], by[4], by[5]);
    result.camera = withWindow(*from.camera, parametersOf(*from.camera) + by.tail(by.size() - POSE));
    return result;
}

} // namespace tools
