// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_HPP
#define OPENCV_REFRACT_HPP

#include "opencv2/core.hpp"

#define CV_REFRACT_VERSION_MAJOR 0
#define CV_REFRACT_VERSION_MINOR 2
#define CV_REFRACT_VERSION_PATCH 0
//! As "0.2.0". Standalone packages and the tools have the same number.
#define CV_REFRACT_VERSION CVAUX_STR(CV_REFRACT_VERSION_MAJOR) "." CVAUX_STR(CV_REFRACT_VERSION_MINOR) "." \
                           CVAUX_STR(CV_REFRACT_VERSION_PATCH)

/**
@defgroup refract Cameras that look through a flat window

A camera behind a flat window (safety glass, the port of a pressure vessel, the wall of an aquarium) is not a pinhole camera.
The window shifts every ray. It also bends the ray if the media on its two sides are different. This module projects,
unprojects, undistorts, matches, triangulates and calibrates such cameras. Its calls are those that calib3d has for cameras
without a window.

### Conventions

- **Camera frame**: x right, y down, z forward; pixel (0, 0) is the centre of the top-left pixel. `rvec`, `tvec`
  map object to camera coordinates. Stereo `R`, `T` map camera 1 to camera 2: \f$X_2 = R X_1 + T\f$.
- **Length**: the caller's unit. Thickness, distance, object points and results share it. Angles are radians.
- **Window**: see GlassWindow. **Ray**: origin + s * direction, direction of unit length, s grows into the scene;
  the origin lies on the axis through the centre of projection along the window's normal, origin = tau * normal.
  Behind a window with a wedge or a curvature the ray misses the axis by little, and the origin is a point of the ray near it.
  Behind a dome the axis is the one through the dome's centre. Behind a tube the origin is a point of the ray near the camera.
- **Points without a solution**: such a point becomes NaN in every output coordinate, and `status` (CV_8U, one per point, see
  RefractiveStatus) gives the reason. One bad point never throws and never changes the others. Only the object points of poses
  and calibrations must be finite.
- **Errors**: a bad *argument* (wrong type, shape or size, non-finite parameter, non-unit normal, thickness < 0,
  index < 1) throws cv::Exception. Its text gives the name of the argument and its value. Empty arrays of points, pixels or
  disparities give empty output; only calibrations and bundle adjustment refuse them. Those without an answer throw
  CalibrationError, a cv::Exception too.
- **Without Ceres**: calibrateGlass, stereoCalibrateGlass, calibrateGlassRig, selectLensCoefficients and refractiveBundleAdjust
  need Ceres. In a build without it they throw with the code Error::StsNotImplemented, and the text says what to install. All
  other functions work.
- **Arrays**: points as in calib3d: Nx1 or 1xN with 2 (3) channels, Nx2 (Nx3) with one channel, 2xN (3xN) with one
  channel (2x2 and 3x3 are a point a row), std::vector; float32 or float64; non-continuous views included, as inputs and
  as outputs. Computation is in double. Outputs are Nx1 with channels and have the input's depth (of float32 and float64:
  float64) unless the caller fixed the type; a caller's array of one row keeps that shape. Depths of the scene (z) may have any
  type of numbers. Rotations of several cameras: std::vector of Mat or Matx33d, or rotation vectors (as a result, too, in a
  std::vector<Vec3d>). Of a rotation matrix the norm of R R^T - I may be 1e-3, as of one that is printed with four decimals:
  the nearest rotation is taken.
- **Object coordinates** may have any origin, except where poses are known in part: survey coordinates lose no more than their
  own rounding.
- **Infinity**: where a far end may be infinite, DBL_MAX or more also means infinity.
- **Half pixels**: triangulateRefractive for any number of cameras, refractiveSolvePnP, refractiveSolvePnPGeneric,
  calibrateGlassRig and refractiveBundleAdjust take pixels of which one coordinate is NaN: observations of the other one. So a
  laser line, a fringe projector and a line camera are cameras, each behind its own window: a sheet of light is what one image
  line of its emitter sees, (u, NaN). Both coordinates NaN: not seen. All other calls take a NaN coordinate as not seen.
- **Covariances of pixels** (`pixelCovariances`): of each pixel, in units of the square of the pixels' standard deviation (which
  is an argument, or estimated), so that 1, 0, 1 is a usual pixel. N x 4 or Nx1 with 4 channels (2x2 row by row; NumPy: N x 2 x
  2), or N x 3 or Nx1 with 3 channels (uu, uv, vv); float32 or float64. Of a half pixel only the variance of the known
  coordinate is read; of one that was not seen, nothing. Empty: all pixels are usual ones.
- **Covariances of what is known** (`cameraCovariances`, `rigCovariance`, `poseCovariances`, `targetCovariance`; those that are
  propagated, `calibrationCovariance` and `cameraCovariance`, too) obey one rule. They are symmetric and positive semidefinite,
  except for the rounding of printed numbers, and are refused with their name and numbers otherwise. They may be singular: then
  a combination is known. A variance of 0: the quantity is exactly as given. There are two exceptions: of a window in
  cameraCovariances, and of all that rigCovariance is of, a variance of 0 leaves it to the flags whether it is estimated. A
  variance of NaN: nothing is known of it, and its row and column are not read (what is propagated must be known).
  `lengthScaleStd`, and the standard deviation of a length, may be NaN, too. Of `cameraCovariances` the blocks of
  the lens, of the window (its normal or center and axis, its distance, its media), and of R and T are read, not the
  correlations between these: `rigCovariance` has them all.
- **Messages**: the library writes none, but for the iterations of each fit where OpenCV's log has the level INFO. While it
  solves, what Ceres' logger (glog) has below FATAL is muted, in all threads.

### The model

Let n be the unit normal, w the inner direction and c = n.w. By Snell's law \f$p = n_{inner}\sin\theta_{inner}\f$ is the same
in all layers. With \f$q_i = \sqrt{n_i^2 - p^2}\f$ the outgoing ray meets the axis at
\f[ \tau(p) = \sum_i h_i \left(1 - q_{out}/q_i\right) \f]
(inner gap and all layers). For one pane in air this is equations (12) and (16) of @cite Plate2024.

Faces that are not parallel (GlassWindow::wedge) have unit normals m_i of their own. With the optical vector
\f$p_i = n_i w_i\f$ of each medium, light goes out by \f$p_{i+1} = p_i + \gamma_i m_i\f$ (Snell's law in vector form);
the path from a point to the camera is the one of least optical length.

A dome's faces are spheres about one point S (GlassWindow::dome). From there, the moment \f$L = r \times p\f$ is the same in all
media, so a face of radius r_k turns the ray about L by
\f[ \arcsin\frac{|L|}{n_{k+1} r_k} - \arcsin\frac{|L|}{n_k r_k} \f]

A tube's faces are cylinders about one axis a (GlassWindow::tube). Along it \f$k = n\,w \cdot a\f$ is the same in all media, and
across it a ray is one in a dome whose media have the indices \f$\sqrt{n_i^2 - k^2}\f$.

@{
    @defgroup refract_camera Windows and cameras
    @defgroup refract_points Pixels, rays and points
    @defgroup refract_stereo Dense stereo
    @defgroup refract_calibrate Calibration
    @defgroup refract_pose Poses
@}
*/

namespace cv { namespace refract {

//! @addtogroup refract
//! @{

//! Why a point has no solution. 0: it has one.
enum RefractiveStatus {
    REFRACT_OK = 0,
    REFRACT_NOT_FINITE = 1,         //!< the input point (or its depth) is NaN or infinite
    REFRACT_BEHIND_CAMERA = 2,      //!< behind a camera without a window (or, after R, behind the rectified one)
    REFRACT_BEHIND_WINDOW = 3,      //!< before or inside the window, so also behind the camera; or no ray reaches it
    REFRACT_TOTAL_REFLECTION = 4,   //!< no light path exists: total reflection in a layer
    REFRACT_OUTSIDE_LENS_MODEL = 5, //!< outside the range where the lens model is one-to-one
    REFRACT_NOT_CONVERGED = 6,      //!< the iteration did not reach its tolerance
    REFRACT_PARALLEL_RAYS = 7,      //!< all rays, or the ray and the plane, or sheet, are parallel
    REFRACT_NO_INTERSECTION = 8,    //!< the closest point of the rays, or of ray and plane, is behind an origin
    REFRACT_TOO_FEW_VIEWS = 10      //!< fewer than three coordinates were observed (9 is used by refract_measure)
};

//! @}

//! @addtogroup refract_points
//! @{

//! Flags of triangulateRefractive
enum TriangulateFlags {
    TRIANGULATE_OPTIMAL = 0,        //!< maximum likelihood under equal isotropic pixel noise in all images
    TRIANGULATE_MIDPOINT = 1        //!< least squared distance from all rays; of two, the midpoint of the shortest segment
};

//! @}

//! @addtogroup refract_stereo
//! @{

//! Flags of refractiveStereoRectify
enum RectifyFlags {
    RECTIFY_ZERO_DISPARITY = 1024   //!< both new images have one principal point; cv::CALIB_ZERO_DISPARITY's value
};

//! @}

//! @addtogroup refract_calibrate
//! @{

/** @brief Flags of calibrateGlass, stereoCalibrateGlass, calibrateGlassRig, selectLensCoefficients and
refractiveBundleAdjust. The place of a window is free unless GLASS_FIX_NORMAL is set: a pane's normal, a dome's centre, a
tube's centre and axis. A flag whose parameter a window does not have is refused: a dome has no distance and no wedge, a pane
no radius. The values are not those of cv::CALIB_..., and must not be mixed with them. With GLASS_FREE_INTRINSICS the
coefficients that the lens has are estimated, also if they are 0 at the start: a lens without coefficients stays without
distortion, one with 4 gets k1, k2, p1, p2, and so on. A GLASS_FIX_... flag keeps a parameter at its initial value, as
CALIB_FIX_... does in cv::calibrateCamera and cv::fisheye::calibrate. If the lens does not have the parameter, the flag has no
effect. A rig is called sealed if GLASS_FREE_INTRINSICS is set and all observations are images through the windows: no direct
image, no known pose, no known camera. Lens, window and pose are then strongly correlated, but measured lengths hardly depend
on these correlated directions. Each parameter is returned with its large standard deviation and the full covariance. The
calibration is refused for this only if a GLASS_REQUIRE_... flag is set. If the rig is not sealed, each free parameter must be
determined by itself.
*/
enum GlassCalibrationFlags {
    GLASS_FREE_THICKNESS = 1,       //!< thickness of every layer
    GLASS_FREE_INDEX = 2,           //!< index of every layer
    GLASS_FREE_DISTANCE = 4,        //!< distance; an error with equal media and parallel plane faces: no effect
    GLASS_FREE_OUTER_INDEX = 8,     //!< index of the scene's medium
    GLASS_FREE_INTRINSICS = 16,     //!< all lens parameters (overloads with RefractiveCamera only)
    GLASS_FREE_EXTRINSICS = 32,     //!< R and T (stereoCalibrateGlass, calibrateGlassRig, refractiveBundleAdjust)
    GLASS_SHARED_WINDOW = 64,       //!< both cameras look through one pane (stereoCalibrateGlass only)
    GLASS_FIX_PRINCIPAL_POINT = 128,    //!< with GLASS_FREE_INTRINSICS: cx and cy stay
    GLASS_ROBUST = 256,             //!< reject outliers, points and images; without: maximum likelihood of all points
    GLASS_USE_POSES = 512,          //!< the views' poses are known (long forms of calibrateGlassRig and refractiveBundleAdjust)
    GLASS_FIX_FOCAL_LENGTH = 1024,  //!< fx and fy stay
    GLASS_FIX_K1 = 2048,            //!< k1 stays; the other GLASS_FIX_K alike (a fisheye lens has k1 to k4)
    GLASS_FIX_K2 = 4096,
    GLASS_FIX_K3 = 8192,
    GLASS_FIX_K4 = 16384,
    GLASS_FIX_K5 = 32768,
    GLASS_FIX_K6 = 65536,
    GLASS_FIX_TANGENT_DIST = 131072,    //!< p1 and p2 stay
    GLASS_FIX_S1_S2_S3_S4 = 262144,     //!< the thin prism's coefficients stay
    GLASS_FIX_TAUX_TAUY = 524288,       //!< the sensor's tilt stays
    GLASS_FIX_NORMAL = 1048576,         //!< places of windows stay unless a covariance frees them (rigs, bundles only)
    GLASS_REQUIRE_WINDOW = 2097152,     //!< refuse a sealed rig if a free parameter of a window is not determined by itself
    GLASS_REQUIRE_INTRINSICS = 4194304, //!< the same of a lens; of a focal length by boards without a window, to 10 %
    GLASS_REQUIRE_EXTRINSICS = 8388608, //!< the same of R and T
    GLASS_FREE_WEDGE = 16777216,        //!< wedge of every layer; a window without one gets one, starting at 0
    GLASS_FREE_RADIUS = 33554432,       //!< radius of a dome or tube
    GLASS_FREE_CURVATURE = 67108864     //!< curvature of a pane; a flat window becomes a bent one, starting at 0
};

//! How calibrateGlassRig or stereoCalibrateGlass used one image
enum GlassImageStatus {
    GLASS_IMAGE_USED = 0,           //!< used, except the points that inliers marks 0
    GLASS_IMAGE_ABSENT = 1,         //!< not taken, or no point seen
    GLASS_IMAGE_MOVED = 2,          //!< rejected: its target was moved, compared with the view's other images
    GLASS_IMAGE_UNUSABLE = 3        //!< rejected: fewer than a third of its points, or fewer than 4, fit one pose
};
#ifndef OPENCV_BINDINGS_PARSER      // other languages have exceptions of their own
/** @brief Why calibrateGlass, stereoCalibrateGlass, calibrateGlassRig, selectLensCoefficients, refractiveBundleAdjust or
calibrateGlassNormal has no answer for these data. A program in C++ acts on `cause` and need not read the text.

It is a cv::Exception with a code and a text as usual. In Python it is cv2.error; that of the package opencv_refract has the
members below as attributes, the cause by its name. An argument of the wrong type, size or value
throws a plain cv::Exception.
*/
class CV_EXPORTS CalibrationError : public Exception
{
public:
    //! Why there is no answer.
    enum Cause {
        /** the iterations of criteria were not enough: give more, or fix what is hardly determined; or `point` of `view`
        touches the window of `camera` where the error is least: check the window, the target's size, the units */
        NOT_CONVERGED = 0,
        UNDETERMINED = 1,       //!< the data do not determine a free parameter: fix it, or take other views
        POSE_UNDETERMINED = 2,  //!< the scene's points do not determine the pose of `view`: leave it out, or add points
        TOO_FEW_INLIERS = 3,    //!< fewer than half of the points fit, or too few to go on
        TOO_FEW_POINTS = 4,     //!< fewer equations than unknowns: take more points or views
        NO_SCALE = 5,           //!< nothing tells the scale of the scene: give a length, or a pose
        NO_POSE = 6,            //!< the target of `view` has no pose that fits its points
        NO_IMAGE = 7,           //!< `point` of `view` has no image in `camera` with the initial values: these are wrong
        WINDOW_NOT_SEEN = 8,    //!< no point was seen through the window of `camera`
        LOOKS_AWAY = 9,         //!< `camera` looks away from the window that it shares
        BEYOND_WINDOW = 10,     //!< `camera` is on the far side of the window that it shares
        PAIRS_SWAPPED = 11,     //!< direct and refracted images are exchanged
        PAIRS_CONTRADICT = 12   //!< the two images of a pair do not show the same unmoved target
    };

