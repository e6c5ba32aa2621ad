// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

GlassWindow::GlassWindow()
    : shape(WINDOW_FLAT), normal(0, 0, 1), distance(0), center(0, 0, 0), axis(0, 0, 0), radius(0), curvature(0), innerIndex(1),
      outerIndex(1), wavelength(0) {}

//! The unit normal, after a check of everything.
static Vec3d checkedNormal(const Vec3d& normal, double thickness, double index, double distance, double outerIndex)
{
    const double length = cv::norm(normal);
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsBadArg, ("normal is (%g, %g, %g); it must be finite and not zero",
                                     normal[0], normal[1], normal[2]));
    GlassWindow window;
    window.normal = normal/length;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.distance = distance;
    window.outerIndex = outerIndex;
    window.check();
    return window.normal;
}

// What is wrong is found before any member is made: OpenCV's bindings destroy an object whose constructor threw once more.
// A window that a function returns would not do: it may be made, and destroyed, in this one's place.
GlassWindow::GlassWindow(const Vec3d& normal_, double thickness_, double index_, double distance_, double outerIndex_)
    : shape(WINDOW_FLAT), normal(checkedNormal(normal_, thickness_, index_, distance_, outerIndex_)), distance(distance_),
      center(0, 0, 0), axis(0, 0, 0), radius(0), curvature(0), thickness(1, thickness_), index(1, index_), innerIndex(1),
      outerIndex(outerIndex_), wavelength(0) {}

GlassWindow GlassWindow::dome(const Vec3d& center, double radius, double thickness, double index, double outerIndex)
{
    GlassWindow window;
    window.shape = WINDOW_DOME;
    window.center = center;
    window.radius = radius;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.outerIndex = outerIndex;
    window.check();
    return window;
}

GlassWindow GlassWindow::tube(const Vec3d& axisPoint, const Vec3d& axisDirection, double radius, double thickness, double index,
                              double outerIndex)
{
    const double length = cv::norm(axisDirection);
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsBadArg, ("axisDirection is (%g, %g, %g); it must be finite and not zero", axisDirection[0],
                                     axisDirection[1], axisDirection[2]));
    GlassWindow window;
    window.shape = WINDOW_TUBE;
    window.axis = axisDirection/length;
    window.center = axisPoint - axisPoint.dot(window.axis)*window.axis;
    window.radius = radius;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.outerIndex = outerIndex;
    window.check();
    return window;
}

//! layer >= 0: the name's element. Nothing is formatted unless it is wrong: cameras may be made by the call.
static void checkBetween(const char* name, double value, double least, double most, int layer = -1)
{
    if (value >= least && value <= most)
        return;
    const String element = layer < 0 ? String() : format("[%d]", layer);
    if (value > most && std::isfinite(value))
        CV_Error_(Error::StsOutOfRange, ("%s%s is %g; it must be at most %g", name, element.c_str(), value, most));
    CV_Error_(Error::StsOutOfRange, ("%s%s is %g; it must be finite and at least %g", name, element.c_str(), value, least));
}

//! Faces that lean by a right angle are no window; and where a thickness is 0, faces that lean meet on the axis.
static void checkWedge(const GlassWindow& window)
{
    if (!window.wedge.empty() && window.wedge.size() != window.thickness.size())
        CV_Error_(Error::StsUnmatchedSizes, ("window.wedge has %d layers, window.thickness %d; it must be empty, or they must agree",
                                             (int)window.wedge.size(), (int)window.thickness.size()));
    Vec2d lean;
    for (size_t i = 0; i < window.wedge.size(); i++)
    {
        const Vec2d& w = window.wedge[i];
        lean += w;
        if (!(cv::norm(w) < CV_PI/2))
            CV_Error_(Error::StsOutOfRange, ("window.wedge[%d] is (%g, %g); it must be finite and below 90 degrees, in radians", (int)i,
                                             w[0], w[1]));
        if (!(cv::norm(lean) < CV_PI/2))
            CV_Error_(Error::StsOutOfRange, ("window.wedge[0] to [%d] add up to (%g, %g); that must be below 90 degrees, in radians",
                                             (int)i, lean[0], lean[1]));
    }
    const bool isTilted = std::any_of(window.wedge.begin(), window.wedge.end(), [](const Vec2d& w) { return w != Vec2d(); });
    for (size_t i = 0; isTilted && i < window.thickness.size(); i++)
        if (!(window.thickness[i] > 0))
            CV_Error_(Error::StsOutOfRange, ("window.thickness[%d] is %g; it must be positive in a window with a wedge", (int)i,
                                             window.thickness[i]));
}

