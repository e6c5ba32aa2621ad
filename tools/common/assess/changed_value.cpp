// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/changed_value.hpp"
#include "console/table.hpp"
#include "measure/eigen_matrix.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

static std::vector<ValueAboutAxis> aboutAxes(const Change& change, const VectorXd& value, const MatrixXd& covariance)
{
    const double factor = change.chart.empty() ? change.quantities[0].factor : change.chartFactor;
    std::vector<ValueAboutAxis> about;
    for (int i = 0; i < (int)value.size(); i++)
        about.push_back({change.axes[i], factor*value[i], std::abs(factor)*std::sqrt(std::max(0., covariance(i, i)))});
    return about;
}

std::vector<ChangedValue> valuesOf(const Change& change, const VectorXd& delta, const MatrixXd& covariance)
{
    std::vector<ChangedValue> values;
    int at = 0;
    for (const ChangedQuantity& quantity : change.quantities)
    {
        const VectorXd part = delta.segment(at, quantity.count);
        const MatrixXd C = covariance.block(at, at, quantity.count, quantity.count);
        const VectorLength length = lengthOf(part, C);
        ChangedValue changed{quantity.factor*length.value, quantity.factor*length.std, quantity.unit};
        if (quantity.count > 1 && (int)change.axes.size() == quantity.count)
            changed.aboutAxes = aboutAxes(change, part, C);
        values.push_back(changed);
        at += quantity.count;
    }
    return values;
}

//! A length hides that one axis is known much worse than another.
static bool isUnevenlyKnown(const std::vector<ValueAboutAxis>& axes)
{
    const double UNEVEN = 3.;
    const auto [least, most] = std::minmax_element(axes.begin(), axes.end(), [](const auto& a, const auto& b) { return a.std < b.std; });
    return most != axes.end() && most->std > UNEVEN*least->std;
}

std::string sentenceOf(const Change& change, const std::vector<ChangedValue>& values)
{
    std::string text = change.name;
    for (size_t i = 0; i < values.size(); i++)
    {
        text += (i ? " and " : " ") + plusMinus(values[i].value, values[i].std) + (values[i].unit.empty() ? "" : " " + values[i].unit);
        std::string separator = " (";
        const bool tellsAxes = change.isTurn() || isUnevenlyKnown(values[i].aboutAxes);
        for (size_t a = 0; tellsAxes && a < values[i].aboutAxes.size(); a++)
        {
            const ValueAboutAxis& about = values[i].aboutAxes[a];
            text += separator + about.axis + " " + plusMinus(about.value, about.std);
            separator = ", ";
        }
        text += tellsAxes && !values[i].aboutAxes.empty() ? ")" : "";
    }
    return text;
}

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
