// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_OUTPUT_HPP
#define REFRACT_TOOLS_CHECK_OUTPUT_HPP

#include "assess/rig_check.hpp"
#include "check/check_images.hpp"
#include "console/file_output.hpp"
#include "console/json.hpp"
#include "history/check_history.hpp"
#include "history/drift.hpp"

/* What refract_check says and writes of one check. */
namespace tools {

/* A check among all others of its calibration (--history). */

class KeptCheck
{
public:
    //! Refuses a history of another rig. @param calibration as it was read
    KeptCheck(const CheckOptions& options, const Calibration& calibration);

    //! What of the history is not as it was written.
    const std::vector<std::string>& broken() const { return history_.broken; }

    //! Refuses images that calibrated, or that an earlier check had.
    void requireNewImages(const CheckImages& images);

    //! @param input of the check
    void add(const CheckResult& check, const CheckInput& input, const CheckImages& images, const std::string& verdict);

    bool isAlarm() const { return result_.isAlarm(); }

    //! @param verdict of all. @param unseen of unseenBy
    void write(const std::string& verdict, bool isGood, const std::string& unseen) const;
    void print() const;
    Json json() const;

private:
    const CheckOptions& options_;
    const Calibration& calibration_;
    std::unique_ptr<FileLock> lock_;    //!< while it lives, no other check is between reading and writing this history
    CheckHistory history_;
    MatrixXd covariance_;
    std::string time_;
    CheckRecord record_;
    HistoryResult result_;
};

/* Whether the images of a check can tell. */

/** Empty, or why "unchanged" cannot be said: with too low a probability the images would show what --detect asks for.
@param input that was tested */
std::string whyNot(const CheckResult& result, const CheckOptions& options, const CheckInput& input);

const char CANNOT_TELL[] = "cannot tell";

//! In a word or two. @param why of whyNot
std::string verdictOf(const CheckResult& result, const std::string& why);

//! A sentence of errors that are as they were in the calibration; empty: all would show.
std::string unseenBy(const CheckResult& result);

Json checkJson(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const std::string& verdict,
               const std::string& why);

void printCheck(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const CheckImages& images);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_OUTPUT_HPP
