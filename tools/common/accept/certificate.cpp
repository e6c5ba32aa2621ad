// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate.hpp"
#include "accept/certificate_template.hpp"
#include "accept/error_plot.hpp"
#include "console/rounded.hpp"
#include "console/sha256.hpp"
#include "console/table.hpp"
#include "report/page_template.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tools {

namespace {

const double NONE = std::numeric_limits<double>::quiet_NaN();
const size_t LENGTHS_ON_PAGE = 12, BUDGET_ON_PAGE = 8, LONG_NAME = 34, LONG_COMMAND = 300;

//! As much as there is room for.
std::string shortened(const std::string& text, size_t length)
{
    if (text.size() <= length)
        return text;
    while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80)         // not within a letter
        length--;
    return text.substr(0, length) + "…";
}

std::string orNotStated(const std::string& text) { return text.empty() ? "not stated" : text; }

std::string dofText(double dof) { return std::isfinite(dof) && dof < 1e5 ? format("%.0f", std::floor(dof)) : "∞"; }

//! In the order of the file; on paper those that use most of their limits.
std::vector<size_t> lengthsOnPage(const Acceptance& a)
{
    std::vector<size_t> order(a.lengths.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) { return a.lengths[i].used() > a.lengths[j].used(); });
    order.resize(std::min(order.size(), LENGTHS_ON_PAGE));
    std::sort(order.begin(), order.end());
    return order;
}

PageList lengthsOf(const Acceptance& a)
{
    PageList list;
    for (size_t i : lengthsOnPage(a))
    {
        const LengthResult& r = a.lengths[i];
        PageValues row;
        row.set("name", shortened(r.length.name, LONG_NAME));
        const int decimals = decimalsOf(r.U());
        row.set("nominal", rounded(r.length.length, decimalsOf(r.length.U)));
        row.set("measured", rounded(r.measured, decimals));
        row.set("error", rounded(r.error, decimals, true));
        row.set("U", rounded(r.U(), decimals));
        row.set("k", format("%.2f", r.budget.k));
        row.set("test_U", rounded(r.testU(), decimalsOf(r.testU())));
        row.set("limit", format("%.6g", r.limit));
        row.set("decision", textOf(r.decision) + (r.outside ? " *" : ""));
        row.set("class", textOf(r.decision));
        list.push_back(row);
    }
    return list;
}

//! The largest, and the others in one row: they add up all the same.
std::vector<GumRow> rowsOnPage(const GumTable& table)
{
    std::vector<GumRow> rows = table.rows;
    if (rows.size() <= BUDGET_ON_PAGE)
        return rows;
    std::stable_sort(rows.begin(), rows.end(), [](const GumRow& a, const GumRow& b) { return a.share > b.share; });
    GumRow rest{format("%zu others together", rows.size() - BUDGET_ON_PAGE + 1), "", NONE, NONE, 0., 0., NONE};
    for (size_t i = BUDGET_ON_PAGE - 1; i < rows.size(); i++)
    {
        rest.contribution = std::hypot(rest.contribution, rows[i].contribution);
        rest.share += rows[i].share;
    }
    rows.resize(BUDGET_ON_PAGE - 1);
    rows.push_back(rest);
    return rows;
}

PageList budgetOf(const GumTable& table, const std::string& unit)
{
    PageList rows;
    for (const GumRow& row : rowsOnPage(table))
    {
        PageValues entry;
        entry.set("source", row.source);
        entry.set("std", row.knownTo(unit));
        entry.set("sensitivity", std::isnan(row.sensitivity) ? "" : format("%.3g", row.sensitivity));
        entry.set("contribution", rounded(row.contribution, decimalsOf(table.u) + 1));
        entry.set("share", format("%.1f", 100.*row.share));
        entry.set("dof", std::isnan(row.dof) ? "" : dofText(row.dof));
        rows.push_back(entry);
    }
    return rows;
}

