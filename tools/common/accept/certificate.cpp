// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate.hpp"
#include "accept/acceptance.hpp"
#include "accept/certificate_template.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include "console/sha256.hpp"
#include "console/table.hpp"
#include "console/times.hpp"
#include "report/page_template.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tools {

namespace {

const double NONE = std::numeric_limits<double>::quiet_NaN();
const int WIDTH = 460, HEIGHT = 300;

//! Errors with their U over the tested length, between the limits. SVG.
//! Lengths that are alike stand side by side, as their bars would hide each other.
double asideOf(const Acceptance& a, const LengthResult& of, double longest)
{
    const double ALIKE = 0.005*longest, STEP = 0.008*longest, ROOM = 0.08*longest;
    int before = 0, count = 0;
    for (const LengthResult& r : a.lengths)
        if (std::abs(r.length.length - of.length.length) < ALIKE)
        {
            before += &r < &of;
            count++;
        }
    return std::min(STEP, ROOM/count)*(before - 0.5*(count - 1));
}

std::string drawErrorsOverLength(const Acceptance& a)
{
    Plot plot(WIDTH, HEIGHT);
    std::vector<std::vector<double>> errors, limits;
    double longest = 0., highest = 0.;
    for (const LengthResult& r : a.lengths)
        longest = std::max(longest, r.length.length);
    for (const LengthResult& r : a.lengths)
    {
        errors.push_back({r.length.length + asideOf(a, r, longest), r.error, r.U()});
        highest = std::max({highest, std::abs(r.error) + r.U(), r.limit});
    }
    for (int i = 0; i <= 20; i++)
    {
        const double length = 1.1*longest*i/20;
        limits.push_back({length, a.limit.of(length)});
    }
    plot.data("errors", errors);
    plot.data("limits", limits);
    plot << "set xlabel " << Plot::quoted("length", a.unit) << "\nset ylabel " << Plot::quoted("error of indication", a.unit)
         << "\nset xrange [0:" << 1.1*longest << "]\nset yrange [" << -1.1*highest << ':' << 1.1*highest << "]\nset key off\n"
         << "plot $limits using 1:2 with lines linewidth 2 linecolor rgb '#dc2626', $limits using 1:(-$2) with lines linewidth 2 "
            "linecolor rgb '#dc2626', 0 with lines linecolor rgb '#94a3b8', " << Plot::withBars("errors", "1", 2, 3, "#0284c7") << '\n';
    return plot.svg();
}

//! 1, 2 or 5 times a power of ten, some five of which are so long.
double tickOf(double length)
{
    const double decade = std::pow(10., std::floor(std::log10(length/5.)));
    for (double tick : {1., 2., 5.})
        if (5.*tick*decade >= length)
            return tick*decade;
    return 10.*decade;
}

//! Where the lengths were, seen from above (z-x), each coloured by its error over its limit, in the box that was calibrated. SVG.
std::string drawErrorsInVolume(const Acceptance& a)
{
    Plot plot(WIDTH, HEIGHT);
    std::vector<std::vector<double>> lengths, box;
    std::vector<cv::Point2d> shown;
    for (const LengthResult& r : a.lengths)
    {
        for (size_t end : r.length.ends)
        {
            const cv::Point3d& X = a.points.points[end].X;
            lengths.push_back({X.z, X.x, r.error/r.limit});
            shown.push_back({X.z, X.x});
        }
        lengths.push_back({NONE, NONE, NONE});
    }
    if (a.volume.box)
    {
        const cv::Point3d& p = a.volume.box->least, & q = a.volume.box->most;
        box = {{p.z, p.x}, {q.z, p.x}, {q.z, q.x}, {p.z, q.x}, {p.z, p.x}};
        shown.insert(shown.end(), {{p.z, p.x}, {q.z, q.x}});
    }
    const auto range = [&](double cv::Point2d::*at) {
        const auto [least, most] = std::minmax_element(shown.begin(), shown.end(), [at](const auto& p, const auto& q) {
            return p.*at < q.*at; });
        return cv::Vec2d((*least).*at, (*most).*at); };
    const cv::Vec2d z = range(&cv::Point2d::x), x = range(&cv::Point2d::y);
    const double longer = std::max(z[1] - z[0], x[1] - x[0]), margin = 0.05*longer, tick = tickOf(longer);
    plot.data("lengths", lengths);
    plot.data("box", box);
    plot << "set xlabel " << Plot::quoted("z", a.unit) << "\nset ylabel " << Plot::quoted("x", a.unit)
         << "\nset xrange [" << z[0] - margin << ':' << z[1] + margin << "]\nset yrange [" << x[0] - margin << ':' << x[1] + margin
         << "]\nset xtics " << tick << "\nset ytics " << tick << "\nset size ratio -1\nset cbrange [-1:1]\nset cblabel "
         << "'error over limit'\nset key off\nplot "
         << (box.empty() ? "" : "$box using 1:2 with lines dashtype 2 linewidth 2 linecolor rgb '#475569', ")
         << "$lengths using 1:2:3 with linespoints pointtype 7 pointsize 0.3 linewidth 2 linecolor palette\n";
    return plot.svg();
}

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

std::vector<Json> lengthsOf(const Acceptance& a)
{
    std::vector<Json> list;
    for (size_t i : lengthsOnPage(a))
    {
        const LengthResult& r = a.lengths[i];
        const int decimals = decimalsOf(r.U());
        list.push_back({{"name", shortened(r.length.name, LONG_NAME)}, {"nominal", rounded(r.length.length, decimalsOf(r.length.U))},
                        {"measured", rounded(r.measured, decimals)}, {"error", rounded(r.error, decimals, true)},
                        {"U", rounded(r.U(), decimals)}, {"k", format("%.2f", r.budget.k)},
                        {"test_U", rounded(r.testU(), decimalsOf(r.testU()))}, {"limit", format("%.6g", r.limit)},
                        {"decision", textOf(r.decision) + (r.outside ? " *" : "")}, {"class", textOf(r.decision)}});
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

std::vector<Json> budgetOf(const GumTable& table, const std::string& unit)
{
    std::vector<Json> rows;
    for (const GumRow& row : rowsOnPage(table))
    {
        rows.push_back({{"source", row.source}, {"std", row.knownTo(unit)},
                        {"sensitivity", std::isnan(row.sensitivity) ? "" : format("%.3g", row.sensitivity)},
                        {"contribution", rounded(row.contribution, decimalsOf(table.u) + 1)},
                        {"share", format("%.1f", 100.*row.share)}, {"dof", std::isnan(row.dof) ? "" : dofText(row.dof)}});
    }
    return rows;
}

void setLabel(Json& page, const CertificateLabel& label)
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

std::vector<Json> inputsOf(const Certificate& c)
{
    std::vector<Json> list;
    for (const CertificateInput& input : c.inputs)
    {
        list.push_back({{"what", input.what}, {"name", input.name}, {"sha256", input.sha256}});
    }
    return list;
}

} // namespace

static const size_t DAY = 10;               // letters of YYYY-MM-DD

void CertificateLabel::addTo(OptionParser& parser)
{
    parser.add("--number", number, "of the certificate (default: made of what was read)");
    parser.add("--date", date, "of the test, year-month-day (default: of the newest file that was read)");
    parser.add("--issued", issued, "date of the certificate (default: today)");
    parser.add("--serial", serial, "of cameras and windows: must be that of calib.yml, if it has one");
    parser.add("--customer", customer, "for whom, with address");
    parser.add("--laboratory", laboratory, "where");
    parser.add("--address", address, "of the laboratory");
    parser.add("--operator", person, "who tested");
    parser.add("--authorised-by", approver, "who authorises the certificate");
    parser.add("--country", country, "of the laboratory, two letters (ISO 3166-1), for --dcc");
    parser.add("--standard", standard, "standard of length: kind, serial number, certificate");
    parser.add("--traceability", traceability, "of the standard: who calibrated it, and to what");
    parser.add("--environment", environment, "what was measured in: temperatures, medium");
}

void CertificateLabel::check() const
{
    for (const auto& day : {std::make_pair("--date", date), {"--issued", issued}})
        if (!day.second.empty())
        {
            requireDate(day.second, day.first);
            requirePast(day.second, day.first);
        }
    const bool isCountry = country.size() == 2 && std::all_of(country.begin(), country.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
    if (!country.empty() && !isCountry)
        throw Failure("--country=" + country + ": give two capital letters, as in --country=DE");
    for (const auto& text : {std::make_pair("--number", number), {"--serial", serial}, {"--customer", customer},
                             {"--laboratory", laboratory}, {"--address", address}, {"--operator", person}, {"--authorised-by", approver},
                             {"--standard", standard}, {"--traceability", traceability}, {"--environment", environment}})
        if (!isUtf8(text.second))
            throw Failure(std::string(text.first) + ": a letter is not UTF-8; is the terminal, or the file of --config, in Latin-1?");
}

CertificateLabel CertificateLabel::completed(const Calibration& calibration, const std::string& filename,
                                             const std::vector<std::string>& inputs) const
{
    CertificateLabel label = *this;
    const std::string& own = calibration.label.serial;
    if (!serial.empty() && !own.empty() && serial != own)
        throw Failure("--serial=" + serial + ": '" + filename + "' is of '" + own + "'; leave it out, or give the calibration of this one");
    if (serial.empty())
        label.serial = own;
    if (date.empty())
        label.date = timeOfFiles(inputs).substr(0, DAY);
    const std::string ofTest = date.empty() ? "the test is of " + label.date + " (SOURCE_DATE_EPOCH, or the newest file)"
                                            : "--date=" + date;
    requirePast(label.date, date.empty() ? "date of the newest file" : "--date");
    if (issued.empty())         // today; where the sun rises first, the test may be of tomorrow
        label.issued = std::max(timeOfNow().substr(0, DAY), label.date);
    if (label.issued < label.date)
        throw Failure("--issued=" + issued + ": " + ofTest + "; a certificate is of a test that was");
    const std::string calibrated = calibration.time.substr(0, DAY);
    if (calibrated.size() == DAY && label.date < calibrated)
        throw Failure(ofTest + ": '" + filename + "' was calibrated later, on " + calibrated
                      + "; a test is of a calibration that there is");
    return label;
}

std::vector<std::string> CertificateLabel::missing() const
{
    std::vector<std::string> names;
    for (const auto& entry : {std::make_pair("laboratory", laboratory), {"its address", address}, {"who authorises", approver},
                              {"standard", standard}, {"its traceability", traceability}})
        if (entry.second.empty())
            names.push_back(entry.first);
    return names;
}

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
    Json page = Json::object();
    setLabel(page, c.label);
    page.set("number", c.number());
    page.set("verdict", verdictOf(a));
    page.set("class", textOf(a.decision()));
    page.set("unit", a.unit.empty() ? "unit of the calibration" : a.unit);
    page.set("limit", a.limit.text());
    page.set("lengths", lengthsOf(a));
    const bool partly = a.lengths.size() > LENGTHS_ON_PAGE;
    page.set("has_more_lengths", partly);
    page.set("more_lengths", format("The %zu of %zu lengths that use most of their limit; the others are ", LENGTHS_ON_PAGE,
                                    a.lengths.size()) + (c.whereAll.empty() ? "in the picture only." : "in " + c.whereAll + "."));
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
