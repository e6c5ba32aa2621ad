// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_REDUCED_COST_HPP
#define OPENCV_REFRACT_REDUCED_COST_HPP

#include "adjust/eliminate.hpp"
#include "adjust/view_motion.hpp"
#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

namespace cv { namespace refract {

/** The problem as Ceres sees it: one cost by the outer blocks that are variable, the inner ones being at their best (variable
projection). Its Jacobian is the root of the information, so that its steps are those of the whole problem. In that of a scene each
row has few poses: its residuals come in groups, one a pose, and one for the cameras.

Ceres tells it where to be asked (an evaluation callback): the values of a group's own blocks would not do. Where a step is tried the
inner blocks begin from where the linearisation of the last accepted place has them. */
class ReducedCost : public ceres::EvaluationCallback
{
public:
    explicit ReducedCost(Problem& problem);
    const std::vector<int>& variableBlocks() const { return variable_; }
    /** Where Ceres has the values of the variable blocks, one after the other; before anything is asked. */
    void setState(const std::vector<double*>& state) { state_ = state; }
    //! Of a scene: what the state is after a step of the free coordinates from where it was linearised last, within its bounds.
    void setStep(const Eigen::VectorXd& step);
    void restore();                     //!< to where it was linearised last
    //! The inner blocks to their best at the state. False where there is no cost.
    bool optimize();
    double squaredError() const { return squaredError_; }       //!< where it was optimised last

    //! One group of residuals; there are some once the cost was linearised.
    class Group : public ceres::CostFunction
    {
    public:
        Group(const ReducedCost& cost, int index);
        //! Of variableBlocks(): on which the residuals depend.
        const std::vector<int>& blocks() const { return blocks_; }
        bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

    private:
        const ReducedCost& cost_;
        const int index_;
        const std::vector<int> blocks_;
    };
    int groupCount() { return rootedInformation().poses.factor.count() + 1; }

    void PrepareForEvaluation(bool withJacobians, bool isNewPoint) override;
    //! At the state. False where there is no cost, or a derivative overflows.
    bool linearize();
    //! Where it was linearised last; of a scene it may be without its root.
    const Information& information() const { return anchor_->information; }
    const Information& rootedInformation();

private:
    //! Where the last linearisation was made.
    struct Anchor
    {
        std::vector<Eigen::VectorXd> values;        //!< of the variable blocks
        std::unique_ptr<ViewMotion> motion;         //!< of a scene
        FreeSpace space;
        Eigen::VectorXd inner;
        double squaredError;
        Information information;
    };
    bool move();
    bool isPose(size_t variable) const;
    Eigen::VectorXd stepFromAnchor();
    void predictInner();
    std::vector<int> blocksOf(int group) const;
    RowMajorMatrix rootOf(int group, int variable) const;
    Eigen::VectorXd residualsOf(int group) const;

    Problem& problem_;
    std::vector<int> variable_;
    int cameras_;                       //!< of these the first ones; the others are poses
    std::unique_ptr<const ViewGraph> graph_;     //!< of a scene's views
    std::vector<double*> state_;
    std::unique_ptr<Anchor> anchor_;
    bool isPossible_;                   //!< there is a cost where it was asked for last
    bool isCurrent_;                    //!< the inner blocks are the best at the problem's outer ones
    bool isAnchor_;                     //!< and the anchor is there
    bool hasRoot_ = false;              //!< what was linearised
    bool isLinear_;                     //!< residuals are asked for with their derivatives
    double squaredError_;
};

}} // namespace

#endif // OPENCV_REFRACT_REDUCED_COST_HPP