//! What the other shape has is not silently ignored.
static void checkUnused(const char* name, bool isInitial, const char* text, const char* shape)
{
    if (!isInitial)
        CV_Error_(Error::StsBadArg, ("window.%s is set, but the window is %s: it must stay %s", name, shape, text));
}

static void checkFlat(const GlassWindow& window)
{
    const Vec3d& normal = window.normal;
    const double length = cv::norm(normal);
    // Room for a normal that was stored as float or printed with six digits; the kernels normalise once more.
    if (!(std::abs(length - 1) < 1e-5))
        CV_Error_(Error::StsBadArg, ("window.normal is (%g, %g, %g) with length %g; it must be a unit vector",
                                     normal[0], normal[1], normal[2], length));
    if (!(normal[2] > 0))
        CV_Error_(Error::StsBadArg, ("window.normal is (%g, %g, %g); it must point from the camera to the scene, "
                                     "normal[2] > 0", normal[0], normal[1], normal[2]));
    checkBetween("window.distance", window.distance, 0, MAX_LENGTH);
    checkUnused("center", window.center == Vec3d(), "(0, 0, 0)", "flat (window.shape)");
    checkUnused("radius", window.radius == 0, "0", "flat (window.shape)");
}

static void checkDome(const GlassWindow& window)
{
    const Vec3d& center = window.center;
    const double offset = cv::norm(center);
    if (!(window.radius > 0 && window.radius <= MAX_LENGTH))
        CV_Error_(Error::StsOutOfRange, ("window.radius is %g; it must be positive and finite", window.radius));
    if (!std::isfinite(offset))
        CV_Error_(Error::StsBadArg, ("window.center is (%g, %g, %g); it must be finite", center[0], center[1], center[2]));
    if (!(offset < window.radius))
        CV_Error_(Error::StsOutOfRange, ("window.center is (%g, %g, %g), %g from the camera; the camera must be inside the dome, whose "
                                         "window.radius is %g: that of its inner face, in the same unit", center[0], center[1],
                                         center[2], offset, window.radius));
    checkUnused("normal", window.normal == Vec3d(0, 0, 1), "(0, 0, 1)", "a dome");
    checkUnused("distance", window.distance == 0, "0", "a dome");
    checkUnused("wedge", window.wedge.empty(), "empty", "a dome");
}

void GlassWindow::check() const
{
    if (shape != WINDOW_FLAT && shape != WINDOW_DOME)
        CV_Error_(Error::StsOutOfRange, ("window.shape is %d; it must be WINDOW_FLAT (%d) or WINDOW_DOME (%d)", shape,
                                         (int)WINDOW_FLAT, (int)WINDOW_DOME));
    (shape == WINDOW_DOME ? checkDome : checkFlat)(*this);
    checkBetween("window.innerIndex", innerIndex, 1, MAX_INDEX);
    checkBetween("window.outerIndex", outerIndex, 1, MAX_INDEX);
    if (thickness.size() != index.size())
        CV_Error_(Error::StsUnmatchedSizes, ("window.thickness has %d layers, window.index %d; they must agree",
                                             (int)thickness.size(), (int)index.size()));
    for (size_t i = 0; i < thickness.size(); i++)
    {
        checkBetween("window.thickness", thickness[i], 0, MAX_LENGTH, (int)i);
        checkBetween("window.index", index[i], 1, MAX_INDEX, (int)i);
    }
    if (!wedge.empty())
        checkWedge(*this);
    checkBetween("window.wavelength", wavelength, 0, MAX_LENGTH);
    if (!materials.empty() && materials.size() != index.size() + 2)
        CV_Error_(Error::StsUnmatchedSizes, ("window.materials has %d names; it must be empty or have %d: inner medium, layers, "
                                             "outer medium", (int)materials.size(), (int)index.size() + 2));
}