    //! The code follows from the cause.
    CalibrationError(Cause cause, const String& err, const String& reason);
    virtual ~CalibrationError();

    Cause cause;                //!< for a program, which need not read the text
    String reason;              //!< the part of err that says what was found, for a program that gives its own advice
    int view;                   //!< index of the view to blame; -1: none
    int camera;                 //!< index of the camera to blame; -1: none
    int point;                  //!< index of the point in its view; -1: none
};
#endif
//! @}

//! @addtogroup refract_camera
//! @{

//! What a window's faces are.
enum WindowShape {
    WINDOW_FLAT = 0,            //!< planes
    WINDOW_DOME = 1,            //!< spheres about one point
    WINDOW_TUBE = 2,            //!< circular cylinders about one axis
    WINDOW_BENT = 3             //!< a pane that is slightly bent: as flat, with a curvature
};

/** @brief A window: layers between planes that share a normal, spheres that share a centre, or cylinders that share an axis.

No layer and equal inner and outer index = no window = plain OpenCV.

A **flat** window has `normal` and `distance`. A **dome** (GlassWindow::dome) has `center` and `radius` in their place, and the
camera is anywhere inside. If it is in the centre, no ray is refracted: the dome has no effect, and neither its radius nor its
indices can be found from images. A **tube** (GlassWindow::tube) has the `axis` beside them; a ray along the axis never leaves,
and has no answer. A **bent** window is a flat one with a `curvature`: tempered plate bows by 1 to 3 mm a metre, which is a
sphere of some 40 to 100 m (a bow of b over the length l is a curvature of 8 b/l^2).

Faces that are not quite parallel have a `wedge`. Data sheets state up to 3 arc minutes for commercial panes and nothing for
tempered glass. At range z a wedge d looks like a tilt of the pane by index z d/thickness.

The first face has `normal`. With e1, the camera's x axis made orthogonal to the normal, and e2 = normal x e1, the outer face of
layer i leans by the sum W = wedge[0] + ... + wedge[i] against the first one: its normal is the first one's, turned by the angle
|W| in the direction W1 e1 + W2 e2,
\f[ m = \cos|W|\,n + \frac{\sin|W|}{|W|}\,(W_1 e_1 + W_2 e_2) \f]
so that neither the order of the two components nor that of the layers matters. A positive component turns the normal of the
outer face towards its axis: the layer gets thinner there. Thickness is measured along the normal through the centre
of projection. If two faces intersect before the ray has passed both, the point has no solution.

The indices are those of one colour of light. Where `materials` says what the media are, atWavelength() is the same window in
another colour. In water, blue and red are 3 to 6 px apart at the edge of a wide port.
*/
class CV_EXPORTS_W_SIMPLE GlassWindow
{
public:
    //! No window: flat, without layers, normal (0, 0, 1), both indices 1; everything else is 0.
    CV_WRAP GlassWindow();

    /** @brief One pane, the camera in air.
    @param normal from the camera to the scene, camera coordinates; it is normalised.
    @param thickness of the pane, >= 0; 0 is a pane without effect.
    @param index of the pane, >= 1.
    @param distance from the centre of projection to the pane, along the normal, >= 0.
    @param outerIndex index of the scene's medium, >= 1 (1.33 water).
    */
    CV_WRAP GlassWindow(const Vec3d& normal, double thickness, double index,
                        double distance = 0., double outerIndex = 1.);

    /** @brief A dome of one layer, the camera in air.
    @param center of the spheres, camera coordinates; nearer to the camera than the radius.
    @param radius of the inner face.
    @param thickness of the dome, >= 0.
    @param index of the dome, >= 1.
    @param outerIndex index of the scene's medium, >= 1 (1.33 water).
    */
    CV_WRAP static GlassWindow dome(const Vec3d& center, double radius, double thickness, double index, double outerIndex = 1.);

    /** @brief A tube of one layer, the camera in air.
    @param axisPoint any point of the axis, camera coordinates; the window keeps the one that is nearest to the camera.
    @param axisDirection of the axis, either way; it is normalised.
    @param radius of the inner face; larger than the axis' distance from the camera.
    @param thickness of the tube, >= 0.
    @param index of the tube, >= 1.
    @param outerIndex index of the scene's medium, >= 1 (1.33 water).
    */
    CV_WRAP static GlassWindow tube(const Vec3d& axisPoint, const Vec3d& axisDirection, double radius, double thickness,
                                    double index, double outerIndex = 1.);

    CV_PROP_RW int shape;                      //!< a WindowShape; what only other shapes have must keep its initial value
    CV_PROP_RW Vec3d normal;                   //!< flat, bent: unit, camera coordinates, normal[2] > 0
    CV_PROP_RW double distance;                //!< flat, bent: from the camera to the first surface, along the normal
    /** dome: of the spheres; tube: a point of the axis, after a calibration the one nearest to the camera; camera frame */
    CV_PROP_RW Vec3d center;
    CV_PROP_RW Vec3d axis;                     //!< tube: unit direction of the axis, camera coordinates
    CV_PROP_RW double radius;                  //!< dome, tube: of the inner face; layers add to it
    /** Bent: 1/radius of the first face, a sphere across the normal that meets it at the distance; positive where its centre is
    on the camera's side. The other faces are spheres about the same point. 0: planes. */
    CV_PROP_RW double curvature;
    CV_PROP_RW std::vector<double> thickness;  //!< of each layer, from the camera outwards, >= 0; > 0 with a wedge
    CV_PROP_RW std::vector<double> index;      //!< of each layer
    CV_PROP_RW double innerIndex;              //!< of the medium round the camera
    CV_PROP_RW double outerIndex;              //!< of the scene's medium
    /** Of each layer: the angle between its outer and its inner face, radians along e1 and e2, about 0; see above.
    Empty: all faces are parallel, as a dome's are. */
    CV_PROP_RW std::vector<Vec2d> wedge;
    CV_PROP_RW double wavelength;              //!< of the light that the indices are of, nm in air; 0: not known
    /** How the indices change with the wavelength: the inner medium, each layer, the outer medium, each as refractiveIndex
    takes it; an empty one has an index that does not change. Empty: not known. */
    CV_PROP_RW std::vector<String> materials;

    /** @brief The same window in light of another colour.

    Each index is multiplied by what its material's changes by from `wavelength` to wavelengthNm, so that a measured index
    keeps its ratio to the catalogue's value. Where `wavelength` is 0, the indices become the catalogue's.
    @param wavelengthNm in air, nm.
    Throws cv::Exception if the window refracts and `materials` is empty, or as refractiveIndex does.
    */
    CV_WRAP GlassWindow atWavelength(double wavelengthNm) const;

    //! Throws cv::Exception that names the first field that is wrong, and its value.
    CV_WRAP void check() const;

    void write(FileStorage& fs) const;      //!< as a map; fs << window calls it
    void read(const FileNode& node);        //!< what write() wrote; throws as check() does
};

//! fs << window
CV_EXPORTS void write(FileStorage& fs, const String& name, const GlassWindow& window);
//! node >> window; defaultValue where the node is empty
CV_EXPORTS void read(const FileNode& node, GlassWindow& window, const GlassWindow& defaultValue = GlassWindow());

/** @brief Index of refraction of a material by its name.

All indices are relative to dry air of 20 C and 101325 Pa at the same wavelength, so that the index of this air is 1. Glass
catalogues and GlassWindow's defaults use the same convention: names and numbers of data sheets may be mixed. Multiplied by the
absolute index of air (1.000272 at 550 nm) they become relative to vacuum. One absolute index among relative ones has an error
of 2.7e-4 of itself: 4e-4 for glass, as much as N-BK7's tolerance.

| material | source | nm | stated accuracy | tolerance |
|---|---|---|---|---|
| `N-BK7` (`BK7`) | @cite Schott_NBK7 | 300-2500 | formula 5e-6 | 0.0005: as delivered |
| `K9` (`H-K9L`) | @cite CDGM_HK9L | 365-1711 | formula 5e-6 | 0.0005: as delivered |
| `B270` | fit to @cite Schott_B270 | 435-657 | 1e-4 (its last digit; the fit 4e-5) | 0.001: as delivered |
| `soda-lime` | @cite Rubin1985, clear window glass | 310-4600 | none stated | 0.005: kinds of float glass |
| `borosilicate` (`Borofloat`) | @cite Polyanskiy2024, of @cite Schott_BOROFLOAT33 | 240-1550 | 1e-4 | 0.003: Borofloat, Duran |
| `fused-silica` | @cite Malitson1965 | 210-3710 | 1e-5 | 0.00003: specimens |
| `sapphire`, ordinary ray | @cite MalitsonDodge1972 | 200-5000 | 1e-4 | 0.0002 (the extraordinary ray: 0.008 less) |
| `PMMA` | @cite Beadie2015 | 420-1620 | 5e-4 | 0.002: kinds, 10 C |
| `polycarbonate` | the fit of @cite Polyanskiy2024 to @cite Sultanova2009 | 437-1052 | 1e-3 | 0.003: kinds, 10 C |
| `water`: `T` 0-30 C (20) | @cite QuanFry1995 | 400-700 | 1.5e-5 on average | 0.0005: 5 C |
| `seawater`: `T` 0-30 C (20), `S` 0-35 g/kg (35) | @cite QuanFry1995 | 400-700 | 1.5e-5 on average | 0.0009: 5 C and 2 g/kg |
| `air`: `T` -40-100 C (20), `P` 1e4-1.4e5 Pa (101325), `RH` 0-100 % (0) | @cite Ciddor1996 | 300-1690 | 5e-8 | 2e-5: 10 C |

Glasses are at 20 C. Water is at atmospheric pressure: at a depth of 100 m its index is 1.4e-4 larger. Air that is warmer or
thinner than at 20 C and 101325 Pa has an index below 1, which GlassWindow refuses. Divide all indices of the window by it:
only their ratios matter.

@param material name, upper or lower case; parameters after a colon, as in `seawater:T=12,S=35`. A missing parameter has the
value in brackets.
@param wavelengthNm wavelength in air, nm. 550 is the middle of the visible range, 400 to 700, and the mean wavelength of white
light on a sensor with the same sensitivity to all of it.
@return the index. Throws cv::Exception for an unknown name (the text lists the known names and the most similar one), for
parameters that the material does not have, and for values outside the ranges above.
*/
CV_EXPORTS_W double refractiveIndex(const String& material, double wavelengthNm = 550.);

/** @brief Tolerance of refractiveIndex: how much a real piece or medium of that name may differ.
@param material as in refractiveIndex.
@return the last column of the table there. For materials: half the range of what is sold under the name. For media: the change
by temperature, salinity and pressure, if these are known only as stated. The wavelength is not included.
*/
CV_EXPORTS_W double refractiveIndexTolerance(const String& material);

class Camera;

/** @brief A lens plus a window.

Make it once and use it for many calls. Every function of the module has an overload that takes it in place of (cameraMatrix,
distCoeffs, window). The calibrators of several cameras take only this form.

Copies of a Ptr share one camera; clone() makes a new one. Other code cannot derive from this class, because the module uses
more of a camera than its public functions.

**Threads**: any number of threads may use one camera at the same time in const calls and in the module's functions that do not
change it. The setters, and the calibrators that store their result in it, need exclusive access: give each thread its own
clone().
*/
class CV_EXPORTS_W RefractiveCamera
{
public:
    /** @brief OpenCV's lens model behind a window.
    @param cameraMatrix 3x3 float32/float64, no skew.
    @param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients in OpenCV's order; may be empty.
    @param window see GlassWindow.
    */
    CV_WRAP static Ptr<RefractiveCamera> create(InputArray cameraMatrix, InputArray distCoeffs,
                                                const GlassWindow& window = GlassWindow());

