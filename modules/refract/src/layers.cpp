// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "layers.hpp"

namespace cv { namespace refract {

Layers::Layers(const GlassWindow& window)
{
    window.check();
    normal_ = window.normal / cv::norm(window.normal);
    height_.assign(1, window.distance);
    index_.assign(1, window.innerIndex);
    height_.insert(height_.end(), window.thickness.begin(), window.thickness.end());
    index_.insert(index_.end(), window.index.begin(), window.index.end());
    outer_ = window.outerIndex;
    refracts_ = !window.thickness.empty() || window.innerIndex != window.outerIndex;
    rarest_ = outer_;
    for (size_t i = 0; i < height_.size(); ++i)
    {
        total_ += height_[i];
        rarest_ = std::min(rarest_, index_[i]);
    }
}

void Layers::traceOut(int n, const double* wx, const double* wy, const double* wz,
                      double* tau, double* dx, double* dy, double* dz, uchar* status) const
{
    const double nx = normal_[0], ny = normal_[1], nz = normal_[2];
    const double inner = index_[0], inner2 = inner*inner, outer2 = outer_*outer_;
    for (int i = 0; i < n; ++i)
    {
        if (!refracts_)
        {
            tau[i] = 0; dx[i] = wx[i]; dy[i] = wy[i]; dz[i] = wz[i];
            continue;
        }
        const double c = nx*wx[i] + ny*wy[i] + nz*wz[i];
        // q^2 = n^2 - p^2 by the cosine: no cancellation near grazing where the medium is the camera's
        const double qOut2 = (outer2 - inner2) + inner2*c*c, qOut = std::sqrt(qOut2);
        bool reflected = !(qOut2 > 0);
        double sum = 0;
        for (size_t k = 0; k < height_.size(); ++k)
        {
            const double n2 = index_[k]*index_[k], q2 = (n2 - inner2) + inner2*c*c, q = std::sqrt(q2);
            reflected = reflected || !(q2 > 0);
            sum += height_[k]*(n2 - outer2)/(q*(q + qOut));
        }
        if (status[i] == REFRACT_OK && !(c > 0))
            status[i] = REFRACT_BEHIND_WINDOW;
        if (status[i] == REFRACT_OK && reflected)
            status[i] = REFRACT_TOTAL_REFLECTION;
        const double along = (qOut - inner*c)/outer_, scale = inner/outer_;
        tau[i] = sum;
        dx[i] = scale*wx[i] + along*nx;
        dy[i] = scale*wy[i] + along*ny;
        dz[i] = scale*wz[i] + along*nz;
    }
}

/* In t = tan(theta) of the rarest medium, n_r sin(theta) = p:

    tan(theta_i) = n_r t / sqrt(n_i^2 + (n_i^2 - n_r^2) t^2)

so f(t) = sum h_i tan(theta_i(t)) - V is increasing and concave, and Newton's method from a point left of the root
rises monotonically to it. Two such points: t = V/U (no medium bends more than the rarest), and what remains when every
denser layer has reached its limit h_i n_r / sqrt(n_i^2 - n_r^2). The unknown is the ratio t/V, regular on the axis. */
uchar Layers::solveTangent(double U, double V, double w, double& ratio) const
{
    const double r2 = rarest_*rarest_, hOut = U - w*total_;
    double rareHeight = 0, limit = 0;
    for (size_t k = 0; k <= height_.size(); ++k)
    {
        const bool last = k == height_.size();
        const double h = last ? hOut : w*height_[k], n = last ? outer_ : index_[k];
        if (n > rarest_)
            limit += h*rarest_/std::sqrt(n*n - r2);
        else
            rareHeight += h;
    }
    if (!(rareHeight > 0) && V >= limit)
        return REFRACT_TOTAL_REFLECTION;    // beyond the cone that total reflection leaves
    ratio = 1/U;
    if (V > limit)
        ratio = std::max(ratio, (V - limit)/(rareHeight*V));

    for (int iteration = 0; iteration < 100; ++iteration)
    {
        const double t2 = V*ratio*V*ratio;
        double f = -1, slope = 0;
        for (size_t k = 0; k <= height_.size(); ++k)
        {
            const bool last = k == height_.size();
            const double h = last ? hOut : w*height_[k], n = last ? outer_ : index_[k], n2 = n*n;
            const double root2 = n2 + (n2 - r2)*t2, term = h*rarest_/std::sqrt(root2);
            f += term*ratio;
            slope += term*n2/root2;
        }
        const double step = -f/slope;
        ratio += step;
        // The sequence rises until rounding takes over: a step that is not positive is below it.
        if (!(step > 4*DBL_EPSILON*ratio))
            return std::isfinite(ratio) ? REFRACT_OK : REFRACT_NOT_CONVERGED;
    }
    return REFRACT_NOT_CONVERGED;
}

void Layers::solveIn(int n, const double* x, const double* y, const double* z, const double* w,
                     double* dx, double* dy, double* dz, uchar* status) const
{
    const double nx = normal_[0], ny = normal_[1], nz = normal_[2];
    const double r2 = rarest_*rarest_, inner2 = index_[0]*index_[0];
    for (int i = 0; i < n; ++i)
    {
        dx[i] = x[i]; dy[i] = y[i]; dz[i] = z[i];
        if (!refracts_ || status[i] != REFRACT_OK)
            continue;
        const double weight = w ? w[i] : 1., U = nx*x[i] + ny*y[i] + nz*z[i];
        if (!(U > weight*total_))
        {
            status[i] = REFRACT_BEHIND_WINDOW;
            continue;
        }
        const double rx = x[i] - U*nx, ry = y[i] - U*ny, rz = z[i] - U*nz;
        const double V = std::sqrt(rx*rx + ry*ry + rz*rz);
        double ratio = 0;
        status[i] = solveTangent(U, V, weight, ratio);
        const double t = V*ratio, kappa = rarest_*ratio/std::sqrt(inner2 + (inner2 - r2)*t*t);
        dx[i] = nx + kappa*rx;
        dy[i] = ny + kappa*ry;
        dz[i] = nz + kappa*rz;
    }
}

/* Implicit differentiation of sum h_i T_i(p) + h_out T_out(p) = V, T_i = p/q_i, dT_i/dp = n_i^2/q_i^3,
dT_i/dn_i = -p n_i/q_i^3, h_out = U - sum h_i; everything is written with rho = p/V, which is regular on the axis. The
direction is n + kappa (X - U n) with kappa = T_in/V. */
uchar Layers::solveInJacobian(const Vec3d& X, Vec3d& direction, double* dX, double* dWindow) const
{
    const int count = parameterCount(), layers = (int)height_.size() - 1;
    if (dWindow)
        std::fill(dWindow, dWindow + 3*count, 0.);
    if (!refracts_)
    {
        direction = X;
        const Matx33d identity = Matx33d::eye();
        std::copy(identity.val, identity.val + 9, dX);
        return REFRACT_OK;
    }

    const Vec3d& n = normal_;
    const double U = n.dot(X);
    const Vec3d radial = X - U*n;
    const double V = cv::norm(radial);
    double ratio = 0;
    const uchar status = U > total_ ? solveTangent(U, V, 1., ratio) : (uchar)REFRACT_BEHIND_WINDOW;
    if (status != REFRACT_OK)
        return status;
    const double t2 = V*ratio*V*ratio, r2 = rarest_*rarest_, c2 = 1/(1 + t2);
    const double rho = rarest_*ratio*std::sqrt(c2);
    const auto q = [&](double index) { return std::sqrt((index*index + (index*index - r2)*t2)*c2); };

    const double inner = index_[0], qIn = q(inner), qOut = q(outer_), hOut = U - total_;
    double S = hOut*outer_*outer_/(qOut*qOut*qOut);
    for (int k = 0; k <= layers; ++k)
        S += height_[k]*index_[k]*index_[k]/std::pow(q(index_[k]), 3);
    const double k0 = rho/qIn, A = inner*inner/(qIn*qIn*qIn)/S;     // A = (dT_in/dp) / S
    const double dU = -A*rho/qOut;                                  // d kappa / dU
    const Vec3d e = radial/std::max(V, DBL_MIN);
    const double bend = A - k0;                                     // V d kappa / dV
    direction = n + k0*radial;

    Matx33d tangent = Matx33d::eye() - n*n.t();
    const Matx33d JX = k0*tangent + (dU*radial)*n.t() + (bend*e)*e.t();
    std::copy(JX.val, JX.val + 9, dX);
    if (!dWindow)
        return status;

    const Matx33d Jn = ((1 - k0*U)*Matx33d::eye() - (k0*n)*X.t() + (dU*radial)*X.t() - (bend*U*e)*e.t())*tangent;
    const auto set = [&](int column, double dKappa)
    {
        for (int r = 0; r < 3; ++r)
            dWindow[r*count + column] = dKappa*radial[r];
    };
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            dWindow[r*count + c] = Jn(r, c);
    for (int k = 0; k <= layers; ++k)                               // distance, thickness
        set(3 + k, -A*rho*(1/q(index_[k]) - 1/qOut));
    for (int k = 1; k <= layers; ++k)                               // index
        set(3 + layers + k, A*rho*height_[k]*index_[k]/std::pow(q(index_[k]), 3));
    const double dInner = inner/(qIn*qIn*qIn);
    set(4 + 2*layers, A*rho*height_[0]*dInner - rho*dInner);        // innerIndex
    set(5 + 2*layers, A*rho*hOut*outer_/(qOut*qOut*qOut));          // outerIndex
    return status;
}

}} // namespace
