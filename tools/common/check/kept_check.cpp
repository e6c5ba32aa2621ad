// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/kept_check.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "history/history_page.hpp"
#include "measure/measurement.hpp"
#include "report/plot.hpp"
#include <chrono>
#include <iostream>
#include <thread>

using namespace cv::refract;

namespace tools {
namespace {

// Of an unmoved target's images no two have the same noise; a hundredth of a pixel is kept of each.
const double IDENTICAL = 0.008;

//! Waits for another check of this history; its file, FILE.lock, goes with the last of them. Throws Failure if the other takes too long.
std::unique_ptr<FileLock> lockOf(const std::string& history)
{
    const int SECONDS = 300, TRIES_A_SECOND = 10;
    for (int i = 0; i < SECONDS*TRIES_A_SECOND; i++)
    {
        if (std::unique_ptr<FileLock> lock = FileLock::tryOnce(history + ".lock"))
            return lock;
        std::this_thread::sleep_for(std::chrono::milliseconds(1000/TRIES_A_SECOND));
    }
    throw Failure("another check has kept '" + history + "' for " + std::to_string(SECONDS/60) + " minutes: wait for it, or end it");
}

} // namespace

KeptCheck::KeptCheck(const CheckOptions& options, const Calibration& calibration)
    : options_(options), calibration_(calibration), lock_(lockOf(options.history)), history_(readHistory(options.history))
{
    Plot::checkAvailable("--history");
    requireSameRig(history_, options.history, calibration, options.calibration);
    covariance_ = toEigen(withWedges(checkInputOf(calibration, options.calibration, options.sigma)).covariance);
    if (!options.date.empty())
        requirePast(options.date, "--date");
    time_ = options.date.empty() ? timeOfNow() : parseTime(options.date, "--date");
}

void KeptCheck::requireNewImages(const CheckImages& images)
{
    const double tolerance = options_.fixedTarget ? IDENTICAL : sameImageTolerance(pixelSigmaOf(calibration_));
    record_ = recordOf({{}, VectorXd(), MatrixXd(), MatrixXd()}, images.files, time_, history_, images.shown);
    requireNotCalibrated(record_, calibration_, tolerance);
    requireNew(history_, options_.history, record_, tolerance);
}

void KeptCheck::add(const CheckResult& check, const CheckInput& input, const CheckImages& images, const std::string& verdict)
{
    record_ = recordOf(check.charted, images.files, time_, history_, images.shown);
    record_.verdict = verdict;
    record_.sigma = check.sigma;
    record_.dof = check.dof;
    if (options_.conditions.isSaid())     // the day's index is no error of the calibration
        for (int c = 0; c < (int)input.rig.cameras.size(); c++)
            record_.byParameters.col(columnsOf(withWedges(input).rig, c).outerIndex).setZero();
    history_.checks.push_back(record_);
    result_ = chartHistory(history_, covariance_, (1. - SHARE_OF_CHECK)*options_.falseAlarm);
}

void KeptCheck::write(const std::string& verdict, bool isGood, const std::string& unseen) const
{
    const std::string page = historyPage(history_, result_, covariance_,
                                         {options_.calibration, options_.falseAlarm, verdict, isGood, unseen});
    writeText(options_.pageFile(), page);
    writeHistory(options_.history, history_);
}

void KeptCheck::print() const
{
    const std::vector<std::string> beyond = result_.chartsBeyond(history_);
    std::cout << format("\nHistory of %zu check%s since %s: ", history_.checks.size(), history_.checks.size() == 1 ? "" : "s",
                        history_.checks[0].time.substr(0, 10).c_str())
              << (beyond.empty() ? "all charts are within their limits" : "beyond the limit: " + listed(beyond)) << '\n';
    if (!result_.causes.empty())
        std::cout << "What explains all checks best: " << causesIn(result_, history_) << '\n';
    std::cout << "Charts: " << options_.pageFile() << '\n';
}

Json KeptCheck::json() const
{
    return {{"checks", history_.checks.size()}, {"broken", history_.broken}, {"alarm", isAlarm()},
            {"beyond", result_.chartsBeyond(history_)},
            {"causes", causesIn(result_, history_)}, {"t2", result_.points.back().t2}, {"t2_limit", result_.points.back().limitT2},
            {"ewma_limit", result_.points.back().limit}};
}

} // namespace tools