    /** @brief cv::fisheye's lens model behind a window.
    @param cameraMatrix 3x3 float32/float64; K(0,1) = alpha * fx is used as cv::fisheye does.
    @param distCoeffs 4 coefficients; may be empty.
    @param window see GlassWindow.
    */
    CV_WRAP static Ptr<RefractiveCamera> createFisheye(InputArray cameraMatrix, InputArray distCoeffs,
                                                       const GlassWindow& window = GlassWindow());

    /** @brief A lens of mrcal, of any of its models (of CAHVORE without a moving centre, E = 0), behind a window.
    @param lensModel its name, such as LENSMODEL_OPENCV8 or LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=170.
    @param intrinsics fx, fy, cx, cy and the model's coefficients or control points, as in a .cameramodel file.
    @param window see GlassWindow.
    */
    CV_WRAP static Ptr<RefractiveCamera> createMrcal(const String& lensModel, InputArray intrinsics,
                                                     const GlassWindow& window = GlassWindow());

    /** @brief A lens of any model, by its name (`lens_model` in files), behind a window.
    @param lensModel one of lensModels().
    @param cameraMatrix 3x3 float32/float64; skew only for `fisheye`.
    @param distCoeffs as many coefficients (or control points) as the model has.
    @param window see GlassWindow.
    */
    CV_WRAP static Ptr<RefractiveCamera> createByName(const String& lensModel, InputArray cameraMatrix, InputArray distCoeffs,
                                                      const GlassWindow& window = GlassWindow());

    //! The names of all lens models; a number stands for each `...` in them.
    CV_WRAP static std::vector<String> lensModels();

    /** @brief Reads a camera from OpenCV YAML/XML/JSON (`camera_matrix`, `distortion_coefficients` as OpenCV's
    calibration sample writes them, `lens_model`, `glass_window` as refract_calib adds) or from an mrcal .cameramodel.
    @param filename path.
    @param name of the map inside the file (`camera2`); empty: the top level or, if there is no camera, `camera1`.
    */
    CV_WRAP static Ptr<RefractiveCamera> read(const String& filename, const String& name = String());

    /** @brief Reads a camera from a map of an open file: the keys that write() writes.
    @param node the map.
    */
    CV_WRAP static Ptr<RefractiveCamera> read(const FileNode& node);

    virtual ~RefractiveCamera();

    //! A new camera with the same lens, window and image size.
    CV_WRAP virtual Ptr<RefractiveCamera> clone() const = 0;

    //! Writes the camera's keys into the map that is open in fs.
    virtual void write(FileStorage& fs) const = 0;

    /** @brief Writes the camera into an open file.
    @param fs open for writing.
    @param name of a new map for the camera's keys; empty: they go into the map that is open.
    */
    CV_WRAP void write(const Ptr<FileStorage>& fs, const String& name = String()) const;

    /** @brief Writes a file that read() reads. An existing file is replaced. If writing fails, this throws and keeps the old
file.
    @param filename path; its extension chooses the format: .xml, .json, mrcal's .cameramodel (without a window), else YAML.
    */
    CV_WRAP void save(const String& filename) const;

