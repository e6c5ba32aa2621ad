// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ELIMINATE_HPP
#define OPENCV_REFRACT_ELIMINATE_HPP

#include "adjust/linearize.hpp"
#include "adjust/normal_equations.hpp"
#include "math/dense.hpp"
#include <memory>

namespace cv { namespace refract {

//! An inner block (the pose of a target, a cluster of a scene's points) as it follows from the outer parameters.
struct InnerBlock
{
    std::vector<int> columns;       //!< of the free space: those that it depends on
    Eigen::MatrixXd byOuter;        //!< d best values / d these columns
    Eigen::VectorXd step;           //!< to the best values, the outer parameters staying
    Eigen::MatrixXd half;           //!< H, H H^T = covariance for unit pixel noise, the outer parameters being known
    bool isDetermined = true;
};

//! What all images, and what is known before, tell of the cameras' parameters when all others are unknown.
struct Information
{
    Eigen::MatrixXd root;           //!< R, R^T R = information for unit pixel noise
    Eigen::VectorXd effect;         //!< of each parameter alone, poses of a scene too: the norm of its derivatives
    Eigen::VectorXd residual;       //!< R * (change of the parameters) = -residual is the step to the least squares
    double ofInner = 0;             //!< sum of squares that what is eliminated could still take up alone
    double rounding = 0;            //!< what is left of a scaled column below this is rounding
    std::vector<InnerBlock> inner;  //!< of views, or of clusters
    ScenePoses poses;
    std::shared_ptr<const NormalEquations> equations;   //!< of a scene, its points eliminated
    //! Else a derivative overflowed.
    bool isFinite() const;
};

//! A view without its pose.
struct EliminatedView
{
    InnerBlock pose;
    Eigen::MatrixXd rows;           //!< what no change of the pose can imitate: by the pose's columns, and the residuals
    Eigen::VectorXd squares;        //!< of each column
    double ofPose = 0;              //!< of the residuals that the pose could take up
};

//! Each view by itself, with the prior of its pose.
std::vector<EliminatedView> eliminateEachPose(const Problem& problem, const std::vector<ImageRows>& images);

/** Sets a block from rows [K | J, r], rotated so that K is triangular.
@param qr of K with its columns scaled
@param rotated Q^T [J, r] */
void setInner(const PivotedQR& qr, const Eigen::VectorXd& scale, const Eigen::MatrixXd& rotated, InnerBlock& block);

//! By orthogonal transformations of each view's rows.
Information eliminatePoses(const Problem& problem, const FreeSpace& space, const std::vector<ImageRows>& images);
//! By Schur's complement of the normal equations. The root is not found yet.
Information eliminatePoints(const Problem& problem, const FreeSpace& space);
//! Of a scene: the root, residual and poses, by the factor of its equations. Steps that are damped do without.
void findRoot(Information& information);
//! The one of both that the problem asks for, without its root if that is not asked for and comes later.
Information informationOf(const Problem& problem, bool withHeld = true, bool withRoot = true);

/** A step of a scene's outer parameters to the least squares, each damped by this part of what all images tell of it.
@param gain by which the squares of the linearised problem are less there */
Eigen::VectorXd dampedStep(const Information& information, double damping, double& gain);

//! Of half the squared error, by the cameras' free coordinates.
Eigen::VectorXd gradientOfCameras(const Information& information);

/** How far the least squares of the linearised problem are from where the parameters are, in pixels: divided by a pixel
coordinate's standard deviation, it is the length of the step in standard deviations of what it moves. */
double newtonDecrement(const Information& information);

//! R^+; what is not determined has no part in it.
Eigen::MatrixXd pseudoInverseRoot(const Information& information);

/** Derivatives of all residuals, 2M x (P + 6 V): image by image in the order of images(); columns: the public parameters,
then the pose of each view; 0 where fixed. One camera. */
Eigen::MatrixXd publicJacobian(const Problem& problem);

}} // namespace

#endif // OPENCV_REFRACT_ELIMINATE_HPP
