// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EMITTER_PRIOR_HPP
#define REFRACT_TOOLS_EMITTER_PRIOR_HPP

#include "console/keys.hpp"
#include "laser/emitter.hpp"
#include "measure/eigen_matrix.hpp"

namespace tools {

/** An emitter as it was built, and how well that is known. Its state: a rotation vector in its own frame, its position in camera 1, then
all parameters of lens and window. What has no standard deviation is fixed.

    emitter.yml: the keys of emitter.hpp at top level, and
    rotation_std_deg: 2.
    position_std: 5.
    glass_window_std: { normal_deg: [0.5, 0.5], distance: 1., thickness: [0.1], index: [0.001], outer_index: 0.001 }      # as calib.yml */
class EmitterPrior
{
public:
    //! Throws Failure that names the file and the key.
    explicit EmitterPrior(const std::string& filename);

    const Emitter& emitter() const { return emitter_; }
    const std::string& filename() const { return filename_; }
    //! State by what is free, in units of its standard deviations.
    const MatrixXd& basis() const { return basis_; }
    //! How far an emitter is from what it was built like, in these units. A step adds to it, but for the square of the turn.
    VectorXd deviation(const Emitter& other) const;
    Emitter moved(const Emitter& from, const VectorXd& step) const;

private:
    void addWindow(const Keys& keys);
    void free(const std::vector<double>& direction, int first, double std);

    std::string filename_;
    Emitter emitter_;
    MatrixXd basis_;
};

} // namespace tools

#endif // REFRACT_TOOLS_EMITTER_PRIOR_HPP
