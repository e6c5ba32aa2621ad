// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_HPP
#define OPENCV_REFRACT_KERNELS_HPP

/* The inner loops, over blocks of structure-of-arrays: written once (kernels_*.hpp), compiled for every instruction set
(kernels_baseline.cpp, kernels_avx2.cpp, kernels_avx512.cpp), chosen at run time (kernels.cpp).

A kernel computes what is regular. It returns true if all lanes have an answer; a lane that has none, or none yet, is NaN
in the kernel's first output, and the caller, who has all the time in the world, finds out why. NaN lanes pass through.

No OpenCV in here: an inline function of another header, compiled for AVX-512 and kept by the linker, would run on
machines that do not have it. */

namespace cv { namespace refract {

//! Gap and layers of one index, and whether the scene is of this index too.
struct Medium
{
    double height;      //!< of gap and layers together, as `scale` has it
    bool isScene;       //!< the scene's medium: its height, which varies from point to point, comes on top
    double scale;       //!< the rarest index, for the rarest medium 1: its height is taken as it is
    double index2;      //!< index^2
    double slope;       //!< of tan(theta) by the tangent in the rarest medium at 0, over `scale`
    double limit;       //!< tan(theta) at grazing in the rarest medium, over `scale`
};

//! Parallel layers as the kernels see them.
struct Stack
{
    double normal[3];
    bool refracts;              //!< false: no window, nothing below counts
    double total;               //!< sum of the heights
    double inner, outer;        //!< index of the camera's and the scene's medium
    double rarest;              //!< the smallest index
    const Medium* media;        //!< the rarest first
    int count;
    const double *heights, *indices;    //!< the gap, then the layers, as given
    int layers;                 //!< how many heights
};

/** Where a matrix of each lane goes, one array for each element: element (r, c) of lane i is at(r, c)[i]. With stride 1 that
is one lane's matrix, row-major. */
struct Columns
{
    double* data;       //!< null: not wanted
    int perRow;         //!< columns of a row
    int stride;         //!< from one array to the next
    double* at(int r, int c) const { return data + (r*perRow + c)*stride; }
    //! The same rows from column c on.
    Columns from(int c) const { const Columns rest = { data ? data + c*stride : nullptr, perRow, stride }; return rest; }
};

//! Positions in OpenCV's order of coefficients.
enum { K1, K2, P1, P2, K3, K4, K5, K6, S1, S2, S3, S4, TAUX, TAUY, DIST_COEFFS };

//! Terms of the polynomial that guesses a lens's inverse radial function.
enum { TERMS = 7, ROUGH_TERMS = 3 };

//! OpenCV's lens model as the kernels see it.
struct OpenCVModel
{
    double fx, fy, cx, cy;
    double k[DIST_COEFFS];
    double sMax;                //!< square of the radius where the radial part stops growing
    bool rational, prism, tilted;       //!< whether D, s1 ... s4, the tilt do anything
    double tilt[9];
    double untilt[9];                   //!< homography: pixels, from the principal point -> distorted points without tilt
    double dTilt[2][9];                 //!< derivatives of tilt by tau_x, tau_y
    int given;                          //!< how many coefficients are parameters
    double inverse[TERMS];      //!< r = rd (1 + rd^2 (inverse[0] + rd^2 (...))): where the search begins
    double rough[ROUGH_TERMS];  //!< the same, good to as much as is not radial
    int shifts;                 //!< how often that start is shifted for what is not radial
    double sNear, near2;        //!< where r^2 and the square of a Newton step are smaller, the step's error is nothing
};

//! cv::fisheye's model.
struct FisheyeModel
{
    double fx, fy, cx, cy, alpha;
    double k[4];
    double thetaMax;
    double inverse[TERMS];      //!< of theta in theta_d, as above
};

//! Nodes of a tile of a map, in each direction.
enum { NODES = 8 };

struct Kernels
{
    const char* instructions;

    //! n interleaved points of 2 (z null) or 3 coordinates -> arrays; true if all are finite.
    bool (*load)(const void* points, bool isFloat, int n, double* x, double* y, double* z);
    void (*store)(void* points, bool isFloat, int n, const double* x, const double* y, const double* z);

