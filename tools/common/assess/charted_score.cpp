// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/charted_score.hpp"

namespace tools {

ChartedScore chartedScoreOf(const std::vector<TestedChange>& all, const CheckProblem::Information& information, int parameters)
{
    ChartedScore charted;
    std::vector<int> rows;
    std::vector<double> ranges;
    for (const TestedChange& tested : all)
    {
        const Change& change = *tested.change;
        if (change.chart.empty() || tested.at.count() < change.size())
            continue;
        charted.changes.push_back(change);
        for (int i = 0; i < change.size(); i++)
        {
            rows.push_back(tested.at.first + i);
            ranges.push_back(change.ranges()[i]);
        }
    }
    const int count = (int)rows.size();
    charted.score.resize(count);
    charted.information.resize(count, count);
    charted.byParameters.resize(count, parameters);
    for (int i = 0; i < count; i++)
    {
        charted.score[i] = information.score[rows[i]]/ranges[i];
        charted.byParameters.row(i) = information.byParameters.row(rows[i]).head(parameters)/ranges[i];
        for (int j = 0; j < count; j++)
            charted.information(i, j) = information.G(rows[i], rows[j])/(ranges[i]*ranges[j]);
    }
    return charted;
}

} // namespace tools
