// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CERTIFICATE_LABEL_HPP
#define REFRACT_TOOLS_CERTIFICATE_LABEL_HPP

#include "calibrate/calib_file.hpp"
#include <string>

namespace tools {

class OptionParser;

//! Who, what and when of a certificate, as the caller says; empty where nobody said.
struct CertificateLabel
{
    std::string number;             //!< of the certificate; empty: made of the hashes of the inputs
    std::string date, issued;       //!< of the test, of the certificate, YYYY-MM-DD
    std::string serial;             //!< of the cameras and windows
    std::string customer, laboratory, address, person, approver;
    std::string country;            //!< of the laboratory, ISO 3166-1, two letters
    std::string standard;           //!< of length: kind, serial number, certificate
    std::string traceability;       //!< of the standard: to which realisation of the metre
    std::string environment;        //!< air, temperature, water

    void addTo(OptionParser& parser);
    //! Throws Failure for a text or a date that no certificate may have.
    void check() const;
    /** With what the calibration and the files say where nobody did. Throws Failure if they say another thing: a test of other windows, or
    before its calibration, or to come. @param filename of the calibration @param inputs that were read */
    CertificateLabel completed(const Calibration& calibration, const std::string& filename, const std::vector<std::string>& inputs) const;
    //! "laboratory, standard": what an accredited certificate has, and this one lacks.
    std::vector<std::string> missing() const;
};

} // namespace tools

#endif // REFRACT_TOOLS_CERTIFICATE_LABEL_HPP