    //! In place: X -> R X + t, R row-major.
    void (*transform)(const double* R, const double* t, int n, double* x, double* y, double* z);
    //! (x, y, z) = factor v
    void (*multiples)(const double* v, int n, const double* factor, double* x, double* y, double* z);
    //! X -> (x, y) = H X, dehomogenised; no answer unless axis.X > 0.
    bool (*pinhole)(const double* H, const double* axis, int n, const double* x, const double* y, const double* z,
                    double* u, double* v);
    //! See meetPlane; plane (a, b, c) and d of each lane.
    bool (*meetPlane)(const Stack& stack, const double* abc, const double* planeD, int n, const double* tau,
                      const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu);

    //! Of each of n pixels between others, n + 2 in all: the square root of its distance from its neighbours' chord.
    void (*chordRoots)(int n, const double* u, const double* v, double* roots);
    /** Whether the chord of each of n segments of a curve (n + 1 ends) is within the tolerance of it. Its distance across the
    chord is about (1 - p^2) (middle + skew p), -1 <= p <= 1 by t: the middle and the next one tell (n + 1 middles); and at
    most middle + skew^2/(4 middle) and middle + 0.385 skew.
    @param slack what is left of the tolerance; no answer where the chord is not close, or the middle is NaN */
    bool (*areClose)(int n, double tolerance, const double* t, const double* u, const double* v, const double* tMiddle,
                     const double* uMiddle, const double* vMiddle, double* slack);

    // See Layers and Lens.
    bool (*traceOut)(const Stack& stack, int n, const double* wx, const double* wy, const double* wz,
                     double* tau, double* dx, double* dy, double* dz);
    bool (*solveIn)(const Stack& stack, int n, const double* x, const double* y, const double* z, const double* w,
                    double* dx, double* dy, double* dz, double* ratio);
    void (*chainWindow)(const Stack& stack, int rows, int n, const double* x, const double* y, const double* z,
                        const double* ratio, const Columns& byDirection, const Columns& byPoint, const Columns& byWindow);
    //! Two rows by the point -> the one column of each by the parameter of A, whose point moves by A X.
    void (*chainLinear)(const double* A, int n, const double* x, const double* y, const double* z, const Columns& byPoint,
                        const Columns& out);
    //! out[i] = sum over r, c of row[r] values[NODES r + c] columns[n c + i]
    void (*interpolate)(const double* values, const double* row, const double* columns, int n, double* out);
    /** One Gauss-Newton step of points (in the frame of camera 1) towards least squared pixel errors in two images.
    @param R rotation of camera 2
    @param observed, predicted 4x1: u1, v1, u2, v2
    @param byPoint1, byPoint2 derivatives of the predicted pixels, each in the frame of its camera
    @param moved square of the pixels that the step moves the predictions */
    void (*gaussNewton)(int n, const double* R, const Columns& observed, const Columns& predicted, const Columns& byPoint1,
                        const Columns& byPoint2, double* x, double* y, double* z, double* moved);
    bool (*projectOpenCV)(const OpenCVModel& lens, int n, const double* x, const double* y, const double* z,
                          double* u, double* v);
    bool (*unprojectOpenCV)(const OpenCVModel& lens, int n, const double* u, const double* v,
                            double* x, double* y, double* z);
    bool (*projectJacobianOpenCV)(const OpenCVModel& lens, int n, const double* x, const double* y, const double* z,
                                  double* u, double* v, const Columns& byDirection, const Columns& byParameters);
    bool (*projectFisheye)(const FisheyeModel& lens, int n, const double* x, const double* y, const double* z,
                           double* u, double* v);
    bool (*unprojectFisheye)(const FisheyeModel& lens, int n, const double* u, const double* v,
                             double* x, double* y, double* z);
    bool (*projectJacobianFisheye)(const FisheyeModel& lens, int n, const double* x, const double* y, const double* z,
                                   double* u, double* v, const Columns& byDirection, const Columns& byParameters);
};

//! The fastest that this machine runs (OPENCV_CPU_DISABLE=AVX512-SKX,AVX2 in the environment leaves levels out).
const Kernels& kernels();

// One for each level; null where the compiler was not told to compile for it.
const Kernels* kernelsBaseline();
const Kernels* kernelsAvx2();
const Kernels* kernelsAvx512();

}} // namespace

#endif // OPENCV_REFRACT_KERNELS_HPP