void setLabel(PageValues& page, const CertificateLabel& label)
{
    for (const auto& entry : {std::make_pair("date", label.date), {"issued", label.issued}, {"serial", label.serial},
                              {"customer", label.customer}, {"laboratory", label.laboratory}, {"address", label.address},
                              {"person", label.person}, {"approver", label.approver}, {"standard", label.standard},
                              {"traceability", label.traceability}, {"environment", label.environment}})
        page.set(entry.first, orNotStated(entry.second));
}

std::string verdictOf(const Acceptance& a)
{
    const std::string all = format("%d of %zu lengths", a.count(Decision::PASS), a.lengths.size());
    switch (a.decision())
    {
    case Decision::PASS: return format("Conforms: all %zu lengths are within the limit, their uncertainty included", a.lengths.size());
    case Decision::FAIL: return format("Does not conform: %d of %zu lengths are beyond the limit by more than the uncertainty of the test",
                                       a.count(Decision::FAIL), a.lengths.size());
    default: return "Undecided: " + all + " are within the limit, their uncertainty included; of the others the uncertainty is too large "
                    "to decide";
    }
}

PageList inputsOf(const Certificate& c)
{
    PageList list;
    for (const CertificateInput& input : c.inputs)
    {
        PageValues entry;
        entry.set("what", input.what);
        entry.set("name", input.name);
        entry.set("sha256", input.sha256);
        list.push_back(entry);
    }
    return list;
}

} // namespace

std::string Certificate::number() const
{
    if (!label.number.empty())
        return label.number;
    std::string all = label.date + label.serial + acceptance->limit.text();
    for (const CertificateInput& input : inputs)
        all += input.sha256;
    return "refract-" + sha256Of(all).substr(0, 16);
}

std::string certificateHtml(const Certificate& c)
{
    const Acceptance& a = *c.acceptance;
    PageValues page;
    setLabel(page, c.label);
    page.set("number", c.number());
    page.set("verdict", verdictOf(a));
    page.set("class", textOf(a.decision()));
    page.set("unit", a.unit.empty() ? "unit of the calibration" : a.unit);
    page.set("limit", a.limit.text());
    page.set("lengths", lengthsOf(a));
    const bool partly = a.lengths.size() > LENGTHS_ON_PAGE;
    page.set("has_more_lengths", partly);
    page.set("more_lengths", format("The %zu of %zu lengths that use most of their limit; the others are in the DCC.", LENGTHS_ON_PAGE,
                                    a.lengths.size()));
    page.set("volume_name", a.volume.name());
    page.set("volume", a.volume.numbers());
    const int decimals = decimalsOf(a.largest().U());
    page.set("summary", "Largest error of indication " + rounded(a.largest().error, decimals, true) + ", root mean square "
             + rounded(a.rms(), decimals) + ".");
    page.set("rule", DECISION_RULE);
    page.set("temperature", orNotStated(c.temperature));
    const GumTable& budget = c.budgets[0];
    page.set("budget", budgetOf(budget, a.unit));
    page.set("budget_of", budget.quantity);
    page.set("budget_result", "u = " + rounded(budget.u, decimalsOf(budget.u)) + ", effective degrees of freedom " + dofText(budget.dof)
             + format(", k = %.2f, U = ", budget.k) + rounded(budget.U, decimalsOf(budget.U)) + "; U of the test "
             + rounded(budget.testU, decimalsOf(budget.testU)));
    const std::vector<std::string> remarks = a.remarks();
    page.set("remarks", pageList(remarks));
    page.set("has_remarks", !remarks.empty());
    page.set("inputs", inputsOf(c));
    page.set("calibration_time", orNotStated(c.calibrationTime));
    page.set("calibration_verdict", orNotStated(c.calibrationVerdict));
    page.set("version", REFRACT_VERSION);
    page.set("opencv_version", CV_VERSION);
    page.set("command", shortened(c.command, LONG_COMMAND));
    page.set("errors_over_length", drawErrorsOverLength(a));
    page.set("errors_in_volume", drawErrorsInVolume(a));
    return renderPage("the certificate", CERTIFICATE_TEMPLATE, page);
}

} // namespace tools