    CV_WRAP virtual Mat cameraMatrix() const = 0;        //!< 3x3 CV_64F
    CV_WRAP virtual Mat distCoeffs() const = 0;          //!< Nx1 CV_64F, as given
    CV_WRAP virtual String lensModel() const = 0;        //!< its name: one of lensModels()
    CV_WRAP virtual GlassWindow window() const = 0;      //!< a copy: see setWindow()
    /** @brief Throws as GlassWindow::check() does. */
    CV_WRAP virtual void setWindow(const GlassWindow& window) = 0;
    //! What the rows of stdDeviations and covariance of a calibration are, in their order: "fx", "fy", "cx", "cy", "k1", ...,
    //! "normal[0]", "normal[1]", "normal[2]", "distance", "thickness[0]", ..., "index[0]", ..., "innerIndex", "outerIndex"
    //! and, of a window whose `wedge` is not empty, "wedge[0][0]", "wedge[0][1]", "wedge[1][0]", ...; of a dome "center[0]",
    //! ..., "radius" in place of normal and distance, of a tube "center[0]", ..., "axis[0]", ..., "radius"; of a bent pane
    //! "curvature" last.
    CV_WRAP virtual std::vector<String> parameterNames() const = 0;
    //! fx, fy, cx, cy, coefficients (control points of splines are in distCoeffs(), see refractiveSplineWeights) as the
    //! jacobian's columns, Nx1 CV_64F.
    CV_WRAP virtual Mat lensParameters() const = 0;
    CV_WRAP virtual void setLensParameters(InputArray parameters) = 0;   //!< as many as lensParameters() gives
    CV_WRAP virtual Size imageSize() const = 0;          //!< 0x0 where unknown
    //! 0x0: unknown. Throws if one of them is negative, or 0 alone.
    CV_WRAP virtual void setImageSize(Size size) = 0;

private:
    friend class Camera;
    RefractiveCamera();
    RefractiveCamera(const RefractiveCamera&);
    RefractiveCamera& operator=(const RefractiveCamera&);
};

/** @brief Reads all cameras of a rig and their extrinsics from a file as refract_calib writes it (YAML, XML or JSON).

One camera is at the top level of the file. Several are in the maps `camera1`, `camera2`, ..., as RefractiveCamera::write
writes each; beside them are `R`, `T` (camera 1 -> camera 2), `R3`, `T3` (camera 1 -> camera 3), and so on.

A .cameramodel file of mrcal holds one camera. For a rig, `camera-%d.cameramodel` stands for the files camera-0.cameramodel (or
1), the next number, and so on. Their `extrinsics` give the pose of each camera in a common frame.

@param filename path; %d stands for the number of .cameramodel files.
@param cameras one or more.
@param Rs 3x3 CV_64F camera 1 -> camera, one per camera, first the identity. A std::vector<Matx33d> must have this size before.
@param Ts 3x1 CV_64F, as Rs; the first is 0.

Throws cv::Exception with the name of the file and the key if something is missing or wrong.
*/
CV_EXPORTS_W void readRig(const String& filename, CV_OUT std::vector<Ptr<RefractiveCamera> >& cameras,
        OutputArrayOfArrays Rs, OutputArrayOfArrays Ts);

/** @brief readRig with the shared windows and the covariance of the calibration.
@param filename path.
@param cameras as above.
@param Rs as above.
@param Ts as above.
@param windowOfCamera index of the window of each camera, as for calibrateGlassRig (key `window_of_camera`): cameras with equal
numbers share one window. Empty if the file does not have it.
@param covariance PxP CV_64F of all cameras' parameters, then rvec (3) and T (3) of each but the first, as calibrateGlassRig
returns it (key `covariance`); empty where the file has none.
*/
CV_EXPORTS_AS(readRigExtended) void readRig(const String& filename, CV_OUT std::vector<Ptr<RefractiveCamera> >& cameras,
        OutputArrayOfArrays Rs, OutputArrayOfArrays Ts, CV_OUT std::vector<int>& windowOfCamera, OutputArray covariance);

/** @brief Writes a file that readRig() reads. An existing file is replaced, with all other keys in it. If writing fails, this
throws and keeps the old file.
@param filename path; its extension chooses the format: .xml, .json, mrcal's .cameramodel (only for cameras without windows;
for several cameras with %d for the number, from 0; camera 1 is the reference), else YAML.
@param cameras one or more.
@param Rs 3x3 rotation (or rotation vector) camera 1 -> camera, one per camera; the first is the identity, within rounding. May
be empty for one camera.
@param Ts 3x1, as Rs.
@param windowOfCamera see readRig; empty: not written.
@param covariance see readRig; empty: not written.
*/
CV_EXPORTS_W void writeRig(const String& filename, const std::vector<Ptr<RefractiveCamera> >& cameras,
        InputArrayOfArrays Rs, InputArrayOfArrays Ts, const std::vector<int>& windowOfCamera = std::vector<int>(),
        InputArray covariance = noArray());

//! @}

//! @addtogroup refract_points
//! @{

/** @brief Projects object points through lens and window.

Newton's method finds the refracted path, to the accuracy of double. The unknown is the tangent of the angle in the medium with
the smallest index: in it the function is increasing and concave, so that neither a polynomial nor bracketing is needed.

@param objectPoints N 3-D points, object coordinates.
@param rvec rotation vector (or 3x3 matrix) object -> camera.
@param tvec translation object -> camera.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param imagePoints N pixels in the raw (distorted, refracted) image, Nx1 2-channel.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        OutputArray imagePoints, OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
        const Ptr<RefractiveCamera>& camera, OutputArray imagePoints, OutputArray status = noArray());

/** @brief refractiveProjectPoints with all derivatives.
@param objectPoints N 3-D points, object coordinates.
@param rvec rotation vector (or 3x3 matrix) object -> camera.
@param tvec translation object -> camera.
@param camera lens and window.
@param imagePoints N pixels, Nx1 2-channel.
@param status Nx1 CV_8U.
@param jacobian 2N x (6 + lens + window) CV_64F, rows u, v of each point; columns rvec (3), tvec (3), lens parameters
(fx, fy, cx, cy, coefficients as given), normal (3, of the unnormalised vector: orthogonal to n), distance,
thickness of each layer, index of each layer, innerIndex, outerIndex and, where the window has one, wedge of each layer (2);
of a dome center (3) and radius in place of normal and distance, of a tube center (3), axis (3, of the unnormalised vector) and
radius; of a bent window the curvature last. parameterNames() has them in order.
NaN where status is not 0.
*/
CV_EXPORTS_AS(refractiveProjectPointsExtended) void refractiveProjectPoints(
        InputArray objectPoints, InputArray rvec, InputArray tvec, const Ptr<RefractiveCamera>& camera,
        OutputArray imagePoints, OutputArray status, OutputArray jacobian);

/** @brief The derivatives with respect to the control points of a splined lens, which refractiveProjectPoints' jacobian does
not contain. A pixel depends on few control points, and linearly.

Control point k is c[k] = (distCoeffs()[2k], distCoeffs()[2k + 1]). The derivatives are du/dc[k][0] = fx w and dv/dc[k][1] = fy
w; u does not depend on c[k][1], nor v on c[k][0]. The window has no effect on them, because the direction of a point at the
lens does not depend on the lens.

@param objectPoints N 3-D points, object coordinates.
@param rvec rotation vector (or 3x3 matrix) object -> camera.
@param tvec translation object -> camera.
@param camera with a lens LENSMODEL_SPLINED_STEREOGRAPHIC_...; others throw.
@param controls NxM CV_32S: which control points k a pixel depends on, M = (order + 1)^2; -1 where status is not 0.
@param weights NxM CV_64F: w of each, their sum is 1; NaN where status is not 0.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveSplineWeights(InputArray objectPoints, InputArray rvec, InputArray tvec,
        const Ptr<RefractiveCamera>& camera, OutputArray controls, OutputArray weights, OutputArray status = noArray());

/** @brief Rays of pixels in the scene. Closed form, except for the lens.
@param imagePoints N raw pixels.
@param origins N points of the rays, camera coordinates: on the window's axis, tau * normal; near it behind a window with a
wedge or a curvature; near the camera in a tube.
@param directions N unit vectors in the outer medium, camera coordinates.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveUnprojectPoints(InputArray imagePoints, OutputArray origins, OutputArray directions,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveUnprojectPoints(InputArray imagePoints, OutputArray origins, OutputArray directions,
        const Ptr<RefractiveCamera>& camera, OutputArray status = noArray());

/** @brief The pixels at which a pinhole camera without window and lens distortion would see the same scene points.

As in cv::undistortPoints, the result is normalised coordinates without P, and pixels with P.

@param src N raw pixels.
@param dst N corrected points, Nx1 2-channel.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth z > 0 of the scene points, camera frame; infinity is allowed. There is no default, because the correction depends
on it: a window with parallel faces between equal media has no effect on an infinitely far scene. For a camera without a window
a positive depth has no effect and may be 0 (Python: None).
@param R rotation camera -> rectified camera, 3x3 or rotation vector; omitted = identity.
@param P new camera matrix 3x3 or projection matrix 3x4 (its left 3x3 is used); omitted = identity.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveUndistortPoints(InputArray src, OutputArray dst,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, double depth,
        InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera,
        double depth, InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

/** @overload
@param src N raw pixels.
@param dst N corrected points, Nx1 2-channel.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth z of the scene points, camera frame: one number for all, or N numbers. One number must be positive, or this
throws; of N numbers an invalid one sets only the status of its own point. (d, 0, 0, 0) means the number d, because Scalar(d)
is such an array. For exactly four points this is ambiguous and is refused: give a double, or an array of one number; a plane
is not taken here. Depths that are not positive have the status REFRACT_BEHIND_WINDOW, without a window
REFRACT_NO_INTERSECTION; positive ones have no effect there, and the array may be empty.
@param R rotation camera -> rectified camera, 3x3 or rotation vector; omitted = identity.
@param P new camera matrix 3x3 or projection matrix 3x4 (its left 3x3 is used); omitted = identity.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveUndistortPoints(InputArray src, OutputArray dst,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, InputArray depth,
        InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera,
        InputArray depth, InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

/** @brief The inverse of refractiveUndistortPoints: raw pixels of points that a pinhole camera without window and lens
distortion sees.
@param undistorted N points as refractiveUndistortPoints gives them: normalised coordinates, with P pixels.
@param distorted N raw pixels, Nx1 2-channel.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth z > 0 of the plane that the scene points are on, camera frame; may be infinity.
@param R rotation camera -> rectified camera, as refractiveUndistortPoints was given it; omitted = identity.
@param P camera matrix 3x3 or projection matrix 3x4 of the undistorted points; omitted = identity.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveDistortPoints(InputArray undistorted, OutputArray distorted,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, double depth,
        InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, const Ptr<RefractiveCamera>& camera,
        double depth, InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

/** @overload
@param undistorted N points as refractiveUndistortPoints gives them: normalised coordinates, with P pixels.
@param distorted N raw pixels, Nx1 2-channel.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth z of the scene points, one number or N, as refractiveUndistortPoints takes it.
@param R rotation camera -> rectified camera; omitted = identity.
@param P camera matrix of the undistorted points; omitted = identity.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractiveDistortPoints(InputArray undistorted, OutputArray distorted,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, InputArray depth,
        InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, const Ptr<RefractiveCamera>& camera,
        InputArray depth, InputArray R = noArray(), InputArray P = noArray(), OutputArray status = noArray());

/** @brief Intersections of the refracted rays of pixels with a plane (@cite Plate2024, section 3.1.3).
@param imagePoints N raw pixels.
@param points3D N points, camera coordinates, Nx1 3-channel.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param plane (a, b, c, d): a x + b y + c z = d, camera coordinates; (a, b, c) not zero.
@param status Nx1 CV_8U, see RefractiveStatus.
*/
CV_EXPORTS_W void refractivePointsOnPlane(InputArray imagePoints, OutputArray points3D,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        const Vec4d& plane, OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void refractivePointsOnPlane(InputArray imagePoints, OutputArray points3D,
        const Ptr<RefractiveCamera>& camera, const Vec4d& plane, OutputArray status = noArray());

/** @brief Maps for cv::remap from a raw image to the image of a plane in a pinhole camera without window.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth one number > 0: the plane z = depth (camera frame), infinity allowed; four numbers: the plane (a, b, c, d): a x +
b y + c z = d. (a, 0, 0, 0), a plane through the camera, stands for the number a, as Scalar(a) does. For a camera without a
window it has no effect and may be 0 or empty (Python: None).
@param R rotation camera -> rectified camera, 3x3 or rotation vector; may be empty.
@param newCameraMatrix 3x3 or 3x4 of the new image; empty: cameraMatrix.
@param size of the new image.
@param m1type CV_32FC1, CV_32FC2 or CV_16SC2, as cv::initUndistortRectifyMap; 0 or less: CV_16SC2, which holds raw pixels up to
32767 and is refused where the raw image (imageSize() of the camera, else twice its principal point) has farther ones that are
needed.
@param map1 first map, accurate to 1e-6 px before rounding to its type; pixels without a solution map to (-1, -1).
@param map2 second map; empty for CV_32FC2.
*/
CV_EXPORTS_W void initRefractiveUndistortRectifyMap(
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        InputArray depth, InputArray R, InputArray newCameraMatrix, Size size, int m1type,
        OutputArray map1, OutputArray map2);

//! @overload
CV_EXPORTS_W void initRefractiveUndistortRectifyMap(const Ptr<RefractiveCamera>& camera,
        InputArray depth, InputArray R, InputArray newCameraMatrix, Size size, int m1type,
        OutputArray map1, OutputArray map2);

/** @brief The image of a plane in a pinhole camera without window: cv::undistort through a window.
@param src raw image of a depth that cv::remap takes: CV_8U, CV_16U, CV_16S, CV_32F or CV_64F.
@param dst corrected image, of the size and type of src; black where there is no solution or no pixel of the raw image.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth one number or a plane, as initRefractiveUndistortRectifyMap takes it.
@param newCameraMatrix 3x3 of the corrected image; empty: cameraMatrix.

Calls initRefractiveUndistortRectifyMap and cv::remap (bilinear); in parts where the image is larger than the 32766 pixels that
cv::remap takes. For many images compute the maps once.
*/
CV_EXPORTS_W void refractiveUndistortImage(InputArray src, OutputArray dst, InputArray cameraMatrix, InputArray distCoeffs,
        const GlassWindow& window, InputArray depth, InputArray newCameraMatrix = noArray());

//! @overload
CV_EXPORTS_W void refractiveUndistortImage(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera,
        InputArray depth, InputArray newCameraMatrix = noArray());

/** @brief The new camera matrix for the maps of a plane: cv::getOptimalNewCameraMatrix through a window.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param depth one number or a plane, as initRefractiveUndistortRectifyMap takes it.
@param imageSize of the raw image.
@param alpha 0: all new pixels are valid, 1: no raw pixel that sees the plane is lost; values between interpolate.
@param newImageSize of the new image; Size(): imageSize.
@param validPixROI rectangle of the new image in which all pixels are valid.
@param centerPrincipalPoint the principal point is in the middle of the new image.
@return 3x3 CV_64F.

Valid is a new pixel that has a raw one, by the maps for the plane. As in calib3d the valid rectangle is between the borders of
the raw image. Where the lens folds back, light is totally reflected, or the window or the plane ends within the image, it is
the largest part of that in which all pixels are valid. Without a window cv::getOptimalNewCameraMatrix has other numbers: it
looks at 9x9 places of the image, and takes lenses beyond their fold. For ordinary lenses it differs by some tenths of a
percent.

Throws if nothing bounds the valid part, as of a lens that looks 90 degrees from the axis on a border of its image, and with
alpha > 0 if a raw pixel is 89 degrees or more from the axis: a pinhole camera does not show it.
*/
CV_EXPORTS_W Mat getOptimalNewRefractiveCameraMatrix(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        InputArray depth, Size imageSize, double alpha, Size newImageSize = Size(), CV_OUT Rect* validPixROI = 0,
        bool centerPrincipalPoint = false);

//! @overload
CV_EXPORTS_W Mat getOptimalNewRefractiveCameraMatrix(const Ptr<RefractiveCamera>& camera, InputArray depth, Size imageSize,
        double alpha, Size newImageSize = Size(), CV_OUT Rect* validPixROI = 0, bool centerPrincipalPoint = false);

/** @brief Draws the axes of an object's frame into a raw image: cv::drawFrameAxes through a window.
@param image raw image with 1, 3 or 4 channels; x is drawn red, y green, z blue (BGR). Axes are curves; parts without an image
are not drawn.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param rvec rotation vector (or 3x3 matrix) object -> camera, as refractiveSolvePnP gives it.
@param tvec translation object -> camera.
@param length of the axes, in the unit of tvec, > 0.
@param thickness of the lines, pixels.
*/
CV_EXPORTS_W void drawRefractiveFrameAxes(InputOutputArray image, InputArray cameraMatrix, InputArray distCoeffs,
        const GlassWindow& window, InputArray rvec, InputArray tvec, float length, int thickness = 3);

//! @overload
CV_EXPORTS_W void drawRefractiveFrameAxes(InputOutputArray image, const Ptr<RefractiveCamera>& camera, InputArray rvec,
        InputArray tvec, float length, int thickness = 3);

/** @brief The epipolar curve of each point: the possible matches in the other raw image (@cite Plate2024, section 3.2).
@param points N raw pixels of image whichImage.
@param whichImage 1 or 2.
@param cameraMatrix1 3x3.
@param distCoeffs1 0, 4, 5, 8, 12 or 14 coefficients.
@param window1 of camera 1.
@param cameraMatrix2 3x3.
@param distCoeffs2 0, 4, 5, 8, 12 or 14 coefficients.
@param window2 of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param depthRange z of the scene, near and far, in the frame of camera whichImage; far may be infinity.
@param lines N polylines, each Mx1 2-channel, raw pixels of the other image, ordered by increasing depth. Parts without an
image are left out; a point without a curve gives an empty Mat.
@param tolerance largest distance in pixels between polyline and exact curve.
@param status Nx1 CV_8U, see RefractiveStatus: 0 where the line is not empty. REFRACT_NOT_CONVERGED: the tolerance needs more
than 100000 points, for example if depthRange begins so near that the curve ends millions of pixels away.
*/
CV_EXPORTS_W void computeRefractiveEpilines(InputArray points, int whichImage,
        InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
        InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
        InputArray R, InputArray T, const Vec2d& depthRange,
        OutputArrayOfArrays lines, double tolerance = 0.01, OutputArray status = noArray());

//! @overload
CV_EXPORTS_W void computeRefractiveEpilines(InputArray points, int whichImage,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, const Vec2d& depthRange,
        OutputArrayOfArrays lines, double tolerance = 0.01, OutputArray status = noArray());

/** @brief The distance of each match from its epipolar curve (computeRefractiveEpilines), to find wrong matches.

The curve is the image of a pixel's ray between the near and far end of depthRange; it begins where the ray leaves the window.
For a pixel beyond an end of the curve the distance is that from the end. So a small distance means that the match has a point
in the depth range. The distance is exact to 1e-6 px near the curve. For pixels hundreds of pixels away, about 1 in 100
distances refers to a neighbouring part of the curve. For pixels thousands of pixels away it is exact to some percent.

@param points1 N raw pixels of camera 1.
@param points2 N raw pixels of camera 2, the supposed matches.
@param cameraMatrix1 3x3.
@param distCoeffs1 0, 4, 5, 8, 12 or 14 coefficients.
@param window1 of camera 1.
@param cameraMatrix2 3x3.
@param distCoeffs2 0, 4, 5, 8, 12 or 14 coefficients.
@param window2 of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param distances Nx1, pixels: positive to the right of the curve in the direction of increasing depth (u to the right, v down).
NaN where status is not 0.
@param status Nx1 CV_8U, see RefractiveStatus.
@param whichImage 1: the curves are those of points1, distances are in image 2; 2: the other way.
@param depthRange z of the scene, near and far, in the frame of camera whichImage; near may be 0 and far infinity: the whole
ray.
*/
CV_EXPORTS_W void refractiveEpipolarDistance(InputArray points1, InputArray points2,
        InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
        InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
        InputArray R, InputArray T, OutputArray distances, OutputArray status = noArray(), int whichImage = 1,
        const Vec2d& depthRange = Vec2d(0, DBL_MAX));

//! @overload
CV_EXPORTS_W void refractiveEpipolarDistance(InputArray points1, InputArray points2,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, OutputArray distances, OutputArray status = noArray(), int whichImage = 1,
        const Vec2d& depthRange = Vec2d(0, DBL_MAX));

/** @brief refractiveEpipolarDistance with its derivative and the depth of the nearest point of the curve.
@param points1 N raw pixels of camera 1.
@param points2 N raw pixels of camera 2.
@param camera1 lens and window of camera 1.
@param camera2 lens and window of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param distances Nx1, pixels.
@param status Nx1 CV_8U.
@param whichImage as above.
@param depthRange as above.
@param depths Nx1 CV_64F: z of the nearest point of the curve, in the frame of camera whichImage; an end of depthRange (also
infinity) where the pixel lies beyond it.
@param jacobian Nx10 CV_64F: derivative of the distance by u1, v1, u2, v2, by the rotation vector of R (3) and by T (3). The
distance divided by the norm of the first four is the Sampson error. For a right match it is normally distributed, with the
standard deviation of the pixels' noise.
*/
CV_EXPORTS_AS(refractiveEpipolarDistanceExtended) void refractiveEpipolarDistance(InputArray points1, InputArray points2,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, OutputArray distances, OutputArray status, int whichImage, const Vec2d& depthRange,
        OutputArray depths, OutputArray jacobian);

/** @brief Triangulates points seen by two cameras, each behind its own window (@cite Plate2024, section 3.3).
@param cameraMatrix1 3x3.
@param distCoeffs1 0, 4, 5, 8, 12 or 14 coefficients.
@param window1 of camera 1.
@param cameraMatrix2 3x3.
@param distCoeffs2 0, 4, 5, 8, 12 or 14 coefficients.
@param window2 of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param points1 N raw pixels of camera 1.
@param points2 N raw pixels of camera 2.
@param points3D N points in the frame of camera 1, Nx1 3-channel.
@param status Nx1 CV_8U, see RefractiveStatus.
@param flags TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT.
*/
CV_EXPORTS_W void triangulateRefractive(
        InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
        InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
        InputArray R, InputArray T, InputArray points1, InputArray points2,
        OutputArray points3D, OutputArray status = noArray(), int flags = 0);

//! @overload
CV_EXPORTS_W void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, InputArray points1, InputArray points2,
        OutputArray points3D, OutputArray status = noArray(), int flags = 0);

/** @brief triangulateRefractive with the covariance of each point.
@param camera1 lens and window of camera 1.
@param camera2 lens and window of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param points1 N raw pixels of camera 1.
@param points2 N raw pixels of camera 2.
@param points3D N points in the frame of camera 1, Nx1 3-channel.
@param status Nx1 CV_8U, see RefractiveStatus.
@param flags TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT.
@param pixelSigma standard deviation of each pixel coordinate.
@param calibrationCovariance empty, or the covariance that stereoCalibrateGlass returns; it is propagated to the points.
@param covariance Nx9 CV_64F, the 3x3 covariance of each point row by row, of the maximum-likelihood point.
@param reprojectionErrors Nx2 CV_64F, pixels: distance of each point's projection from the given pixel, in each camera; NaN
where there is no point.
*/
CV_EXPORTS_AS(triangulateRefractiveExtended) void triangulateRefractive(
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, InputArray points1, InputArray points2,
        OutputArray points3D, OutputArray status, int flags,
        double pixelSigma, InputArray calibrationCovariance, OutputArray covariance,
        OutputArray reprojectionErrors = noArray());

/** @brief Triangulates points seen by any number of cameras, behind separate windows, shared windows or none.
@param cameras lens and window of each.
@param Rs 3x3 rotation (or rotation vector) camera 1 -> camera, one per camera; the first is the identity, within rounding.
@param Ts 3x1 translation, as Rs; the first is 0.
@param imagePoints one array of N raw pixels per camera. One coordinate NaN: half a pixel. Both NaN: the camera did not see
that point.
@param points3D N points in the frame of camera 1, Nx1 3-channel.
@param status Nx1 CV_8U, see RefractiveStatus; REFRACT_TOO_FEW_VIEWS where fewer than three coordinates were observed,
REFRACT_PARALLEL_RAYS where the observed ones do not determine the point, as where a camera's ray lies in the sheet. Every
observed pixel must have a ray: otherwise the point has the status of the first pixel without one.
@param flags TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT, which takes half pixels as not seen.

With two cameras the result is that of triangulateRefractive for two. Outliers are not rejected: one wrong observation among
many cameras shifts the point.
*/
CV_EXPORTS_W void triangulateRefractive(const std::vector<Ptr<RefractiveCamera> >& cameras,
        InputArrayOfArrays Rs, InputArrayOfArrays Ts, InputArrayOfArrays imagePoints,
        OutputArray points3D, OutputArray status = noArray(), int flags = 0);

/** @brief triangulateRefractive for any number of cameras, with the covariance of each point.
@param cameras lens and window of each.
@param Rs 3x3 rotation (or rotation vector) camera 1 -> camera, one per camera; the first is the identity, within rounding.
@param Ts 3x1 translation, as Rs; the first is 0.
@param imagePoints as above.
@param points3D N points in the frame of camera 1, Nx1 3-channel.
@param status as above.
@param flags as above.
@param pixelSigma standard deviation of each pixel coordinate.
@param calibrationCovariance empty, or the covariance that calibrateGlassRig returns: the parameters of all cameras,
then rvec and T of each but the first; it is propagated to the points.
@param covariance Nx9 CV_64F, the 3x3 covariance of each point row by row, of the maximum-likelihood point.
@param reprojectionErrors N x cameras CV_64F, pixels: distance of each point's projection from the given pixel, of half a pixel
the difference of its known coordinate; NaN where there is no point, or the camera did not see it.
@param pixelCovariances one array per camera: the covariance of each pixel in units of the square of pixelSigma (see the
conventions). The point is the most likely one for them. An empty array, or noArray(): usual pixels.
*/
CV_EXPORTS_AS(triangulateRefractiveExtended) void triangulateRefractive(
        const std::vector<Ptr<RefractiveCamera> >& cameras,
        InputArrayOfArrays Rs, InputArrayOfArrays Ts, InputArrayOfArrays imagePoints,
        OutputArray points3D, OutputArray status, int flags,
        double pixelSigma, InputArray calibrationCovariance, OutputArray covariance,
        OutputArray reprojectionErrors = noArray(), InputArrayOfArrays pixelCovariances = noArray());

//! @}

//! @addtogroup refract_stereo
//! @{

/** @brief cv::stereoRectify for cameras behind windows: in air, in water, behind a shared wall, without a window, also mixed.

Each camera is replaced by a pinhole camera at its *virtual centre*, a point on the axis through its centre of projection along
the window's normal. The virtual centres minimise the row differences of both new images over depthRange. On one plane in the
middle of it, z = 2/(1/near + 1/far) in the rectified frame, the rows agree exactly. With maps for that plane any matcher finds
most of the scene. With maps for the depths that it found (refractiveRectifiedDepth) the rows agree everywhere.
refractiveReprojectImageTo3D is exact where they agree, whatever the maps.

The *rectified frame* is the frame of camera 1 rotated by R1. P1 and P2 project points of it: their last columns contain the
virtual centres and, as in calib3d, P2 the baseline.

@param camera1 lens and window of camera 1.
@param camera2 lens and window of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param imageSize of the raw images.
@param depthRange z of the scene, near and far, in the frame of camera 1; far may be infinity.
@param R1 3x3 rotation camera 1 -> rectified frame.
@param R2 3x3 rotation camera 2 -> rectified frame.
@param P1 3x4, rectified frame -> new image 1.
@param P2 3x4, rectified frame -> new image 2.
@param Q 4x4, (x, y, disparity, 1) -> rectified frame, for cv::reprojectImageTo3D: approximate with maps for a plane, exact
with maps for a depth per pixel.
@param flags RECTIFY_ZERO_DISPARITY or 0.
@param alpha as in cv::stereoRectify, with maps for that plane: 0 all new pixels are valid, 1 no raw pixel is lost, negative:
neither of them, above 1 as 1. The promise is that of getOptimalNewRefractiveCameraMatrix, and so is what is refused.
@param newImageSize of the new images; Size(): imageSize.
@param validPixROI1 rectangle of the new image 1 in which all pixels are valid, with maps for that plane; empty if the lens is
so wide that nothing bounds it.
@param validPixROI2 the same of the new image 2.
All matrices are CV_64F.
@return RMS and largest difference of rows (of columns, if one camera is above the other) over the common view and depthRange
with maps for the plane, in pixels.

For two cameras without windows and with OpenCV's lenses the result is that of cv::stereoRectify where that is one: the whole
borders of both raw images are in front of the new cameras, and what alpha promises holds to a hundredth of the image. Elsewhere
it is found or refused as for cameras behind windows. Throws if the cameras have no common point in depthRange beyond their
windows.
*/
CV_EXPORTS_W Vec2d refractiveStereoRectify(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, Size imageSize, const Vec2d& depthRange,
        OutputArray R1, OutputArray R2, OutputArray P1, OutputArray P2, OutputArray Q,
        int flags = RECTIFY_ZERO_DISPARITY, double alpha = -1, Size newImageSize = Size(),
        CV_OUT Rect* validPixROI1 = 0, CV_OUT Rect* validPixROI2 = 0);

//! @overload
CV_EXPORTS_W Vec2d refractiveStereoRectify(InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
        InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
        InputArray R, InputArray T, Size imageSize, const Vec2d& depthRange,
        OutputArray R1, OutputArray R2, OutputArray P1, OutputArray P2, OutputArray Q,
        int flags = RECTIFY_ZERO_DISPARITY, double alpha = -1, Size newImageSize = Size(),
        CV_OUT Rect* validPixROI1 = 0, CV_OUT Rect* validPixROI2 = 0);

/** @brief Maps for cv::remap from a raw image to an image of a rectified pair.
@param camera lens and window.
@param depth of the scene in the new image: one number > 0: the plane z = depth, infinity allowed; four numbers: the plane
(a, b, c, d); or an array of the new image's size, of any type, with the z of each new pixel. All in the rectified frame. Four
numbers (a, 0, 0, 0) and an empty array mean the same as in initRefractiveUndistortRectifyMap.
@param R R1 or R2 of refractiveStereoRectify.
@param P P1 or P2.
@param T for camera 2: translation camera 1 -> camera 2; empty for camera 1. P contains the position of the pinhole, and only T
that of the camera. The pinhole must be on the axis of the camera's window (without window: at its centre of projection), as
refractiveStereoRectify returns it; otherwise T, P and the camera do not belong together, and this throws.
@param size of the new image.
@param m1type as initRefractiveUndistortRectifyMap.
@param map1 first map; pixels without a solution, or whose depth is NaN, map to (-1, -1).
@param map2 second map; empty for CV_32FC2.
*/
CV_EXPORTS_W void initRefractiveStereoRectifyMap(const Ptr<RefractiveCamera>& camera, InputArray depth,
        InputArray R, InputArray P, InputArray T, Size size, int m1type, OutputArray map1, OutputArray map2);

//! @overload
CV_EXPORTS_W void initRefractiveStereoRectifyMap(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        InputArray depth, InputArray R, InputArray P, InputArray T, Size size, int m1type, OutputArray map1, OutputArray map2);

/** @brief Computes a smooth depth of every pixel of both rectified images from a first disparity, which may be coarse and have
gaps: for the maps of a second pass.
@param disparity of the new image 1, or of both new images made smaller by one factor; CV_8U, CV_16S, CV_32S or CV_32F, in its
own pixels, without fractional bits (divide what StereoSGBM gives by 16). NaN or infinite: unknown. Where all of it is unknown,
so are both depths: NaN.
@param P1 of the full size.
@param P2 of the full size.
@param size full size.
@param depth1 z of each pixel of the new image 1, rectified frame, CV_32F.
@param depth2 the same of the new image 2.
@param handleMissingValues the smallest value of disparity means unknown, as in StereoMatcher.
*/
CV_EXPORTS_W void refractiveRectifiedDepth(InputArray disparity, InputArray P1, InputArray P2, Size size,
        OutputArray depth1, OutputArray depth2, bool handleMissingValues = false);

/** @brief cv::reprojectImageTo3D for cameras behind windows: the maximum-likelihood point of each pair of raw pixels.

Rectified pixels are mapped back to raw pixels, and these are triangulated (triangulateRefractive): exact where the rows of the
new images agree. A disparity has no rows: where they differ it is of a pixel beside the right one, by as much.

@param disparity of the new image 1; types as cv::reprojectImageTo3D, without fractional bits. NaN or infinite: none.
@param _3dImage points of the rectified frame, three channels; multiply by R1's inverse for the frame of camera 1. NaN where
there is none.
@param camera1 lens and window of camera 1.
@param camera2 lens and window of camera 2.
@param R 3x3 or rotation vector, camera 1 -> camera 2.
@param T translation, camera 1 -> camera 2.
@param R1 of refractiveStereoRectify.
@param R2 of refractiveStereoRectify.
@param P1 of refractiveStereoRectify.
@param P2 of refractiveStereoRectify.
@param depth1 of the map of image 1.
@param depth2 of the map of image 2.
@param handleMissingValues the smallest value of disparity means unknown, as in StereoMatcher.
@param ddepth CV_32F or CV_64F; -1: CV_32F.
@param status one CV_8U a pixel, see RefractiveStatus; REFRACT_NOT_FINITE where there is no disparity.
*/
CV_EXPORTS_W void refractiveReprojectImageTo3D(InputArray disparity, OutputArray _3dImage,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T,
        InputArray R1, InputArray R2, InputArray P1, InputArray P2, InputArray depth1, InputArray depth2,
        bool handleMissingValues = false, int ddepth = -1, OutputArray status = noArray());

/** @brief refractiveReprojectImageTo3D with the covariance of each point.
@param disparity as above.
@param _3dImage as above.
@param camera1 as above.
@param camera2 as above.
@param R as above.
@param T as above.
@param R1 as above.
@param R2 as above.
@param P1 as above.
@param P2 as above.
@param depth1 as above.
@param depth2 as above.
@param handleMissingValues as above.
@param ddepth as above.
@param status as above.
@param disparitySigma standard deviation of the disparity, one number or one per pixel. The pixel of image 1 is taken as exact,
so that the error is along its line of sight. NaN: unknown, and so is the covariance.
@param calibrationCovariance empty, or the covariance that stereoCalibrateGlass returns; it is propagated to the points.
@param covariance 9 channels CV_64F: the 3x3 covariance of each point row by row, rectified frame.
*/
CV_EXPORTS_AS(refractiveReprojectImageTo3DExtended) void refractiveReprojectImageTo3D(
        InputArray disparity, OutputArray _3dImage, const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputArray R, InputArray T, InputArray R1, InputArray R2, InputArray P1, InputArray P2,
        InputArray depth1, InputArray depth2, bool handleMissingValues, int ddepth, OutputArray status,
        InputArray disparitySigma, InputArray calibrationCovariance, OutputArray covariance);

//! @}

//! @addtogroup refract_calibrate
//! @{

/** @brief The window's normal from image pairs without and with the window, of an unmoved board (@cite Plate2024, section
3.1.1).

The direct bearing, the refracted bearing and the normal are coplanar for every point at any depth, for all layers and media.
The estimate is the vector closest to all these planes. First the lens model is inverted. The method uses bearings, so that the
distortion centre may be at infinity. Each pair is weighted by its propagated noise, iteratively; next to the centre a movement
is all noise, which tells nothing and counts as that. Thickness and index need not be known.

@param imagePointsDirect one array of N_i points per view, seen without the window.
@param imagePointsRefracted the same points through the window. A pair with a NaN coordinate is ignored.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param normal 3x1 CV_64F, unit, camera coordinates, normal[2] > 0.
@param distortionCenter 2x1 CV_64F, pixels of the ideal image: (cx + fx n_x/n_z, cy + fy n_y/n_z).
@param normalCovariance 3x3 CV_64F, rank 2 (tangent to the normal), scaled by the residuals.
@return RMS distance in pixels of the points from the lines through the distortion centre.

Throws if the data do not determine the normal (no displacement between the images of a pair, or all lines are the same). Needs
no Ceres.
*/
CV_EXPORTS_W double calibrateGlassNormal(InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
        InputArray cameraMatrix, InputArray distCoeffs,
        OutputArray normal, OutputArray distortionCenter = noArray(), OutputArray normalCovariance = noArray());

//! @overload
CV_EXPORTS_W double calibrateGlassNormal(InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
        const Ptr<RefractiveCamera>& camera,
        OutputArray normal, OutputArray distortionCenter = noArray(), OutputArray normalCovariance = noArray());

/** @brief Joint maximum-likelihood refinement of the window and the board poses.

@param objectPoints one array of N_i 3-D points per view: any target, planar or not, different views may have different
targets.
@param imagePointsDirect the same points of the same, unmoved target seen without the window; noArray() or an empty view if
there are none. NaN: the point was not seen.
@param imagePointsRefracted the points seen through the window, one array per view. NaN: the point was not seen. A view may be
empty if its direct one is not; without both its pose is NaN.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window in: the known values and, if all views are through the window only, the initial normal. With pairs the initial
normal comes from the data. Out: the estimate.
@param rvecs object -> camera rotation vector of each view.
@param tvecs object -> camera translation of each view.
@param flags see GlassCalibrationFlags; 0: only the normal is free.
@param criteria iterations and relative change of the cost at which to stop.
@return RMS reprojection error in pixels, by cv::calibrateCamera's definition, over all observed points.

Throws if the data do not determine a free parameter; the text names the undetermined direction (for sealed cameras see
GlassCalibrationFlags). The result is a minimum: the remaining step to it is below 1e-3 standard deviations. For a sealed
camera many initial values are tried, so that its focal length must be known only to some 10 %, and its window's distance only
to a factor of 3. Throws if the change that criteria ask for (EPS) is not reached in their iterations (COUNT); with COUNT
alone the current result is returned. Throws if the residuals of pairs are far larger than errors of detected corners can be:
direct and refracted points swapped, not of the same unmoved target, or of a scene in another medium. (Behind a pane whose
effect is hardly more than the noise, swapped points cannot be told, and have the mirrored tilt.) A wrong thickness or index
of the window does not throw; it increases the returned error. Throws Error::StsNotImplemented in a build without Ceres, as
the other forms do.
*/
CV_EXPORTS_W double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
        InputArrayOfArrays imagePointsRefracted, InputArray cameraMatrix, InputArray distCoeffs,
        CV_IN_OUT GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

/** @overload
The camera's window (and, with GLASS_FREE_INTRINSICS, its lens) is the initial value and the result.
*/
CV_EXPORTS_W double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
        InputArrayOfArrays imagePointsRefracted, const Ptr<RefractiveCamera>& camera,
        OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

/** @brief calibrateGlass with the uncertainty of the estimate.
@param objectPoints as above.
@param imagePointsDirect as above.
@param imagePointsRefracted as above.
@param camera initial value and result.
@param rvecs as above.
@param tvecs as above.
@param stdDeviations Px1 CV_64F: one standard deviation of each parameter, in the order of columns 6... of
refractiveProjectPoints' jacobian, which is that of RefractiveCamera::parameterNames(); 0 where fixed.
@param covariance PxP CV_64F in the same order, scaled by the residuals.
@param perViewErrors Vx2 CV_64F: RMS of each view direct and through the window; NaN where there is none.
@param jacobian 2M x (P + 6 V) CV_64F of all M observed points at the solution: view by view, direct before refracted;
columns parameters, then the pose (rvec, tvec) of each view; fixed parameters are 0.
@param flags as above.
@param criteria as above.
*/
CV_EXPORTS_AS(calibrateGlassExtended) double calibrateGlass(InputArrayOfArrays objectPoints,
        InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
        const Ptr<RefractiveCamera>& camera, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
        OutputArray stdDeviations, OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian,
        int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

/** @overload
The same for (cameraMatrix, distCoeffs, window).
*/
CV_EXPORTS_AS(calibrateGlassExtended) double calibrateGlass(InputArrayOfArrays objectPoints,
        InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
        InputArray cameraMatrix, InputArray distCoeffs, CV_IN_OUT GlassWindow& window,
        OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
        OutputArray stdDeviations, OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian,
        int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

/** @brief What stereoCalibrateGlass and the long form of calibrateGlassRig take beside images, cameras and poses. What is not
set is as its text says of empty. A copy shares its matrices, as Mat does; no call changes them. */
struct CV_EXPORTS_W_SIMPLE GlassRigOptions
{
    CV_WRAP explicit GlassRigOptions(int flags = 0);

    CV_PROP_RW int flags;                   //!< see GlassCalibrationFlags
    CV_PROP_RW TermCriteria criteria;       //!< iterations and relative change of the cost at which to stop: 1000 and 1e-12
    /** With GLASS_USE_POSES: one 6x6 covariance (see the conventions) of (rvec, tvec) per view, an empty one for a pose that is
    exact. Empty: all are exact. Without the flag they must be empty, so also for stereoCalibrateGlass. */
    CV_PROP_RW std::vector<Mat> poseCovariances;
    /** Prior knowledge of each camera, from an earlier calibration or a data sheet: an LxL covariance (see the conventions) of
    its L lens parameters, or a PxP one of its P parameters in the order of stdDeviations; an empty one, or none at all: nothing
    is known. A parameter with a variance is estimated with this prior, whose mean is the initial value. A lens parameter with
    the variance 0 is exact, with any flags. With NaN the flags decide, also for window parameters without a variance. Of a
    normal what is along it does not count: sigma^2 times the identity is sigma radians about any axis. It may be (P+6)x(P+6),
    of the camera's parameters, then of its rvec and T (rows and columns of camera 1: not used). With a variance they are
    estimated, with this prior; with the variance 0 exact, with any flags. An emitter of which only one coordinate is known
    needs this: of a straight sheet of light the images determine the plane, three of the six. Of a window that cameras share,
    the rows of its first camera count. */
    CV_PROP_RW std::vector<Mat> cameraCovariances;
    /** Prior knowledge of systematic errors that the targets of all views share, a 7x7 covariance (see the conventions):
    relative error of their scale (1; the square of a printed board), then rotation vector and translation (6) of the rigid
    motion by which all targets, or the mount of all cameras, moved between the direct and the refracted images, in the frame of
    camera 1. (A rotation about a point c adds [c]x times its rotation vector to the translation.) A variance of 0: there is no
    such error; NaN: it may be of any size. These errors are estimated within the prior, so that all uncertainties contain them:
    in air a common motion of the targets resembles a tilt of the window. Empty: there are none. */
    CV_PROP_RW Mat targetCovariance;
    /** Per camera, per view, as imagePointsDirect: the covariance of each pixel (see the conventions; the pixels' variance, in
    units of which they are, is estimated). An empty array, list or whole: usual pixels. */
    CV_PROP_RW std::vector<std::vector<Mat> > pixelCovariancesDirect;
    CV_PROP_RW std::vector<std::vector<Mat> > pixelCovariancesRefracted; //!< as pixelCovariancesDirect
    //! Whether stdDeviations and covariance are wanted: true; they take time. If not, they are empty.
    CV_PROP_RW bool computeCovariance;
};

//! What stereoCalibrateGlass and the long form of calibrateGlassRig find beside cameras, places and poses.
struct CV_EXPORTS_W_SIMPLE GlassRigResult
{
    CV_WRAP GlassRigResult();

    //! RMS reprojection error in pixels over all points that were used (of half a pixel: of its known coordinate; no weights)
    CV_PROP_RW double rms;
    CV_PROP_RW double pixelStd;             //!< estimated standard deviation of one coordinate of a usual pixel
    CV_PROP_RW int degreesOfFreedom;        //!< equations, those of prior knowledge too, less unknowns: what tells pixelStd
    //! Px1 CV_64F: parameters of each camera (as calibrateGlass), then rvec (3) and T (3) of each but the first.
    CV_PROP_RW Mat stdDeviations;
    /** PxP in the same order, scaled by the residuals. With a targetCovariance both have seven more rows at their end (and this
    as many columns), which other calls do not take: give these the part before. */
    CV_PROP_RW Mat covariance;
    //! Vx2C CV_64F: RMS of each image: direct and refracted of camera 1, of camera 2, ...; NaN: no image, or it was rejected.
    CV_PROP_RW Mat perViewErrors;
    CV_PROP_RW Mat imageStatus;             //!< Vx2C CV_8U in the same order, see GlassImageStatus
    /** V*2C masks Nx1 CV_8U in the same order, row by row: 0 where a point was not seen or was rejected; empty where there is
    no image. */
    CV_PROP_RW std::vector<Mat> inliers;
    /** Cx5 CV_64F: for a window that is estimated only from images through it: the normal (3) of the second best minimum, the
    root of the difference of its squared errors from the best, in standard deviations of a pixel, and its distance. If the root
    is below about 3, the data do not distinguish both minima: add a pair, or other tilts. NaN if no other minimum was found.
    The row, and the frame of the normal, are those of the first camera of the window. Of a dome or tube: its centre and radius.
    */
    CV_PROP_RW Mat otherMinima;
    CV_PROP_RW Mat targetErrors;            //!< 7x1 CV_64F: the estimates; NaN without a targetCovariance
};

/** @brief calibrateGlass for a rigid pair of cameras: all images of a view share one board pose.

@param objectPoints one array of N_i 3-D points per view.
@param imagePointsDirect1 per view, camera 1 without window, or noArray().
@param imagePointsRefracted1 per view, camera 1 through its window. NaN: the point was not seen. Empty: there is no image.
@param imagePointsDirect2 per view, camera 2 without window, or noArray().
@param imagePointsRefracted2 per view, camera 2 through its window.
@param camera1 initial value and result.
@param camera2 initial value and result.
@param R 3x3 or rotation vector, camera 1 -> camera 2; result with GLASS_FREE_EXTRINSICS, or where cameraCovariances leaves
them open, 3x3 CV_64F (a Vec3d stays a rotation vector).
@param T 3x1; result as R.
@param rvecs object -> camera 1 rotation vector of each view.
@param tvecs object -> camera 1 translation of each view.
@param options see GlassRigOptions; without GLASS_USE_POSES. With GLASS_SHARED_WINDOW the window of camera 1 is the initial
value, and camera 2's normal and distance follow from R and T.
@return see GlassRigResult.

Throws as calibrateGlass.
*/
CV_EXPORTS_W GlassRigResult stereoCalibrateGlass(InputArrayOfArrays objectPoints,
        InputArrayOfArrays imagePointsDirect1, InputArrayOfArrays imagePointsRefracted1,
        InputArrayOfArrays imagePointsDirect2, InputArrayOfArrays imagePointsRefracted2,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        InputOutputArray R, InputOutputArray T, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
        const GlassRigOptions& options = GlassRigOptions());

/** @brief calibrateGlass for any number of cameras, with separate or shared windows: the general form of calibrateGlass and
stereoCalibrateGlass.

All images of a view (all cameras at one time, through the window and direct) share one target pose. A camera need not see
every view, but the cameras must be connected by common views if R and T are free.

With GLASS_ROBUST outliers are rejected: hidden, smeared or wrongly detected points, and images whose target was moved. Initial
values come from random samples (the same ones in every call). Then the fit uses a redescending loss per point, graduated.
Last, each point is accepted or rejected; the probability to reject an inlier is 1e-4, so that clean data give the same result
as without the flag. If direct and refracted images of a view contradict each other, more than in the other views, its direct
images are rejected.

A sealed rig (GlassCalibrationFlags) with GLASS_FREE_EXTRINSICS does not need good initial values: first each camera is
calibrated by itself, from many initial values, then pairs that share a window, then the rig. R and T follow from the views.
This is not done with GLASS_ROBUST.

With GLASS_USE_POSES the poses rvecs, tvecs are known from another source (a robot, a jig). The covariance of a pose is a
prior, weighted against the noise of the pixels, which is estimated. If lens, thickness and index are known too, one view
determines the normal.

@param objectPoints one array of N_i 3-D points per view: any target, planar or not, different views may have different
targets.
@param imagePointsDirect per camera, per view: the same points of the same, unmoved target seen without the window; may be
empty as a whole.
@param imagePointsRefracted per camera, per view: the points seen through the window. One coordinate NaN: half a pixel (here
and in imagePointsDirect). Both NaN: the point was not seen. An empty array: there is no image. An empty list: the camera has
none. A view of which no camera has an image counts for nothing; its pose becomes NaN.
@param cameras one per camera, initial value and result: window and, with GLASS_FREE_INTRINSICS, lens.
@param windowOfCamera per camera: the index of its window. Cameras with equal numbers share one window; empty: each camera has
its own. The initial value of a shared window is that of its first camera; for the others it follows from R and T.
@param Rs 3x3 rotation (or rotation vector) camera 1 -> camera, one per camera; the first is the identity, within rounding.
Result with GLASS_FREE_EXTRINSICS, or where cameraCovariances leaves them open. Not used for one camera. May be empty, with Ts,
for a sealed rig with GLASS_FREE_EXTRINSICS.
@param Ts 3x1, as Rs.
@param rvecs object -> camera 1 rotation vector of each view; with GLASS_USE_POSES also input. NaN for a view whose
observations are all rejected.
@param tvecs object -> camera 1 translation of each view; as rvecs.
@param options see GlassRigOptions.
@return see GlassRigResult.

A camera without a window (no layer, equal media) may be part of the rig if other windows refract.

Throws as calibrateGlass, also without Ceres, and with GLASS_ROBUST if fewer than half of all points are inliers.
*/
CV_EXPORTS_AS(calibrateGlassRigExtended) GlassRigResult calibrateGlassRig(InputArrayOfArrays objectPoints,
        const std::vector<std::vector<Mat> >& imagePointsDirect,
        const std::vector<std::vector<Mat> >& imagePointsRefracted,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
        InputOutputArrayOfArrays rvecs, InputOutputArrayOfArrays tvecs, const GlassRigOptions& options);

/** @overload
The short form: the results are lenses and windows in cameras and (with GLASS_FREE_EXTRINSICS) Rs and Ts.
*/
CV_EXPORTS_W double calibrateGlassRig(InputArrayOfArrays objectPoints,
        const std::vector<std::vector<Mat> >& imagePointsDirect,
        const std::vector<std::vector<Mat> >& imagePointsRefracted,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
        OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

/** @brief Chooses how many coefficients of a lens the images can determine.

Candidates are the lens without coefficients, with k1, with k1 and k2, with p1 and p2 too, then k3, k4, k5, k6, and so on,
as far as the cameras' lenses have them. Each is fitted, and each view is held out in turn: its error, its pose fitted to it,
is that of the fit to the other views (to first order, without fitting again). If there are fewer than 4 views, eighths of each
target are held out, their poses fitted to the others. The candidate with the least held-out error is chosen; by eighths, that
with the fewest coefficients which is at most 2 % and one standard error of the difference above it. Those with k4 to k6 have to
be better by a standard error; of them the one with most coefficients that is not worse by as much is chosen. A fit that came to
no end counts as it is.

Give the images without the window, if there are enough of them (10 or more): only these, with cameras without a window, each
view seen by one camera. Then no window is fitted. Otherwise give the images through the windows.

@param objectPoints as calibrateGlassRig.
@param imagePointsDirect as calibrateGlassRig.
@param imagePointsRefracted as calibrateGlassRig, or empty as a whole.
@param cameras initial value: lenses with as many coefficients as there may be (usually 8; of a fisheye lens 4), and windows.
Result: the lens that is chosen; its other coefficients are 0. The windows stay as they are.
@param windowOfCamera as calibrateGlassRig.
@param Rs as calibrateGlassRig, initial value; may be empty as there.
@param Ts as Rs.
@param flags see GlassCalibrationFlags, without GLASS_USE_POSES; GLASS_FREE_INTRINSICS is always set. With GLASS_ROBUST points
are left out that are more than 5 standard deviations from the fit of the richest candidate. Known poses and prior knowledge
are not used.
@param scores Nx4 CV_64F, one row per candidate: its flags (GLASS_FIX_...), its number of coefficients, its held-out RMS error
in pixels, and the standard error of the difference of this error from the best; NaN: it cannot be fitted, or predicts no part.
@return the flags (GLASS_FIX_...) of the chosen candidate, to be added to those of the calibration. Throws as calibrateGlassRig
if no candidate can be fitted.
*/
CV_EXPORTS_W int selectLensCoefficients(InputArrayOfArrays objectPoints,
        const std::vector<std::vector<Mat> >& imagePointsDirect,
        const std::vector<std::vector<Mat> >& imagePointsRefracted,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputArrayOfArrays Rs, InputArrayOfArrays Ts, int flags = 0, OutputArray scores = noArray());

/** @overload
With what the images leave open of the coefficients that are left out: these are 0 as well as the images tell it, not exactly.
@param objectPoints as above.
@param imagePointsDirect as above.
@param imagePointsRefracted as above.
@param cameras as above.
@param windowOfCamera as above.
@param Rs as above.
@param Ts as above.
@param flags as above.
@param scores as above.
@param lensCovariances per camera, LxL CV_64F, for cameraCovariances of GlassRigOptions, with the flags of the choice: a prior
of mean 0 for coefficients that are left out (up to OpenCV's five, or the next one), NaN for all others; 0 for what neither
the images nor the corners of an image show. Those along the radius (k) have one standard deviation in pixels at the image's
corner, the tangential ones (p) another: the largest within half a unit of log likelihood of the likeliest (evidence,
@cite MacKay1992); of fewer than 4 views the likeliest. A calibration that is given it states what a simpler lens than the true
one would leave out. Through windows, with whose places coefficients exchange, it is wider by what that leaves open.
*/
CV_EXPORTS_AS(selectLensCoefficientsExtended) int selectLensCoefficients(InputArrayOfArrays objectPoints,
        const std::vector<std::vector<Mat> >& imagePointsDirect,
        const std::vector<std::vector<Mat> >& imagePointsRefracted,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputArrayOfArrays Rs, InputArrayOfArrays Ts, int flags, OutputArray scores, OutputArrayOfArrays lensCovariances);

/** @brief What the long forms of refractiveBundleAdjust take beside pixels, cameras, poses, points and lengths. What is not set
is as its text says of empty. A copy shares its matrices, as Mat does; no call changes them. */
struct CV_EXPORTS_W_SIMPLE BundleAdjustOptions
{
    CV_WRAP explicit BundleAdjustOptions(int flags = 0);

    CV_PROP_RW int flags;                   //!< see GlassCalibrationFlags
    CV_PROP_RW TermCriteria criteria;       //!< iterations and relative change of the cost at which to stop: 1000 and 1e-12
    CV_PROP_RW std::vector<Mat> poseCovariances; //!< with GLASS_USE_POSES, as GlassRigOptions
    CV_PROP_RW std::vector<Mat> cameraCovariances; //!< as GlassRigOptions, also of rvec and T
    /** Prior knowledge of all cameras together, in place of cameraCovariances (both throw): PxP (see the conventions), in the
    order of stdDeviations, the covariance of the initial values of cameras, Rs and Ts, for example of an earlier calibration,
    as readRig returns it. What has a variance is estimated within it, whatever the flags say; for the rest the flags decide. Of
    a window that cameras share, the rows of its first camera count. */
    CV_PROP_RW Mat rigCovariance;
    //! Of each pixel (see the conventions): per camera, per view, as imagePoints; of a list one array, {{array}}.
    CV_PROP_RW std::vector<std::vector<Mat> > pixelCovariances;
    /** Relative standard deviation of an error that all lengths share: one wand has the same wrong length at all times, and
    more times do not average that. It is estimated within it, and is in all uncertainties. 0: the errors of lengths are
    independent. NaN: not known, so that lengths tell proportions, but no scale. Negative or infinite throws. */
    CV_PROP_RW double lengthScaleStd;
    CV_PROP_RW bool computePointDeviations; //!< whether pointDeviations are wanted: true; they take time, and are empty if not
    CV_PROP_RW bool computeViewCovariances; //!< whether viewCovariances are wanted: true; they take time, and are empty if not
    /** Bytes that viewCovariances and pointDeviations may take while they are found, beside what the fit itself takes: the
    inverse of the views' equations, and how each point depends on views and cameras. Above it viewCovariances are NaN, and
    pointDeviations are those of points in known cameras and views, which are too small. 0: any. stdDeviations and covariance
    are always of all. Negative or NaN throws. */
    CV_PROP_RW double covarianceMemory;
};

//! What the long forms of refractiveBundleAdjust find beside cameras, places, poses and points.
struct CV_EXPORTS_W_SIMPLE BundleAdjustResult
{
    CV_WRAP BundleAdjustResult();

    CV_PROP_RW double rms;                  //!< RMS reprojection error in pixels over all points that were used
    CV_PROP_RW double pixelStd;             //!< estimated standard deviation of one coordinate of a usual pixel
    CV_PROP_RW int degreesOfFreedom;        //!< equations, those of lengths and prior knowledge too, less unknowns
    //! Px1 CV_64F: parameters of each camera (as calibrateGlass), then rvec (3) and T (3) of each but the first.
    CV_PROP_RW Mat stdDeviations;
    CV_PROP_RW Mat covariance;              //!< PxP in the same order; poses and points unknown; scaled by the residuals
    //! Mx3 CV_64F: one standard deviation of x, y, z of each point, with that of cameras and poses; NaN where the point is NaN.
    CV_PROP_RW Mat pointDeviations;
    /** One 6x6 CV_64F covariance of (rvec, tvec) per view, including the uncertainty of cameras and points; 0 where a pose is
    exact, NaN where the view has no observation in use. */
    CV_PROP_RW std::vector<Mat> viewCovariances;
    CV_PROP_RW Mat perViewErrors;           //!< VxC CV_64F: RMS of each image; NaN where there is none
    /** V*C masks Mx1 CV_8U, row by row: 0 where a point was not seen or was rejected; empty where there is no image. Of a list
    of observations one mask Nx1. */
    CV_PROP_RW std::vector<Mat> inliers;
};

/** @brief Bundle adjustment without a target: estimates cameras, their windows, poses and scene points from matches, with the
scale of known lengths.

One view: the rig does not move, as in motion capture and particle tracking. Each point is one observed position of an object:
a wand of known length at M/2 times gives M points, and M/2 lengths between them. Several views: the rig (or one camera) moves
through a static scene. Everything is one maximum-likelihood fit with equal isotropic pixel noise, which is estimated. The
points are eliminated (Schur complement), as in @cite Triggs2000, then the poses, by a sparse Cholesky: where each point is seen
by few views that are near each other, as in a strip, time and memory grow with the number of views. Where all views see the
same points, the cost of an iteration grows with the cube of their number. With many views and points, the form that takes a
list of observations needs less memory.

The scene's frame is that of the first view, whose pose is fixed; with one view and without rvecs, tvecs it is the frame of
camera 1. The scale comes from lengths, from R and T of several cameras if these are not free or have a covariance, or from the
poses with GLASS_USE_POSES. Without any of them this throws, because refraction alone hardly determines the scale. A parameter
that is hardly determined is not refused: it has a large value in stdDeviations.

@param imagePoints per camera, per view: Mx2 pixels of the M scene points, float32/float64. One coordinate NaN: half a pixel.
Both NaN: not seen in that image. An empty array: there is no image.
@param cameras one per camera, initial value and result: window and, with GLASS_FREE_INTRINSICS, lens.
@param windowOfCamera per camera: the index of its window, as in calibrateGlassRig; empty: each camera has its own.
@param Rs 3x3 rotation (or rotation vector) camera 1 -> camera, one per camera; the first is the identity, within rounding.
Initial value; result with GLASS_FREE_EXTRINSICS, or where cameraCovariances or rigCovariance leave them open. Not used for one
camera.
@param Ts 3x1, as Rs.
@param rvecs scene -> camera 1 rotation vector of each view, initial value and result; with one view it may be empty.
@param tvecs scene -> camera 1 translation of each view; as rvecs.
@param points3D M scene points, initial value and result, Nx1 3-channel. Empty, or NaN for a point: its initial value is
triangulated from its rays. The result is NaN for a point of which fewer than three coordinates were observed (with
GLASS_ROBUST: by inliers), whose rays do not meet, or that may as well be elsewhere, as half pixels and lengths leave some.
@param lengths Lx4 CV_64F (or std::vector<Vec4d>): index of a point, index of another, their distance, its standard
deviation > 0 (NaN: not known, so that it tells nothing); noArray(): none.
@param options see BundleAdjustOptions; without flags the normals, poses and points are free. With GLASS_FIX_NORMAL alone only
poses and points are estimated, with cameras as given, also without windows. With GLASS_ROBUST outliers are rejected: a fit with
Cauchy's loss, then a decision for each observation; an inlier is to be rejected with 1e-4 (4e-4 were, of matches with 10 %
outliers).
@return see BundleAdjustResult.

Throws if the data do not determine a free parameter, with its name; throws Error::StsNotImplemented in a build without Ceres.
*/
CV_EXPORTS_AS(refractiveBundleAdjustExtended) BundleAdjustResult refractiveBundleAdjust(
        const std::vector<std::vector<Mat> >& imagePoints,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
        InputOutputArrayOfArrays rvecs, InputOutputArrayOfArrays tvecs,
        InputOutputArray points3D, InputArray lengths, const BundleAdjustOptions& options);

/** @overload
The form for many views (hundreds to thousands of images of a large scene), each of which sees few of the points: a list of
observations, in any order. Its results are those of the form above, which takes every view by every point. Memory grows with
the list.
@param observations Nx3 int32, one row an observation: view, camera, point, each counted from 0; or std::vector<Vec3i>. Also
float64, of whole numbers. Views are those of rvecs, points those of points3D (where these are empty, as many as the list has).
Two rows may be of the same point in the same image: they are two observations.
@param imagePoints N pixels, one for each row of observations. One coordinate NaN: half a pixel. Both NaN: not seen.
@param cameras as above.
@param windowOfCamera as above.
@param Rs as above.
@param Ts as above.
@param rvecs as above, one per view; one that no observation is of may be NaN, and is NaN in the result.
@param tvecs as rvecs.
@param points3D as above.
@param lengths as above.
@param options as above.
@return see BundleAdjustResult.
*/
CV_EXPORTS_AS(refractiveBundleAdjustSparse) BundleAdjustResult refractiveBundleAdjust(
        InputArray observations, InputArray imagePoints,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
        InputOutputArrayOfArrays rvecs, InputOutputArrayOfArrays tvecs,
        InputOutputArray points3D, InputArray lengths, const BundleAdjustOptions& options);

/** @overload
The short form, for a rig that does not move (a moving wand, drifting particles). Cameras, windows, Rs and Ts are initial
values and results; flags say which are estimated.
@param imagePoints one array of Mx2 pixels per camera. One coordinate NaN: half a pixel. Both NaN: the point was not seen.
@param cameras as above.
@param windowOfCamera as above.
@param Rs as above.
@param Ts as above.
@param points3D as above, in the frame of camera 1.
@param lengths as above; at least one is needed if no pose is given.
@param flags see GlassCalibrationFlags, without GLASS_USE_POSES; 0 as for options.
@param criteria as BundleAdjustOptions.
@return RMS reprojection error in pixels.
*/
CV_EXPORTS_W double refractiveBundleAdjust(InputArrayOfArrays imagePoints,
        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
        InputOutputArray points3D, InputArray lengths, int flags = 0,
        TermCriteria criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12));

//! @}

//! @addtogroup refract_pose
//! @{

/** @brief Pose of a known target seen through the window (maximum likelihood).
@param objectPoints N >= 4 3-D points (three are enough with useExtrinsicGuess), or none.
@param imagePoints N raw pixels. One coordinate NaN: half a pixel. Both NaN: the point was not seen.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param rvec object -> camera rotation vector.
@param tvec object -> camera translation.
@param useExtrinsicGuess rvec, tvec are the initial values.
@param reprojectionError 1x1 CV_64F, pixels: RMS of the coordinates' differences, as in cv::solvePnPGeneric.
@return false if there is no pose: there are no points, fewer than 4 different ones (3 with useExtrinsicGuess) were seen, they
lie on a line, or no pose gives all of them an image. Then rvec and tvec are unchanged, and reprojectionError is empty. The
first guess is made from whole pixels, at least 4; with useExtrinsicGuess half pixels are enough, 6 coordinates in all.
*/
CV_EXPORTS_W bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess = false,
        OutputArray reprojectionError = noArray());

//! @overload
CV_EXPORTS_W bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArray rvec, OutputArray tvec,
        bool useExtrinsicGuess = false, OutputArray reprojectionError = noArray());

/** @brief refractiveSolvePnP with the covariance of the pose.
@param objectPoints as above.
@param imagePoints as above.
@param camera as above.
@param rvec as above.
@param tvec as above.
@param useExtrinsicGuess as above.
@param reprojectionError as above.
@param covariance 6x6 CV_64F of rvec (radians) and tvec (the caller's unit), in this order; NaN if sigma is not given and there
are no redundant observations (three points).
@param sigma standard deviation of a pixel's coordinate, in pixels; 0: estimated from the residuals.
@param cameraCovariance uncertainty of the camera: an LxL covariance of its L lens parameters, or a PxP one of its P parameters
in the order of RefractiveCamera::parameterNames(). It increases covariance; the pose does not change. noArray(): the camera is
exact.
@param pixelCovariances covariance of each pixel in units of the square of sigma (see the conventions). The pose is the most
likely one for them. noArray(): usual pixels.
@return as above; covariance is empty if there is no pose.
*/
CV_EXPORTS_AS(refractiveSolvePnPExtended) bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess,
        OutputArray reprojectionError, OutputArray covariance, double sigma = 0, InputArray cameraCovariance = noArray(),
        InputArray pixelCovariances = noArray());

/** @brief All poses of a known target that explain its image: the minima of the reprojection error, the smallest first.

Four or five points may have several poses, of which only the first few have small errors. A flat target has two. If it is
small or parallel to the image, the wrong one may have the smaller error because of noise. If both initial poses lead to the
same minimum, one pose is returned.

@param objectPoints as refractiveSolvePnP.
@param imagePoints as refractiveSolvePnP.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param rvecs object -> camera rotation vector of each pose, 3x1 CV_64F.
@param tvecs object -> camera translation of each pose, 3x1 CV_64F.
@param useExtrinsicGuess rvec, tvec are the initial values; only the pose to which they lead is returned.
@param rvec with useExtrinsicGuess.
@param tvec with useExtrinsicGuess.
@param reprojectionError Mx1 CV_64F, of each pose, as refractiveSolvePnP.
@return the number M of poses, 0 if there is none.
*/
CV_EXPORTS_W int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, bool useExtrinsicGuess = false,
        InputArray rvec = noArray(), InputArray tvec = noArray(), OutputArray reprojectionError = noArray());

