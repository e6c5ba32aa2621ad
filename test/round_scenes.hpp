// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Rigs in domes and tubes: what is true of them, what a user knows, and calibrations that begin with the centre at the camera.
#ifndef REFRACT_TEST_ROUND_SCENES_HPP
#define REFRACT_TEST_ROUND_SCENES_HPP

#include "problem_scenes.hpp"
#include "target_scenes.hpp"
#include "window/parameters.hpp"
#include "window/wedge.hpp"

namespace scenes {

const int LENS_PARAMETERS = 8;      //!< of paperCamera(), before those of its window

inline GlassWindow domeAt(const cv::Vec3d& center, double outerIndex) { return GlassWindow::dome(center, 70, 7, 1.49, outerIndex); }

inline GlassWindow tubeAt(const cv::Vec3d& center, double outerIndex)
{
    return GlassWindow::tube(center, cv::Vec3d(0.05, 1, 0.03), 70, 7, 1.49, outerIndex);
}

typedef GlassWindow (*MakeWindow)(const cv::Vec3d& center, double outerIndex);

//! Cameras as makeRig's, each in a window of its own, or all in that of the first.
inline RigTruth roundRig(MakeWindow make, int count, bool shared, double outerIndex, const cv::Vec3d& center, Random& random,
                         double apart = 0.2)
{
    std::vector<int> windows(count, 0);
    for (int c = 0; c < count && !shared; c++)
        windows[c] = c;
    RigTruth truth = makeRig(count, windows, outerIndex, apart);
    for (int c = 0; c < count; c++)
        truth.cameras[c]->setWindow(c == 0 ? make(center, outerIndex) :
            shared ? windowInFrame(truth.cameras[0]->window(), truth.Rs[c], truth.Ts[c]) : make(center + random.vector(4), outerIndex));
    return truth;
}

//! The centres begin at the cameras, axes upright in the image; all else is what the rig says.
inline RigCall callFromCentre(const RigTruth& rig, const RigScene& scene, bool paired)
{
    RigCall call(rig, scene, paired);
    for (size_t c = 0; c < call.cameras.size(); c++)
    {
        GlassWindow window = rig.cameras[c]->window();
        window.center = cv::Vec3d();
        if (window.shape == cv::refract::WINDOW_TUBE)
            window.axis = cv::Vec3d(0, 1, 0);
        call.cameras[c]->setWindow(window);
    }
    return call;
}

//! Rows of a covariance that hold a window's place, of the camera before which so many parameters stand: a center; of a tube its axis.
inline std::vector<int> placeRows(const GlassWindow& window, int before = 0)
{
    const cv::refract::WindowLayout at = cv::refract::windowLayout(window);
    std::vector<int> rows;
    for (int i = at.normal; i < (at.shape == cv::refract::WINDOW_TUBE ? at.axis : at.normal) + 3; i++)
        rows.push_back(before + LENS_PARAMETERS + i);
    return rows;
}

//! Degrees of freedom of a place.
inline int freedomOfPlace(const GlassWindow& window) { return window.shape == cv::refract::WINDOW_TUBE ? 4 : 3; }

//! How far off a centre is, or an axis passes the point given of the true one, mm; the angle between axes, radians.
inline cv::Vec2d placeErrors(const RigCall& call, const RigTruth& truth, int c = 0)
{
    const GlassWindow found = call.cameras[c]->window(), exact = truth.cameras[c]->window();
    const cv::Vec3d off = found.center - exact.center;
    if (found.shape != cv::refract::WINDOW_TUBE)
        return { norm(off), 0 };
    return { norm(off.cross(found.axis)), std::asin(norm(found.axis.cross(exact.axis))) };
}

//! What was found less what is true, of all parameters of a window; a tube's center is where its axis is nearest to the camera.
inline std::vector<double> windowErrors(const GlassWindow& found, GlassWindow exact)
{
    if (exact.shape == cv::refract::WINDOW_TUBE)
        exact.center -= exact.axis.dot(exact.center)*exact.axis;
    std::vector<double> errors = cv::refract::windowParameters(found);
    const std::vector<double> truth = cv::refract::windowParameters(exact);
    for (size_t i = 0; i < errors.size(); i++)
        errors[i] -= truth[i];
    return errors;
}

//! Of these rows: e^T C^+ e.
inline double overStated(const std::vector<double>& errors, const cv::Mat& covariance, const std::vector<int>& rows, int before = 0)
{
    std::vector<double> picked;
    for (int row : rows)
        picked.push_back(errors[row - before - LENS_PARAMETERS]);
    return squaredMahalanobis(picked, covariance, rows);
}

//! Information that images without noise have on a camera's window, for pixels of standard deviation 1: all else known, poses not.
inline cv::Mat placeInformation(const CalibrationScene& perfect, bool paired, const cv::Ptr<RefractiveCamera>& camera)
{
    cv::Ptr<RefractiveCamera> found = camera->clone();
    cv::Mat jacobian;
    cv::refract::calibrateGlass(perfect.object, paired ? perfect.direct : PixelViews(), perfect.refracted, found, cv::noArray(),
                                cv::noArray(), cv::noArray(), cv::noArray(), cv::noArray(), jacobian, 0);
    const int points = (int)perfect.object[0].size(), rows = 2*points*(paired ? 2 : 1);
    const std::vector<int> columns = placeRows(camera->window());
    const int count = (int)columns.size(), poses = LENS_PARAMETERS + cv::refract::windowLayout(camera->window()).count;
    cv::Mat information = cv::Mat::zeros(count, count, CV_64F);
    for (int view = 0; view < (int)perfect.object.size(); view++)
    {
        const cv::Mat ofView = jacobian.rowRange(view*rows, (view + 1)*rows), J = ofView.colRange(columns[0], columns[0] + count);
        const cv::Mat K = ofView.colRange(poses + 6*view, poses + 6*view + 6);
        cv::Mat fit;
        cv::solve(K, J, fit, cv::DECOMP_QR);
        information += J.t()*(J - K*fit);
    }
    return information;
}

//! Standard deviations of what is known of a round window; mm. Of its targets: see targetCovariance().
struct Given
{
    double radius = 0.3, thickness = 0.1, index = 0.002, outerIndex = 0.001;
    double scale = 2e-4, rotation = 3e-4, translation = 0.03;
    double tilt = 0.03;         //!< radians; of a tube's axis, which is only a start
};

inline GlassWindow drawn(GlassWindow window, const Given& given, Random& random)
{
    window.radius += random.normal(given.radius);
    window.thickness[0] += random.normal(given.thickness);
    window.index[0] += random.normal(given.index);
    window.outerIndex += window.outerIndex > 1 ? random.normal(given.outerIndex) : 0;
    if (window.shape == cv::refract::WINDOW_TUBE)
        window.axis = cv::normalize(window.axis + cv::Vec3d(random.normal(given.tilt), 0, random.normal(given.tilt)));
    return window;
}

inline cv::Mat priorOf(const GlassWindow& window, const Given& given)
{
    const cv::refract::WindowLayout at = cv::refract::windowLayout(window);
    cv::Mat covariance = cv::Mat::diag(cv::Mat(LENS_PARAMETERS + at.count, 1, CV_64F, cv::Scalar(NaN)));
    const auto set = [&](int i, double sigma) { covariance.at<double>(LENS_PARAMETERS + i, LENS_PARAMETERS + i) = sigma*sigma; };
    set(at.distance, given.radius);
    set(at.thickness, given.thickness);
    set(at.index, given.index);
    if (window.outerIndex > 1)
        set(at.outerIndex, given.outerIndex);
    return covariance;
}

//! Mean squares over what is stated, per degree of freedom.
struct RoundTrial
{
    double ofPlace, ofWindow, ofLast;       //!< of the first window; the place of the last camera's in the frame of that camera
};

inline RoundTrial runRoundTrial(MakeWindow make, const Flow& flow, const Given& given, int seedOfTrial)
{
    Random random(seedOfTrial);
    const RigTruth nominal = roundRig(make, flow.cameras, flow.shared, flow.outerIndex, cv::Vec3d(5, -4, 9) + random.vector(3), random,
                                      flow.shared ? 0.02 : 0.2);
    RigTruth truth = nominal;
    for (int c = 0; c < flow.cameras; c++)
    {
        truth.cameras[c] = nominal.cameras[c]->clone();
        truth.cameras[c]->setWindow(c > 0 && flow.shared ? windowInFrame(truth.cameras[0]->window(), truth.Rs[c], truth.Ts[c])
                                                         : drawn(nominal.cameras[c]->window(), given, random));
    }
    RigScene scene = makeRigScene(truth, ObjectViews(flow.views, board()), random, 0.1, 400, 800);
    imageTargets(truth, drawTargets(random, given.scale, given.rotation, given.translation), random, 0.1, scene);
    RigCall call = callFromCentre(nominal, scene, flow.paired);
    std::vector<cv::Mat> priors;
    for (const cv::Ptr<RefractiveCamera>& camera : call.cameras)
        priors.push_back(priorOf(camera->window(), given));
    call.run(flow.flags, priors, targetCovariance(given.scale, given.rotation, given.translation));
    const GlassWindow exact = truth.cameras[0]->window();
    const std::vector<double> ofFirst = windowErrors(call.cameras[0]->window(), exact);
    std::vector<int> rows;
    for (int i = 0; i < (int)ofFirst.size(); i++)
        if (call.stdDeviations.at<double>(LENS_PARAMETERS + i) > 0)
            rows.push_back(LENS_PARAMETERS + i);
    const std::vector<int> place = placeRows(exact);
    const int freedom = freedomOfPlace(exact), others = (int)(rows.size() - place.size());
    const int last = flow.cameras - 1, before = last*(LENS_PARAMETERS + (int)ofFirst.size());
    return { overStated(ofFirst, call.covariance, place)/freedom,
             overStated(ofFirst, call.covariance, rows)/(freedom + others),
             overStated(windowErrors(call.cameras[last]->window(), truth.cameras[last]->window()), call.covariance,
                        placeRows(exact, before), before)/freedom };
}

} // namespace scenes

#endif // REFRACT_TEST_ROUND_SCENES_HPP
