// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"

/* A window as a map in a file. */

namespace cv { namespace refract {

//! By WindowShape.
static const char* const shapeNames[] = { "flat", "dome", "tube", "bent" };

void GlassWindow::write(FileStorage& fs) const
{
    // Vectors as plain sequences: readable by hand and by any YAML parser.
    const auto writeVector = [&](const char* key, const Vec3d& v) { fs << key << "[:" << v[0] << v[1] << v[2] << "]"; };
    fs << "{";
    if (shape != WINDOW_FLAT)
        fs << "shape" << shapeNames[shape];
    if (shape == WINDOW_DOME || shape == WINDOW_TUBE)
        writeVector("center", center);
    if (shape == WINDOW_TUBE)
        writeVector("axis", axis);
    if (shape == WINDOW_FLAT || shape == WINDOW_BENT)
        writeVector("normal", normal);
    if (shape == WINDOW_DOME || shape == WINDOW_TUBE)
        fs << "radius" << radius;
    else
        fs << "distance" << distance;
    if (shape == WINDOW_BENT)
        fs << "curvature" << curvature;
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

//! Zero stays, and is refused later.
static Vec3d ofUnitLength(const Vec3d& v)
{
    const double length = cv::norm(v);
    return length > 0 ? v/length : v;
}

//! Keys of another shape are refused: a file that says a radius and no shape is not a flat window.
static int readShape(const FileNode& map)
{
    const FileNode node = map["shape"];
    const String name = node.empty() ? "flat" : node.isString() ? (String)node : String("not a text");
    const auto found = std::find(std::begin(shapeNames), std::end(shapeNames), name);
    if (found == std::end(shapeNames))
        CV_Error_(Error::StsParseError, ("glass_window.shape is '%s'; it must be flat, dome, tube or bent", name.c_str()));
    const int shape = (int)(found - std::begin(shapeNames));
    const bool isRound = shape == WINDOW_DOME || shape == WINDOW_TUBE;
    std::vector<const char*> others = isRound ? std::vector<const char*>{ "normal", "distance" }
                                              : std::vector<const char*>{ "center", "radius" };
    if (shape != WINDOW_TUBE)
        others.push_back("axis");
    if (shape != WINDOW_BENT)
        others.push_back("curvature");
    for (const char* other : others)
        if (!map[other].empty())
            CV_Error_(Error::StsParseError, ("glass_window has '%s', but its shape is %s", other, name.c_str()));
    return shape;
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
    const std::vector<std::string> known = { "shape", "normal", "distance", "center", "axis", "radius", "curvature", "thickness", "index",
                                             "inner_index", "outer_index", "wedge", "materials", "wavelength" };
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
    if (window.shape == WINDOW_DOME || window.shape == WINDOW_TUBE)
        window.center = readVector(node, "center");
    else
        window.normal = ofUnitLength(readVector(node, "normal"));
    if (window.shape == WINDOW_TUBE)
        window.axis = ofUnitLength(readVector(node, "axis"));
    window.curvature = readNumber(node, "curvature", 0);
    window.distance = readNumber(node, "distance", 0);
    window.radius = readNumber(node, "radius", 0);
    window.thickness = readSequence(node, "thickness");
    window.index = readSequence(node, "index");
    window.innerIndex = readNumber(node, "inner_index", 1);
    window.outerIndex = readNumber(node, "outer_index", 1);
    window.wedge = readPairs(node, "wedge");
    readMaterials(node, window);
    const bool needsDistance = window.shape == WINDOW_BENT || (window.shape == WINDOW_FLAT && window.innerIndex != window.outerIndex);
    if (needsDistance && node["distance"].empty())
        CV_Error(Error::StsParseError, "glass_window has no 'distance', which counts where it is bent or has different media on its sides");
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
