// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LAYERS_HPP
#define OPENCV_REFRACT_LAYERS_HPP

#include "precomp.hpp"
#include "window/curved_kernels.hpp"
#include "window/dome_kernels.hpp"
#include "window/faces.hpp"
#include "window/layer_kernels.hpp"
#include "window/rays.hpp"
#include "window/surface.hpp"

namespace cv { namespace refract {

/* The physics of layers. With n the unit normal, c = n.w the cosine of the inner direction w, and
p = n_inner sin(theta_inner), which Snell's law keeps through all layers, and q_i = sqrt(n_i^2 - p^2):

    tau(p) = sum_i h_i (1 - q_out / q_i)

is where the outgoing line meets the axis O + tau n. (A gap whose medium is the scene's is left out, as it has no part in it; of
the others, what cancels is the rounding of h_i.) The way back is in path.hpp.
For one pane in air: equations (12) and (16) of Plate2024.

Faces that are not parallel (GlassWindow::wedge), domes, and tubes with bent panes have kernels of their own, chosen once per call:
wedge.simd.hpp, dome.simd.hpp, curved.simd.hpp.

The kernels work on blocks of structure-of-arrays. A lane whose status is not REFRACT_OK on entry keeps its status; its
results are not meaningful. */
class Layers
{
public:
    explicit Layers(const GlassWindow& window = GlassWindow());
    Layers(const Layers& other) { *this = other; }
    Layers& operator=(const Layers& other);

    //! False: no window; directions pass unchanged and origins are the centre of projection.
    bool refracts() const { return stack_.refracts; }

    //! Inner directions (unit) -> rays outside.
    void traceOut(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const;

    /** Homogeneous scene points (x, y, z, w), w >= 0 (0 = infinitely far; null = all 1) -> inner directions, not unit:
    n + kappa (X - (n.X) n). Domain: beyond the last surface.
    @param ratio what chain() wants to know of the paths; may be null */
    void solveIn(int n, const double* x, const double* y, const double* z, const double* w,
                 double* dx, double* dy, double* dz, uchar* status, double* ratio = NULL) const;

    //! Where the columns of a derivative by the window stand.
    const WindowLayout& at() const { return stack_.at; }

    /** Chain rule through solveIn for finite points: two or three rows of derivatives by the direction -> by the point (3 columns)
    and by the window (at().count columns, by the *unnormalised* normal; may be null).
    @param dx, dy, dz, ratio as solveIn gave them */
    void chain(int rows, int n, const double* x, const double* y, const double* z, const double* dx, const double* dy,
               const double* dz, const double* ratio, const Columns& byDirection, const Columns& byPoint,
               const Columns& byWindow) const;

    //! True where the homogeneous point lies beyond the last surface (always true without window).
    bool isBeyond(double x, double y, double z, double w = 1.) const
    { return !stack_.refracts || refract::isBeyond(last_, x, y, z, w) || comesRoundEdge(x, y, z, w); }

    //! 1/s at which a ray leaves the last surface (infinity without window): it exists for smaller 1/s.
    double leavingMu(const Rays& rays, int i) const;

    //! Along the axis that all rays meet: of a dome, that through its centre. Those of a tube miss it: across its axis, ahead.
    const Vec3d& normal() const { return normal_; }
    //! The last surface, camera frame; without window it means nothing.
    const Surface& lastSurface() const { return last_; }
    //! Origins of rays are off the axis.
    bool hasOffsets() const { return isTilted_ || isCurved_; }
    const TiltedFaces& tilted() const { return tilted_; }

    //! The layers as the kernels see them; it lives as long as this object.
    const Stack& stack() const { return stack_; }

private:
    void setWedge(const GlassWindow& window);
    void setDome(const GlassWindow& window);
    void setTube(const GlassWindow& window);
    void setBent(const GlassWindow& window);
    void pointIntoVectors();    //!< where stack_ has pointers
    //! One lane that the kernel left without an answer: the answer, or why there is none.
    uchar solveOne(const Vec3d& X, double w, double* d, double& ratio) const;
    void traceOutTilted(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const;
    void solveInTilted(int n, const double* x, const double* y, const double* z, const double* w,
                       double* dx, double* dy, double* dz, uchar* status) const;
    void traceOutDome(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const;
    void solveInDome(int n, const double* x, const double* y, const double* z, const double* w,
                     double* dx, double* dy, double* dz, uchar* status) const;

    void traceOutCurved(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const;
    /** Behind a pane that bends towards the camera: what the straight way past its sphere does not show, light that the pane bends may.
    It leaves from the tangent plane of the last face on, and away from it. */
    bool comesRoundEdge(double x, double y, double z, double w) const;
    bool mayComeRoundEdge(double x, double y, double z, double w) const;
    void solveInCurved(int n, const double* x, const double* y, const double* z, const double* w,
                       double* dx, double* dy, double* dz, uchar* status) const;

    Vec3d normal_;
    std::vector<double> height_;    //!< inner gap, then the layers
    std::vector<double> index_;     //!< of the same
    std::vector<Medium> media_;     //!< the same by index, the rarest first
    /* Not made anew for every call of a kernel: to read, as a whole, what was just written in parts, a processor waits until
    everything written before has reached memory. */
    Stack stack_;
    Surface last_;
    bool isTilted_, isDome_, isCurved_;
    std::vector<Face> faces_;       //!< of a bent pane those that touch its faces; else empty where the window's wedge is
    TiltedFaces tilted_;            //!< they as the kernels see them
    std::vector<Sphere> spheres_;   //!< of a dome that refracts
    Dome dome_;                     //!< they as the kernels see them
    std::vector<CurvedFace> curvedFaces_;   //!< of a tube or a bent pane that refracts
    CurvedFaces curved_;            //!< they as the kernels see them
};

}} // namespace

#endif // OPENCV_REFRACT_LAYERS_HPP
