// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/wedge_path.hpp"

/* Fermat: of all ways by points P_i on the faces, light takes the one of least optical length

    V = sum n_i |P_(i+1) - P_i|

from the camera to X. As a sum of norms of affine maps of the P_i, V is convex: it has one minimum, which damped Newton steps reach
from anywhere. The minimum is a path of light if it passes the faces in their order; if not, or if it is on the edge where two
faces meet and V has no derivative, there is none. */

namespace cv { namespace refract {

namespace {

Vec3d normalOf(const Face& face) { return Vec3d(face.normal); }

//! The optical vector p before a face from that behind it, or the other way; false: total reflection, or not from behind.
bool passFace(const Face& face, bool outwards, Vec3d& p)
{
    const Vec3d m = normalOf(face);
    const double c = m.dot(p), other2 = c*c + (outwards ? face.excess : -face.excess);
    p += (std::sqrt(std::max(other2, 0.)) - c)*m;
    return c > 0 && other2 > 0;
}

/** From a direction p at the camera to the point P on the last face and the optical vector p behind it.
@return whether light gets there; if not, why */
uchar traceFaces(const TiltedFaces& window, Vec3d& P, Vec3d& p)
{
    P = Vec3d();
    p = window.inner*normalize(p);
    for (int k = 0; k < window.count; k++)
    {
        const Face& face = window.faces[k];
        const double c = normalOf(face).dot(p), s = (face.distance - normalOf(face).dot(P))/c;
        if (!(c > 0 && s >= 0))
            return REFRACT_BEHIND_WINDOW;
        P += s*p;
        if (!passFace(face, true, p))
            return REFRACT_TOTAL_REFLECTION;
    }
    return REFRACT_OK;
}

//! Two unit vectors in the plane of a face.
void axesOf(const Face& face, Vec3d& u, Vec3d& v)
{
    const Vec3d m = normalOf(face);
    u = normalize(Vec3d(1, 0, 0) - m[0]*m);
    v = m.cross(u);
}

class ShortestPath
{
public:
    //! A face through the centre of projection is passed there: it has no unknown point.
    ShortestPath(const TiltedFaces& window, const Vec3d& X) : window_(window), X_(X), first_(window.faces[0].distance > 0 ? 0 : 1)
    {
        for (int k = first_; k < window.count; k++)
        {
            const Face& face = window.faces[k];
            const Vec3d m = normalOf(face);
            const double along = m.dot(X), t = along > face.distance ? face.distance/along : (k + 1.)/(window.count + 1);
            points_.push_back(t*X + (face.distance - t*along)*m);
        }
    }

    /** Where faces meet, V has an edge, and short steps next to it may end anywhere. So it begins with a V that is round there,
    by as much as a layer is thick, and becomes exact by tens. */
    void minimise()
    {
        double thinnest = DBL_MAX;
        for (int k = 1; k < window_.count; k++)
            thinnest = std::min(thinnest, window_.faces[k].distance/window_.faces[k].byHeight
                                          - window_.faces[k - 1].distance/window_.faces[k - 1].byHeight);
        for (double part : { 1., 0.1, 0.01, 0.001 })
        {
            round_ = part*thinnest;
            descend();
        }
        round_ = 0;
        descend();
    }

    //! The optical vector in the medium that the path begins in, which the camera is in or, at a face through it, sees first.
    Vec3d start() const { return indexBefore(first_)*normalize(points_[0]); }
    bool beginsBehindFirstFace() const { return first_ == 1; }

private:
    void descend()
    {
        const int STEPS = 200;
        const double ROUNDING = 1e-9, DONE = 1e-16;     // of where the points are
        const double TOLD = 1e-9, ENOUGH = 1e-4, LEAST = 1e-9;
        double last = DBL_MAX;
        for (int k = 0; k < STEPS; k++)
        {
            const Mat gradient = differentiate();
            Mat step;
            if (!checkRange(gradient) || !solve(hessian_, -gradient, step, DECOMP_CHOLESKY))
                return;
            const double slope = gradient.dot(step), size = norm(points_.back()), here = lengthOf(points_);
            double length = norm(step), part = 1;
            std::vector<Vec3d> next = moved(step);
            // At the end full steps converge, and changes of V drown in rounding.
            for (; -slope > TOLD*size && part > LEAST && !(lengthOf(next) <= here + ENOUGH*part*slope); length *= 0.5)
                next = moved(step*(part *= 0.5));
            if (part <= LEAST)
                return;
            points_ = next;
            if (length <= DONE*size || (length <= ROUNDING*size && length >= 0.5*last))
                return;
            last = length;
        }
    }

