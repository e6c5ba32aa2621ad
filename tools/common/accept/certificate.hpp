// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CERTIFICATE_HPP
#define REFRACT_TOOLS_CERTIFICATE_HPP

#include "accept/acceptance.hpp"

/* The certificate of an acceptance test, to print and sign, and for machines. The same input gives the same bytes. */
namespace tools {

//! Who, what and when: as the caller says; empty where nobody said.
struct CertificateLabel
{
    std::string number;             //!< of the certificate; empty: made of the hashes of the inputs
    std::string date;               //!< of the test, YYYY-MM-DD
    std::string serial;             //!< of the cameras and windows
    std::string customer, laboratory, person;
    std::string country;            //!< of the laboratory, ISO 3166-1, two letters
    std::string standard;           //!< of length: kind, serial number, certificate
    std::string environment;        //!< air, temperature, water
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
    std::vector<GumTable> budgets;          //!< of the decisive length, of a point, of a plane
    const Acceptance* acceptance = nullptr;

    std::string number() const;             //!< never empty
};

//! Throws Failure unless it is YYYY-MM-DD, a day that there is.
void requireDate(const std::string& date, const std::string& option);

//! One page of A4 with a picture.
std::string certificateHtml(const Certificate& certificate);

//! PTB's digital calibration certificate, XML, version 3.3.0 of its schema; lengths in millimetres.
std::string certificateDcc(const Certificate& certificate);

//! Everything, as JSON.
std::string certificateJson(const Certificate& certificate);

} // namespace tools

#endif // REFRACT_TOOLS_CERTIFICATE_HPP
