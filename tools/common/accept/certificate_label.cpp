// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate_label.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"
#include "console/times.hpp"
#include "console/utf8.hpp"
#include <algorithm>

namespace tools {

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

} // namespace tools
