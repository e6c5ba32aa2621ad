// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate.hpp"
#include "accept/dcc_template.hpp"
#include "calibrate/units.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "report/page_template.hpp"
#include <algorithm>
#include <cmath>
#include <functional>

namespace tools {

namespace {

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

void setLengths(PageValues& page, const Acceptance& a)
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

std::string certificateDcc(const Certificate& c)
{
    const Acceptance& a = *c.acceptance;
    PageValues page;
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
    PageList inputs, remarks;
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
