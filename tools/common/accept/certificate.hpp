// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CERTIFICATE_HPP
#define REFRACT_TOOLS_CERTIFICATE_HPP

#include "accept/acceptance.hpp"
#include "accept/certificate_label.hpp"

/* The certificate of an acceptance test, to print and sign, and for machines. The same input gives the same bytes. */
namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_CERTIFICATE_HPP
