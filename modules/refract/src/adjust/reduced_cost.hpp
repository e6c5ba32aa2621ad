// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_REDUCED_COST_HPP
#define OPENCV_REFRACT_REDUCED_COST_HPP

#include "adjust/eliminate.hpp"
#include <ceres/cost_function.h>

namespace cv { namespace refract {

/** The problem as Ceres sees it: one cost by the outer blocks that are variable, the inner ones being at their best (variable
projection). Its Jacobian is the root of the information, so that its steps are those of the whole problem.

Where a step is tried the inner blocks begin from where the linearisation of the last accepted place has them. */
class ReducedCost : public ceres::CostFunction
{
public:
    explicit ReducedCost(Problem& problem);
    const std::vector<int>& variableBlocks() const { return variable_; }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;
    //! False where there is no cost, or a derivative overflows.
    bool linearizeAt(double const* const* parameters) const;
    //! Where it was linearised last.
    const Information& information() const { return anchor_->information; }

private:
    //! Where the last linearisation was made.
    struct Anchor
    {
        std::vector<Eigen::VectorXd> values;        //!< of the variable blocks
        FreeSpace space;
        Eigen::VectorXd inner;
        Information information;
    };
    bool moveTo(double const* const* parameters) const;
    void predictInner() const;
    bool optimizeAt(double const* const* parameters) const;

    Problem& problem_;
    int count_;
    std::vector<int> variable_;
    mutable std::unique_ptr<Anchor> anchor_;
    mutable bool isCurrent_;            //!< the inner blocks are the best at the problem's outer ones
    mutable bool isAnchor_;             //!< and the anchor is there
    mutable double squaredError_;
};

}} // namespace

#endif // OPENCV_REFRACT_REDUCED_COST_HPP
