// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_HISTORY_PAGE_HPP
#define REFRACT_TOOLS_HISTORY_PAGE_HPP

#include "history/drift.hpp"

namespace tools {

//! What the page says beside the charts.
struct HistoryFacts
{
    std::string calibration;            //!< its file
    double falseAlarm;
    std::string verdict;                //!< of the last check
    bool isGood;
    std::string unseen;                 //!< what no such check shows; may be empty
};

//! The charts as one HTML page that needs no other file. Throws Failure if gnuplot fails.
std::string historyPage(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance, const HistoryFacts& facts);

} // namespace tools

#endif // REFRACT_TOOLS_HISTORY_PAGE_HPP