//! @overload
CV_EXPORTS_W int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
        bool useExtrinsicGuess = false, InputArray rvec = noArray(), InputArray tvec = noArray(),
        OutputArray reprojectionError = noArray());

/** @brief refractiveSolvePnPGeneric with the covariance of each pose.
@param objectPoints as above.
@param imagePoints as above.
@param camera as above.
@param rvecs as above.
@param tvecs as above.
@param useExtrinsicGuess as above.
@param rvec as above.
@param tvec as above.
@param reprojectionError as above.
@param covariances 6x6 CV_64F of each pose, as refractiveSolvePnP has it.
@param sigma as refractiveSolvePnP has it.
@param cameraCovariance as refractiveSolvePnP has it.
@return as above.
*/
CV_EXPORTS_AS(refractiveSolvePnPGenericExtended) int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
        bool useExtrinsicGuess, InputArray rvec, InputArray tvec, OutputArray reprojectionError,
        OutputArrayOfArrays covariances, double sigma = 0, InputArray cameraCovariance = noArray());

/** @brief All poses with three points exactly on the rays of their pixels: cv::solveP3P through a window.

There are up to four without a window. With a window there are up to eight, because its rays do not pass through one point. All
are found.

@param objectPoints 3 or 4 3-D points, or none.
@param imagePoints as many raw pixels. NaN: the point was not seen.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param rvecs object -> camera rotation vector of each pose, 3x1 CV_64F. With a fourth point the poses are sorted by its error,
the smallest first, and poses in which it has no image are left out.
@param tvecs object -> camera translation of each pose, 3x1 CV_64F.
@return the number of poses; 0 for example if the first three points lie on a line or one of them was not seen.
*/
CV_EXPORTS_W int refractiveSolveP3P(InputArray objectPoints, InputArray imagePoints,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs);