    double indexBefore(int face) const { return face > 0 ? window_.faces[face - 1].after : window_.inner; }

    std::vector<Vec3d> moved(const Mat& step) const
    {
        std::vector<Vec3d> next = points_;
        for (size_t i = 0; i < next.size(); i++)
        {
            Vec3d u, v;
            axesOf(window_.faces[first_ + i], u, v);
            next[i] += step.at<double>(2*(int)i)*u + step.at<double>(2*(int)i + 1)*v;
        }
        return next;
    }

    double lengthOf(const Vec3d& way) const { return std::sqrt(way.dot(way) + round_*round_); }

    //! V less that of the straight way to a distant X.
    double lengthOf(const std::vector<Vec3d>& points) const
    {
        double sum = 0;
        for (size_t i = 0; i < points.size(); i++)
            sum += indexBefore(first_ + (int)i)*lengthOf(points[i] - (i > 0 ? points[i - 1] : Vec3d()));
        const Vec3d& P = points.back();
        return sum + window_.outer*P.dot(P - 2*X_)/(lengthOf(X_ - P) + lengthOf(X_));
    }

    //! V by the points' two coordinates on their faces: its gradient, and hessian_.
    Mat differentiate()
    {
        const int count = (int)points_.size();
        Mat gradient = Mat::zeros(2*count, 1, CV_64F);
        hessian_ = Mat::zeros(2*count, 2*count, CV_64F);
        for (int i = 0; i <= count; i++)        // from the point before to point i, the last being X
        {
            const Vec3d way = (i < count ? points_[i] : X_) - (i > 0 ? points_[i - 1] : Vec3d());
            const double n = i < count ? indexBefore(first_ + i) : window_.outer, length = lengthOf(way);
            const Vec3d along = way/length;
            Vec3d axes[4];
            for (int end = 0; end < 2; end++)
                if (i - 1 + end >= 0 && i - 1 + end < count)
                    axesOf(window_.faces[first_ + i - 1 + end], axes[2*end], axes[2*end + 1]);
            for (int a = 0; a < 4; a++)
            {
                const int row = 2*(i - 1) + a, sign = a < 2 ? -1 : 1;
                if (row < 0 || row >= 2*count)
                    continue;
                gradient.at<double>(row) += sign*n*along.dot(axes[a]);
                for (int b = 0; b < 4; b++)
                {
                    const int column = 2*(i - 1) + b;
                    if (column >= 0 && column < 2*count)
                        hessian_.at<double>(row, column) += sign*(b < 2 ? -1 : 1)*n/length
                                                            *(axes[a].dot(axes[b]) - along.dot(axes[a])*along.dot(axes[b]));
                }
            }
        }
        return gradient;
    }

    const TiltedFaces& window_;
    Vec3d X_;
    int first_;
    std::vector<Vec3d> points_;
    double round_;              //!< lengths are sqrt(l^2 + round^2)
    Mat hessian_;
};

//! Of an infinitely far point the direction behind the window is known.
uchar followInfinity(const TiltedFaces& window, const Vec3d& X, Vec3d& direction)
{
    direction = window.outer*normalize(X);
    for (int k = window.count - 1; k >= 0; k--)
        if (!passFace(window.faces[k], false, direction))
            return REFRACT_TOTAL_REFLECTION;
    return statusOfDirection(window, direction);
}

} // namespace

uchar statusOfDirection(const TiltedFaces& window, const Vec3d& direction)
{
    Vec3d p = direction, P;
    return traceFaces(window, P, p);
}

uchar findWedgePath(const TiltedFaces& window, const Vec3d& X, double w, Vec3d& direction)
{
    const Face& last = window.faces[window.count - 1];
    if (!(normalOf(last).dot(X) > w*last.distance))
        return REFRACT_BEHIND_WINDOW;
    if (w == 0)
        return followInfinity(window, X, direction);
    ShortestPath path(window, X/w);
    path.minimise();
    direction = path.start();
    if (path.beginsBehindFirstFace() && !passFace(window.faces[0], false, direction))
        return REFRACT_TOTAL_REFLECTION;
    // The shortest way may go round an edge where faces meet: then no ray of light does.
    const double NEAR = 1e-9;
    Vec3d P, p = direction;
    const uchar status = traceFaces(window, P, p);
    const Vec3d way = X/w - P;
    return status != REFRACT_OK || norm(way.cross(p)) <= NEAR*window.outer*norm(X/w) ? status : (uchar)REFRACT_BEHIND_WINDOW;
}

}} // namespace
