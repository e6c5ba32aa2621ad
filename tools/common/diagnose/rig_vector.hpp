// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_VECTOR_HPP
#define REFRACT_TOOLS_RIG_VECTOR_HPP

#include "calibrate/rig_model.hpp"
#include "measure/eigen_matrix.hpp"

/* All numbers of a rig in one vector, in the order of Fit::withTargets with the errors of the targets at its end. */
namespace tools {

int rigVectorSize(const RigModel& rig);

VectorXd toVector(const RigModel& rig);

//! The rig with these numbers; cameras that look through another one's window get it from there.
RigModel withVector(const RigModel& rig, const VectorXd& numbers);

//! How withVector changes numbers that depend on others: the normal's length, a shared window. Derivatives, at the rig.
MatrixXd consistentChanges(const RigModel& rig);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_VECTOR_HPP