//! @overload
CV_EXPORTS_W int refractiveSolveP3P(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs);

/** @brief Pose of a known target from matches with outliers: cv::solvePnPRansac through a window.

Each sample of three points (the same samples in every call) gives poses exactly; the ray of each pixel has its own origin. A
pose is scored by the reprojection errors of all points in the raw image. The best pose is refined (maximum likelihood) on its
inliers. If there are at least a dozen, those with outlying residuals are left out of this fit: a right match with the
probability 1e-4.

@param objectPoints N 3-D points; some may be matched to a wrong pixel.
@param imagePoints N raw pixels. NaN: the point was not seen.
@param cameraMatrix 3x3.
@param distCoeffs 0, 4, 5, 8, 12 or 14 coefficients.
@param window see GlassWindow.
@param rvec object -> camera rotation vector.
@param tvec object -> camera translation.
@param useExtrinsicGuess rvec, tvec are an additional hypothesis, the first.
@param iterationsCount maximum number of samples. With a share w of inliers and a confidence p the search needs log(1 -
p)/log(1 - w^3) samples: 169 for w = 0.3 and p = 0.99.
@param reprojectionError largest reprojection error of an inlier, pixels.
@param confidence the search ends when a sample without outliers has this probability; less than 1.
@param inliers Kx1 CV_32S, indices of the inliers, ascending.
@return false if no pose has enough inliers: at least 4 different points, not on a line, and more inliers than a pose of random
matches would have (or all points that were seen). Then rvec and tvec are unchanged, and inliers is empty.
*/
CV_EXPORTS_W bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints,
        InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
        OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess = false, int iterationsCount = 100,
        float reprojectionError = 8.0f, double confidence = 0.99, OutputArray inliers = noArray());