GlassWindow GlassWindow::atWavelength(double wavelengthNm) const
{
    check();
    if (!(wavelengthNm > 0 && wavelengthNm <= MAX_LENGTH))
        CV_Error_(Error::StsOutOfRange, ("wavelengthNm is %g; it must be finite and more than 0", wavelengthNm));
    const bool refracts = !index.empty() || innerIndex != outerIndex;
    if (refracts && materials.empty())
        CV_Error(Error::StsBadArg, "window.materials is empty: nothing says how the indices change with the wavelength");
    GlassWindow window = *this;
    window.wavelength = wavelengthNm;
    for (size_t i = 0; i < materials.size(); i++)
    {
        if (materials[i].empty())
            continue;
        double& n = i == 0 ? window.innerIndex : i <= index.size() ? window.index[i - 1] : window.outerIndex;
        const double there = refractiveIndex(materials[i], wavelengthNm);
        n = wavelength > 0 ? n*(there/refractiveIndex(materials[i], wavelength)) : there;
    }
    window.check();
    return window;
}

void GlassWindow::write(FileStorage& fs) const
{
    // Vectors as plain sequences: readable by hand and by any YAML parser.
    if (shape == WINDOW_DOME)
        fs << "{" << "shape" << "dome" << "center" << "[:" << center[0] << center[1] << center[2] << "]" << "radius" << radius;
    else
        fs << "{" << "normal" << "[:" << normal[0] << normal[1] << normal[2] << "]" << "distance" << distance;
    fs << "thickness" << "[:";
    for (double t : thickness) fs << t;
    fs << "]" << "index" << "[:";
    for (double n : index) fs << n;
    fs << "]" << "inner_index" << innerIndex << "outer_index" << outerIndex;
    if (!wedge.empty())
    {
        fs << "wedge" << "[:";
        for (const Vec2d& w : wedge) fs << "[:" << w[0] << w[1] << "]";
        fs << "]";
    }
    if (wavelength > 0)
        fs << "wavelength" << wavelength;
    if (!materials.empty())
        fs << "materials" << materials;
    fs << "}";
}

static double readNumber(const FileNode& map, const char* key, double missing)
{
    const FileNode node = map[key];
    if (node.empty())
        return missing;
    if (!node.isReal() && !node.isInt())
        CV_Error_(Error::StsParseError, ("glass_window.%s is not a number", key));
    return (double)node;
}

static std::vector<double> readSequence(const FileNode& map, const char* key)
{
    std::vector<double> values;
    const FileNode node = map[key];
    if (node.isReal() || node.isInt())      // a single layer may be given without brackets
        return std::vector<double>(1, (double)node);
    for (FileNodeIterator it = node.begin(); it != node.end(); it++)
    {
        const FileNode item = *it;
        if (!item.isReal() && !item.isInt())
            CV_Error_(Error::StsParseError, ("glass_window.%s holds something that is not a number", key));
        values.push_back((double)item);
    }
    return values;
}

static Vec3d readVector(const FileNode& map, const char* key)
{
    const std::vector<double> v = readSequence(map, key);
    if (v.size() != 3)
        CV_Error_(Error::StsParseError, ("glass_window.%s has %d numbers; it must have 3", key, (int)v.size()));
    return Vec3d(v[0], v[1], v[2]);
}

//! Keys of another shape are refused: a file that says a radius and no shape is not a flat window.
static int readShape(const FileNode& map)
{
    const FileNode node = map["shape"];
    const String name = node.empty() ? "flat" : node.isString() ? (String)node : String("not a text");
    if (name != "flat" && name != "dome")
        CV_Error_(Error::StsParseError, ("glass_window.shape is '%s'; it must be flat or dome", name.c_str()));
    const bool isDome = name == "dome";
    for (const char* other : { isDome ? "normal" : "center", isDome ? "distance" : "radius" })
        if (!map[other].empty())
            CV_Error_(Error::StsParseError, ("glass_window has '%s', but its shape is %s", other, name.c_str()));
    return isDome ? WINDOW_DOME : WINDOW_FLAT;
}

