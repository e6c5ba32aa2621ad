// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_VECTOR_HPP
#define REFRACT_TOOLS_RIG_VECTOR_HPP

#include "calibrate/rig_model.hpp"
#include "measure/eigen_matrix.hpp"

/* All numbers of a rig in one vector: lenses, windows, R (as rotation vectors) and T, as Fit::covariance. */
namespace tools {

int rigVectorSize(const RigModel& rig);

//! With the errors of the targets at its end, as Fit::withTargets.
VectorXd toVector(const RigModel& rig);

//! The same with these errors only if the rig has columns for them.
VectorXd parametersOf(const RigModel& rig);

//! The other way, whether or not windows are shared; normals get length 1.
void setParameters(RigModel& rig, const VectorXd& parameters);

//! The rig with all these numbers; cameras that look through another one's window get it from there.
RigModel withVector(const RigModel& rig, const VectorXd& numbers);

//! How withVector changes numbers that depend on others: the normal's length, a shared window. Derivatives, at the rig.
MatrixXd consistentChanges(const RigModel& rig);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_VECTOR_HPP