//! @overload
CV_EXPORTS_W bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArray rvec, OutputArray tvec,
        bool useExtrinsicGuess = false, int iterationsCount = 100, float reprojectionError = 8.0f,
        double confidence = 0.99, OutputArray inliers = noArray());

/** @brief refractiveSolvePnPRansac with the covariance of the pose.
@param objectPoints as above.
@param imagePoints as above.
@param camera as above.
@param rvec as above.
@param tvec as above.
@param useExtrinsicGuess as above.
@param iterationsCount as above.
@param reprojectionError as above.
@param confidence as above.
@param inliers as above.
@param covariance 6x6 CV_64F, as refractiveSolvePnP has it, from the inliers without outlying residuals.
@param sigma as refractiveSolvePnP has it.
@param cameraCovariance as refractiveSolvePnP has it.
@return as above; covariance is empty if there is no pose.
*/
CV_EXPORTS_AS(refractiveSolvePnPRansacExtended) bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints,
        const Ptr<RefractiveCamera>& camera, OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess,
        int iterationsCount, float reprojectionError, double confidence, OutputArray inliers,
        OutputArray covariance, double sigma = 0, InputArray cameraCovariance = noArray());

/** @brief Relative pose of two calibrated cameras from matches with outliers: cv::recoverPose through windows. It also
estimates the distance between the cameras, as exactly as refraction determines it.

Two pinhole cameras do not determine the scale. Behind windows the rays of a camera do not pass through one point, and the
offsets are known lengths. So the scale has an effect on pixels, but a weak one, and weaker for scenes farther away. The
estimate has the maximum likelihood (Sampson error, by refractiveEpipolarDistance) of all inliers over all scales; its
uncertainty is scaleInterval. R and the direction of T are determined, less exactly than for pinhole cameras, because the
length is estimated with them. If the cameras hardly move (T is shorter than the windows are deep) and the windows rotate with
the cameras by some degrees, the errors are some hundredths of a degree in R and a part of a unit in T, as stated by
covariance.

Matches of a flat scene have two poses, as in cv::decomposeHomographyMat. Usually refraction, or a point that would be behind a
camera, excludes one of them. A match that alone determines a direction of the pose (one point off a plane) cannot be checked
and is left out.

@param points1 N >= 6 raw pixels of camera 1, or none (0 inliers); NaN points are ignored.
@param points2 N raw pixels of camera 2.
@param cameraMatrix1 3x3.
@param distCoeffs1 0, 4, 5, 8, 12 or 14 coefficients.
@param window1 of camera 1.
@param cameraMatrix2 3x3.
@param distCoeffs2 0, 4, 5, 8, 12 or 14 coefficients.
@param window2 of camera 2.
@param R 3x3 CV_64F, camera 1 -> camera 2.
@param T 3x1 CV_64F, camera 1 -> camera 2. Its length is 1 if nothing determines the scale (no window refracts). If the most
likely length is infinite, it is the low end of scaleInterval.
@param prob the search ends when a sample without outliers has this probability; less than 1.
@param threshold largest error of an inlier, pixels: the root of the sum of squares of both pixels' distances from the images
of one point.
@param mask Nx1 CV_8U, 1 for inliers. It is output only, unlike that of cv::recoverPose.
@return the number of inliers. It is 0, with R and T unchanged, if no pose has more than 6 different inliers and more inliers
than a pose of random matches would have (or all matches), or if two poses are equally likely.
*/
CV_EXPORTS_W int refractiveRecoverPose(InputArray points1, InputArray points2,
        InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
        InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
        OutputArray R, OutputArray T, double prob = 0.999, double threshold = 1.0, OutputArray mask = noArray());