static std::vector<Vec2d> readPairs(const FileNode& map, const char* key)
{
    std::vector<Vec2d> pairs;
    const FileNode node = map[key];
    for (FileNodeIterator it = node.begin(); it != node.end(); it++)
    {
        const FileNode pair = *it;
        if (!node.isSeq() || !pair.isSeq() || pair.size() != 2 || pair[0].isString() || pair[1].isString())
            CV_Error_(Error::StsParseError, ("glass_window.%s must be a list of pairs of numbers, one a layer", key));
        pairs.push_back(Vec2d((double)pair[0], (double)pair[1]));
    }
    return pairs;
}

static std::vector<String> readNames(const FileNode& map, const char* key)
{
    std::vector<String> names;
    const FileNode node = map[key];
    for (FileNodeIterator it = node.begin(); it != node.end(); it++)
    {
        const FileNode item = *it;
        if (!node.isSeq() || !item.isString())
            CV_Error_(Error::StsParseError, ("glass_window.%s must be a list of names", key));
        names.push_back((String)item);
    }
    return names;
}

//! The indices that the file leaves out, as its materials have them.
static void readMaterials(const FileNode& node, GlassWindow& window)
{
    window.wavelength = readNumber(node, "wavelength", 0);
    window.materials = readNames(node, "materials");
    if (window.materials.empty())
        return;
    const bool none = node["index"].empty() && node["inner_index"].empty() && node["outer_index"].empty();
    const double wavelength = window.wavelength > 0 ? window.wavelength : 550.;
    if (none)
    {
        window.index.assign(window.thickness.size(), 1.);
        window.wavelength = 0;
    }
    const GlassWindow catalogue = window.atWavelength(wavelength);      // and thereby every name is one that is known
    if (none)
        window = catalogue;
}

//! A slip in a name would leave what it names at its default: air.
static void checkKeys(const FileNode& map)
{
    const std::vector<std::string> known = { "shape", "normal", "distance", "center", "radius", "thickness", "index", "inner_index",
                                             "outer_index", "wedge", "materials", "wavelength" };
    std::string names;
    for (const std::string& name : known)
        names += (names.empty() ? "" : ", ") + name;
    for (FileNodeIterator it = map.begin(); it != map.end(); it++)
        if (std::find(known.begin(), known.end(), (*it).name()) == known.end())
            CV_Error_(Error::StsParseError, ("glass_window has '%s', which is none of %s", (*it).name().c_str(), names.c_str()));
}

void GlassWindow::read(const FileNode& node)
{
    if (!node.isMap())
        CV_Error(Error::StsParseError, "glass_window is not a map of normal, distance, thickness, index");
    checkKeys(node);
    GlassWindow window;
    window.shape = readShape(node);
    if (window.shape == WINDOW_DOME)
        window.center = readVector(node, "center");
    else
    {
        window.normal = readVector(node, "normal");
        const double length = cv::norm(window.normal);
        if (length > 0)
            window.normal /= length;
    }
    window.distance = readNumber(node, "distance", 0);
    window.radius = readNumber(node, "radius", 0);
    window.thickness = readSequence(node, "thickness");
    window.index = readSequence(node, "index");
    window.innerIndex = readNumber(node, "inner_index", 1);
    window.outerIndex = readNumber(node, "outer_index", 1);
    window.wedge = readPairs(node, "wedge");
    readMaterials(node, window);
    window.check();
    *this = window;
}

void write(FileStorage& fs, const String&, const GlassWindow& window) { window.write(fs); }

void read(const FileNode& node, GlassWindow& window, const GlassWindow& defaultValue)
{
    if (node.empty())
        window = defaultValue;
    else
        window.read(node);
}

}} // namespace
