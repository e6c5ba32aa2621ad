// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CERTIFICATE_HPP
#define REFRACT_TOOLS_CERTIFICATE_HPP

#include "accept/acceptance.hpp"
#include "calibrate/calib_file.hpp"
#include <iosfwd>
#include <string>

/* The certificate of an acceptance test, to print and sign, and for machines. The same input gives the same bytes. */
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

//! A file that the result was made of.
struct CertificateInput
{
    std::string what, name, sha256;
};

struct Certificate
{
    CertificateLabel label;
    std::vector<CertificateInput> inputs;
    std::string command, calibrationTime, calibrationVerdict;
    std::string whereAll;                   //!< which of the outputs has all lengths; empty: none
    std::string temperature;                //!< of the standard, with its +-; empty: not stated
    std::vector<GumTable> budgets;          //!< of the decisive length, of a point, of a plane
    const Acceptance* acceptance = nullptr;

    std::string number() const;             //!< never empty
};

//! Two pages of A4: the decision with its lengths and pictures; the budget, remarks and what it was made from.
std::string certificateHtml(const Certificate& certificate);

//! PTB's digital calibration certificate, XML, version 3.3.0 of its schema; lengths in millimetres.
std::string certificateDcc(const Certificate& certificate);

//! Everything, as JSON.
std::string certificateJson(const Certificate& certificate);

//! Some lines of 80 columns: the decision, what it rests on, what is missing. @param certificate its file; empty: none
void printAcceptance(std::ostream& out, const Acceptance& acceptance, const std::string& certificate);

//! Every length, then the budgets.
void printTables(std::ostream& out, const Acceptance& acceptance, const std::vector<GumTable>& budgets);

} // namespace tools

#endif // REFRACT_TOOLS_CERTIFICATE_HPP