//! @overload
CV_EXPORTS_W int refractiveRecoverPose(InputArray points1, InputArray points2,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        OutputArray R, OutputArray T, double prob = 0.999, double threshold = 1.0, OutputArray mask = noArray());

/** @brief refractiveRecoverPose with the uncertainty of the estimate.
@param points1 N raw pixels of camera 1.
@param points2 N raw pixels of camera 2.
@param camera1 lens and window of camera 1.
@param camera2 lens and window of camera 2.
@param R 3x3 CV_64F.
@param T 3x1 CV_64F.
@param prob as above.
@param threshold as above.
@param mask as above.
@param covariance 6x6 CV_64F of the rotation vector of R and of T, scaled by the residuals. If scaleInterval has no upper end,
it is that of R and the direction of T only, for the returned length (its rank is 5); where the noise explains as well that all
points are infinitely far, T has no direction, and all but the part of R is NaN.
@param scaleInterval 95 % confidence interval of the length of T, low and high end, from the profile likelihood. If refraction
gives little information, it is not symmetric, and its high end may be infinite. (0, infinity): no information.
@param cameraCovariances uncertainty of both cameras: an LxL covariance of the L lens parameters, or a PxP one of the P
parameters in the order of RefractiveCamera::parameterNames(), or an empty one: exact. It increases covariance and
scaleInterval; R and T do not change. noArray(): both are exact.
@return as above; 0: covariance and scaleInterval are NaN.
*/
CV_EXPORTS_AS(refractiveRecoverPoseExtended) int refractiveRecoverPose(InputArray points1, InputArray points2,
        const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
        OutputArray R, OutputArray T, double prob, double threshold, OutputArray mask,
        OutputArray covariance, CV_OUT Vec2d& scaleInterval,
        InputArrayOfArrays cameraCovariances = noArray());

//! @}

}} // namespace cv::refract

#endif // OPENCV_REFRACT_HPP
