// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With a wedge or a curvature the transfer is differentiated automatically, one parameter at a time: it happens once a camera and
step. */

#include "adjust/transferred_window.hpp"
#include "window/place.hpp"
#include <Eigen/Geometry>
#include <ceres/jet.h>

namespace cv { namespace refract {

namespace {

typedef ceres::Jet<double, 1> Jet;
typedef Eigen::Matrix<Jet, 3, 1> Jet3;
typedef Eigen::Matrix<Jet, 3, 3> Jet33;

//! A camera of the rig; with one parameter of it that varies, or none (-1).
struct JetCamera
{
    JetCamera(const TransformWithDerivatives& camera, int varied)
    {
        for (int r = 0; r < 3; r++)
        {
            for (int c = 0; c < 3; c++)
            {
                R(r, c) = Jet(camera.rotation.R(r, c));
                if (varied >= 0 && varied < 3)
                    R(r, c).v[0] = camera.rotation.dR[varied](r, c);
            }
            T[r] = varied == 3 + r ? Jet(camera.T[r], 0) : Jet(camera.T[r]);
        }
    }
    Jet33 R;
    Jet3 T;
};

//! As windowAxes().
Jet33 axesOf(const Jet3& n)
{
    const Jet3 e1 = (Jet3(Jet(1.), Jet(0.), Jet(0.)) - n[0]*n).normalized();
    Jet33 axes;
    axes << e1.transpose(), n.cross(e1).transpose(), n.transpose();
    return axes;
}

//! cos a and sin(a)/a, which are functions of a^2 and have derivatives at 0.
void turnBy(const Jet& a2, Jet& cosine, Jet& sine)
{
    const double SMALL = 4e-4;          // the terms that are left out are below 1e-16
    if (a2.a < SMALL)
    {
        cosine = 1. - a2*(0.5 - a2*(1./24 - a2/720.));
        sine = 1. - a2*(1./6 - a2*(1./120 - a2/5040.));
        return;
    }
    const Jet a = sqrt(a2);
    cosine = cos(a);
    sine = sin(a)/a;
}

//! The inverse of facesOf() in the other frame: thickness and wedge there, as windowInFrame().
void transfer(const WindowLayout& at, const std::vector<Jet>& window, const JetCamera& owner, const JetCamera& camera,
              std::vector<Jet>& seen)
{
    const Jet33 R = camera.R*owner.R.transpose();
    const Jet3 t = camera.T - R*owner.T, given(window[at.normal], window[at.normal + 1], window[at.normal + 2]);
    const Jet3 n = given.normalized(), nThere = R*n;
    const Jet33 here = axesOf(n), turn = axesOf(nThere)*R*here.transpose();     // about n
    Jet height = window[at.distance], before = height + nThere.dot(t), W1(0.), W2(0.), cosine, sine;
    for (int i = 0; i < at.layers; i++)
    {
        const Jet &w1 = window[at.wedge + 2*i], &w2 = window[at.wedge + 2*i + 1];
        W1 += w1;
        W2 += w2;
        height += window[at.thickness + i];
        turnBy(W1*W1 + W2*W2, cosine, sine);
        const Jet3 face = R*(here.transpose()*Jet3(sine*W1, sine*W2, cosine));
        const Jet heightThere = height + face.dot(t)/cosine;
        seen[at.thickness + i] = heightThere - before;
        seen[at.wedge + 2*i] = turn(0, 0)*w1 + turn(0, 1)*w2;
        seen[at.wedge + 2*i + 1] = turn(1, 0)*w1 + turn(1, 1)*w2;
        before = heightThere;
    }
}

//! As windowInFrame() of a bent pane: the axis through the other camera and the spheres' centre.
void transferBent(const WindowLayout& at, const std::vector<Jet>& window, const JetCamera& owner, const JetCamera& camera,
                  std::vector<Jet>& seen)
{
    const Jet33 R = camera.R*owner.R.transpose();
    const Jet3 t = camera.T - R*owner.T, given(window[at.normal], window[at.normal + 1], window[at.normal + 2]);
    const Jet &k = window[at.curvature], &distance = window[at.distance];
    const Jet side = 1. - k*distance;
    const Jet3 n = R*given.normalized(), gradient = side*n - k*t;
    const Jet length = gradient.norm();
    for (int i = 0; i < 3; i++)
        seen[at.normal + i] = gradient[i]/length;
    seen[at.distance] = (distance*(1. + side) + 2.*side*n.dot(t) - k*t.dot(t))/(1. + length);
}

} // namespace

TransferredWindow::TransferredWindow(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                           const TransformWithDerivatives& camera)
    : parameters(ofOwner, ofOwner + at.count), byWindow(Eigen::MatrixXd::Identity(at.count, at.count))
{
    byOwner.setZero(at.count, 6);
    byCamera.setZero(at.count, 6);
    if (hasCenter(at.shape))
        transferCenter(at, ofOwner, owner, camera);
    else
        transferFaces(at, ofOwner, owner, camera);
}

void TransferredWindow::transferFaces(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                                      const TransformWithDerivatives& camera)
{
    const WindowTransfer plane(Vec3d(ofOwner + at.normal), ofOwner[at.distance], owner, camera);
    std::copy(plane.normal.val, plane.normal.val + 3, parameters.begin() + at.normal);
    parameters[at.distance] = plane.distance;
    byWindow.block<4, 4>(at.normal, at.normal) = plane.byWindow;
    byOwner.middleRows<4>(at.normal) = plane.byOwner;
    byCamera.middleRows<4>(at.normal) = plane.byCamera;
    std::vector<int> rows;
    if (at.shape == WINDOW_BENT)
        rows = { at.normal, at.normal + 1, at.normal + 2, at.distance };
    else if (at.curvature > at.wedge)
        for (int i = 0; i < at.layers; i++)
            rows.insert(rows.end(), { at.thickness + i, at.wedge + 2*i, at.wedge + 2*i + 1 });
    if (!rows.empty())
        differentiate(at, ofOwner, owner, camera, rows);
}

/* A center is a point, a tube's axis a difference of points:

    X1 = Ro^T (X_owner - To),    X = R X1 + T */
void TransferredWindow::transferCenter(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                                       const TransformWithDerivatives& camera)
{
    typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Map33;
    const Matx33d back = owner.rotation.R.t(), turn = camera.rotation.R*back;
    for (int first : { at.normal, at.axis })
    {
        if (first == at.media)
            break;
        const bool isPoint = first == at.normal;
        const Vec3d given(ofOwner + first), fromOwner = isPoint ? given - owner.T : given, inCamera1 = back*fromOwner;
        const Vec3d there = camera.rotation.R*inCamera1 + (isPoint ? camera.T : Vec3d());
        std::copy_n(there.val, 3, parameters.begin() + first);
        byWindow.block<3, 3>(first, first) = Map33(turn.val);
        for (int i = 0; i < 3; i++)
        {
            const Vec3d byTurn = camera.rotation.R*(owner.rotation.dR[i].t()*fromOwner);
            byOwner.block<3, 1>(first, i) = Eigen::Map<const Eigen::Vector3d>(byTurn.val);
        }
        byCamera.block<3, 3>(first, 0) = Map33(camera.rotation.derivativeOf(inCamera1).val);
        if (!isPoint)
            continue;
        byOwner.block<3, 3>(first, 3) = -Map33(turn.val);
        byCamera.block<3, 3>(first, 3).setIdentity();
    }
}

void TransferredWindow::differentiate(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                                      const TransformWithDerivatives& camera, const std::vector<int>& rows)
{
    const auto seenBy = at.shape == WINDOW_BENT ? transferBent : transfer;
    for (int varied = 0; varied < at.count + 12; varied++)
    {
        std::vector<Jet> window(ofOwner, ofOwner + at.count), seen(at.count);
        if (varied < at.count)
            window[varied].v[0] = 1;
        const int ofPlaces = varied - at.count;
        seenBy(at, window, JetCamera(owner, ofPlaces < 6 ? ofPlaces : -1), JetCamera(camera, ofPlaces - 6), seen);
        double* const column = varied < at.count ? byWindow.col(varied).data() :
                               ofPlaces < 6 ? byOwner.col(ofPlaces).data() : byCamera.col(ofPlaces - 6).data();
        for (int row : rows)
        {
            parameters[row] = seen[row].a;
            column[row] = seen[row].v[0];
        }
    }
}

void TransferredWindow::hold(int parameter, double value)
{
    parameters[parameter] = value;
    byWindow.row(parameter).setZero();
    byOwner.row(parameter).setZero();
    byCamera.row(parameter).setZero();
}

}} // namespace
