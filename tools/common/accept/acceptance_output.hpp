// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ACCEPTANCE_OUTPUT_HPP
#define REFRACT_TOOLS_ACCEPTANCE_OUTPUT_HPP

#include "accept/certificate.hpp"
#include <iosfwd>

namespace tools {

//! Some lines of 80 columns: the decision, what it rests on, what is missing. @param certificate its file; empty: none
void printAcceptance(std::ostream& out, const Acceptance& acceptance, const std::string& certificate);

//! Every length, then the budgets.
void printTables(std::ostream& out, const Acceptance& acceptance, const std::vector<GumTable>& budgets);

} // namespace tools

#endif // REFRACT_TOOLS_ACCEPTANCE_OUTPUT_HPP
