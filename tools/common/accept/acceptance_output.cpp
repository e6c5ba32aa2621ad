// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate.hpp"
#include "accept/dcc_template.hpp"
#include "calibrate/units.hpp"
#include "console/json.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "report/page_template.hpp"
#include "report/summary.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

namespace tools {

namespace {

const size_t MOST_LINES = 18;           // with remarks: a terminal shows them without scrolling

std::string verdictOf(const Acceptance& a)
{
    const int passed = a.count(Decision::PASS), failed = a.count(Decision::FAIL), undecided = a.count(Decision::UNDECIDED);
    switch (a.decision())
    {
    case Decision::PASS: return format("PASS: all %d lengths are within their limits, U included", passed);
    case Decision::FAIL: return format("FAIL: of %zu lengths %d are beyond their limits by more than the test's own U, %d undecided",
                                       a.lengths.size(), failed, undecided);
    default: return format("UNDECIDED: of %zu lengths %d are within their limits, U included; %d are within U of them", a.lengths.size(),
                           passed, undecided);
    }
}

std::string resultOf(const LengthResult& r, const std::string& unit)
{
    const int decimals = decimalsOf(r.U());
    return rounded(r.error, decimals, true) + " " + unit + ", U " + rounded(r.U(), decimals)
        + format(", limit %.6g: '", r.limit) + r.length.name + "'";
}

//! The three largest.
std::string madeOf(const GumTable& table)
{
    std::vector<GumRow> rows = table.rows;
    std::stable_sort(rows.begin(), rows.end(), [](const GumRow& a, const GumRow& b) { return a.share > b.share; });
    std::string text;
    for (size_t i = 0; i < std::min<size_t>(3, rows.size()); i++)
        text += (i ? ", " : "") + rows[i].source + format(" %.0f %%", 100.*rows[i].share);
    return text;
}

std::string textOfDof(double dof) { return std::isfinite(dof) && dof < 1e5 ? format("%.0f", std::floor(dof)) : "inf"; }

std::string orBlank(double number) { return std::isnan(number) ? "" : format("%.3g", number); }

const char* const ANY_COUNTRY = "ZZ";       // of no country, in ISO 3166-1: the schema wants two letters

//! XML has no control characters, and the schema no text of blanks only.
std::string textOf(const std::string& text)
{
    std::string result;
    for (char c : text)
        result += (unsigned char)c < ' ' ? ' ' : c;
    const size_t first = result.find_first_not_of(' ');
    return first == std::string::npos ? "not stated" : result.substr(first, result.find_last_not_of(' ') - first + 1);
}

//! A word of a list with blanks between.
std::string wordOf(std::string text)
{
    text = textOf(text);
    std::replace(text.begin(), text.end(), ' ', '_');
    return text;
}

std::string conformityOf(const LengthResult& r)
{
    return r.decision == Decision::PASS ? "pass" : r.decision == Decision::FAIL ? "fail"
           : std::abs(r.error) <= r.limit ? "conditionalPass" : "conditionalFail";
}

//! The worst of them.
std::string conformityOf(const Acceptance& a)
{
    std::string worst = "pass";
    for (const char* const level : {"conditionalPass", "conditionalFail", "fail"})
        for (const LengthResult& r : a.lengths)
            if (conformityOf(r) == level)
                worst = level;
    return worst;
}

std::string listOf(const Acceptance& a, const std::function<std::string(const LengthResult&)>& text)
{
    std::string list;
    for (const LengthResult& r : a.lengths)
        list += (list.empty() ? "" : " ") + text(r);
    return list;
}

void setLengths(Json& page, const Acceptance& a)
{
    const double millimetres = millimetresIn(a.unit);
    using Number = std::function<double(const LengthResult&)>;
    const auto set = [&](const std::string& name, const Number& number, const Number& uncertainty) {
        page.set(name, listOf(a, [&](const LengthResult& r) {
            return rounded(millimetres*number(r), decimalsOf(millimetres*uncertainty(r))); })); };
    const Number certifiedU = [](const LengthResult& r) { return r.length.U; }, U = [](const LengthResult& r) { return r.U(); };
    set("certified", [](const LengthResult& r) { return r.length.length; }, certifiedU);
    set("certified_U", certifiedU, certifiedU);
    set("measured", [](const LengthResult& r) { return r.measured; }, U);
    set("errors", [](const LengthResult& r) { return r.error; }, U);
    set("U", U, U);
    page.set("limits", listOf(a, [&](const LengthResult& r) { return format("%.9g", millimetres*r.limit); }));
    page.set("k", listOf(a, [](const LengthResult& r) { return format("%.3f", r.budget.k); }));
    page.set("names", listOf(a, [](const LengthResult& r) { return wordOf(r.length.name); }));
    page.set("conformities", listOf(a, [](const LengthResult& r) { return conformityOf(r); }));
}

} // namespace

void printAcceptance(std::ostream& out, const Acceptance& a, const std::string& certificate)
{
    std::vector<std::string> facts = {"Nearest to its limit, U included: " + resultOf(a.decisive(), a.unit),
                                      "Largest error: " + resultOf(a.largest(), a.unit)};
    if (a.decisive().length.name == a.largest().length.name)
        facts.erase(facts.begin());
    facts.push_back(format("Errors %.2g %s RMS; U of the first is made of: ", a.rms(), a.unit.c_str()) + madeOf(a.decisive().budget));
    const std::vector<std::string> remarks = a.remarks();
    facts.insert(facts.end(), remarks.begin(), remarks.end());
    std::string more = "More: --verbose, " + (certificate.empty() ? "--certificate=certificate.html" : certificate);

    const Tone tone = a.decision() == Decision::PASS ? Tone::GOOD : a.decision() == Decision::FAIL ? Tone::BAD : Tone::DOUBTFUL;
    size_t room = MOST_LINES - 1;
    for (const std::string& line : brokenInto(verdictOf(a), DIGEST_COLUMNS, "  ", LongWords::BROKEN))
    {
        out << toned(out, line, tone) << '\n';
        room--;
    }
    int untold = 0;
    for (const std::string& fact : facts)
    {
        const std::vector<std::string> lines = brokenInto(fact, DIGEST_COLUMNS, "  ", LongWords::BROKEN);
        untold += lines.size() > room;
        if (lines.size() > room)
            continue;
        room -= lines.size();
        for (const std::string& line : lines)
            out << line << '\n';
    }
    if (untold)
        more = format("%d remark%s ", untold, untold == 1 ? "" : "s") + "more: " + more.substr(more.find(' ') + 1);
    out << firstOf(brokenInto(more, DIGEST_COLUMNS, "  ", LongWords::BROKEN), 1, DIGEST_COLUMNS)[0] << '\n';
}

void printTables(std::ostream& out, const Acceptance& a, const std::vector<GumTable>& budgets)
{
    Table table({"length" + (a.unit.empty() ? "" : ", " + a.unit), "certified", "measured", "error", "U", "k", "U of test", "limit",
                 "decision"});
    for (const LengthResult& r : a.lengths)
    {
        const int decimals = decimalsOf(r.U());
        table.add({r.length.name, rounded(r.length.length, decimalsOf(r.length.U)), rounded(r.measured, decimals),
                   rounded(r.error, decimals, true), rounded(r.U(), decimals), format("%.2f", r.budget.k),
                   rounded(r.testU(), decimalsOf(r.testU())), format("%.6g", r.limit), textOf(r.decision) + (r.outside ? " *" : "")});
    }
    out << '\n';
    table.print(out);
    out << "\nDecision: " << DECISION_RULE << ".\n";
    for (const std::string& remark : a.remarks())
        out << "Remark: " << remark << ".\n";
    for (const GumTable& budget : budgets)
    {
        const std::string unit = a.unit.empty() ? "" : ", " + a.unit;
        const auto ofU = [&](double value) { return rounded(value, decimalsOf(budget.u) + 1); };
        out << '\n' << budget.quantity << ": " << rounded(budget.value, decimalsOf(budget.U)) << (a.unit.empty() ? "" : " " + a.unit)
            << "\n\n";
        Table rows({"source", "standard uncertainty", "sensitivity" + (a.unit.empty() ? "" : unit + " per its unit"), "contribution" + unit,
                    "share, %", "degrees of freedom"});
        for (const GumRow& row : budget.rows)
            rows.add({row.source, row.knownTo(a.unit), orBlank(row.sensitivity), ofU(row.contribution),
                      format("%.1f", 100.*row.share), textOfDof(row.dof)});
        rows.add({"u; effective degrees of freedom", "", "", ofU(budget.u), "100.0", textOfDof(budget.dof)});
        rows.add({format("U (k = %.2f, 95.45 %%)", budget.k), "", "", rounded(budget.U, decimalsOf(budget.U)), "", ""});
        rows.print(out);
    }
}

std::string certificateJson(const Certificate& c)
{
    const Acceptance& a = *c.acceptance;
    Json lengths = Json::array(), budgets = Json::array(), inputs = Json::array();
    for (const LengthResult& r : a.lengths)
        lengths.append({{"name", r.length.name}, {"length", r.length.length}, {"length_U", r.length.U}, {"measured", r.measured},
                        {"error", r.error}, {"U", r.U()}, {"k", r.budget.k}, {"dof", r.budget.dof}, {"test_U", r.testU()},
                        {"limit", r.limit},
                        {"decision", textOf(r.decision)}, {"outside_volume", r.outside}});
    for (const GumTable& budget : c.budgets)
    {
        Json rows = Json::array();
        for (const GumRow& row : budget.rows)
            rows.append({{"source", row.source}, {"given", row.given}, {"std", row.std},
                         {"sensitivity", row.sensitivity}, {"contribution", row.contribution}, {"share", row.share},
                         {"dof", row.dof}});
        budgets.append({{"quantity", budget.quantity}, {"value", budget.value}, {"rows", rows}, {"u", budget.u},
                        {"dof", budget.dof}, {"k", budget.k}, {"U", budget.U}});
    }
    for (const CertificateInput& input : c.inputs)
        inputs.append({{"what", input.what}, {"name", input.name}, {"sha256", input.sha256}});
    const Json json = {{"decision", textOf(a.decision())}, {"number", c.number()}, {"date", c.label.date}, {"issued", c.label.issued},
                       {"unit", a.unit}, {"rule", DECISION_RULE}, {"remarks", a.remarks()},
                       {"max_error", a.limit.text()}, {"images_checked", a.imagesChecked}, {"lengths", lengths}, {"budgets", budgets},
                       {"missing", a.missing}, {"notices", a.notices}, {"inputs", inputs}, {"command", c.command},
                       {"version", REFRACT_VERSION}};
    return json.text(2) + '\n';
}

std::string certificateDcc(const Certificate& c)
{
    const Acceptance& a = *c.acceptance;
    Json page = Json::object();
    for (const auto& entry : {std::make_pair("number", c.number()), {"date", c.label.date}, {"serial", c.label.serial},
                              {"customer", c.label.customer}, {"laboratory", c.label.laboratory}, {"person", c.label.person},
                              {"standard", c.label.standard}, {"environment", c.label.environment}, {"command", c.command},
                              {"address", c.label.address}, {"approver", c.label.approver}, {"issued", c.label.issued},
                              {"traceability", c.label.traceability}, {"temperature", c.temperature}, {"rule", DECISION_RULE},
                              {"volume", a.volume.name() + ", " + a.volume.numbers()}, {"limit", a.limit.text()}, {"unit", a.unit}})
        page.set(entry.first, textOf(entry.second));
    page.set("country", c.label.country.empty() ? ANY_COUNTRY : c.label.country);
    page.set("version", REFRACT_VERSION);
    page.set("opencv_version", CV_VERSION);
    page.set("conformity", conformityOf(a));
    setLengths(page, a);
    std::vector<Json> inputs, remarks;
    for (const CertificateInput& input : c.inputs)
    {
        inputs.push_back({{"what", input.what}, {"name", textOf(input.name)}, {"sha256", input.sha256}});
    }
    for (const std::string& sentence : a.remarks())
        remarks.push_back({{"text", textOf(sentence)}});
    page.set("inputs", inputs);
    page.set("remarks", remarks);
    return renderPage("the DCC", DCC_TEMPLATE, page);
}

} // namespace tools
