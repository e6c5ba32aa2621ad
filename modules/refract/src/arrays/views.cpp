// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/views.hpp"
#include "arrays/arrays.hpp"

namespace cv { namespace refract {

static int countViews(InputArrayOfArrays a, const char* name)
{
    if (a.kind() == _InputArray::NONE || a.empty())
        return 0;
    const int kind = a.kind();
    if (kind != _InputArray::STD_VECTOR_VECTOR && kind != _InputArray::STD_VECTOR_MAT &&
        kind != _InputArray::STD_ARRAY_MAT && kind != _InputArray::STD_VECTOR_UMAT)
        CV_Error_(Error::StsBadArg, ("%s is one array; it must be a vector of arrays, one per view", name));
    return (int)a.total();
}

PixelViews readPixelViews(InputArrayOfArrays a, const char* name)
{
    PixelViews views(countViews(a, name));
    for (int i = 0; i < (int)views.size(); i++)
    {
        const Mat view = a.getMat(i);
        if (!view.empty())
            views[i] = readPoints2(view, format("%s[%d]", name, i).c_str());
    }
    return views;
}

std::vector<std::vector<Point3d> > readObjectViews(InputArrayOfArrays a, const char* name)
{
    std::vector<std::vector<Point3d> > views(countViews(a, name));
    if (views.empty())
        CV_Error_(Error::StsBadArg, ("%s is empty; at least one view is needed", name));
    for (int i = 0; i < (int)views.size(); i++)
    {
        const Mat view = a.getMat(i);
        if (!view.empty())
            views[i] = readPoints3(view, format("%s[%d]", name, i).c_str());
        for (const Point3d& p : views[i])
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                CV_Error_(Error::StsBadArg, ("%s[%d] holds the point (%g, %g, %g); it must be finite",
                                             name, i, p.x, p.y, p.z));
    }
    return views;
}

static void matchViews(PixelViews& pixels, const std::vector<std::vector<Point3d> >& object, const char* name)
{
    if (pixels.empty())
        pixels.resize(object.size());
    if (pixels.size() != object.size())
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d views, objectPoints %d; they must agree",
                                             name, (int)pixels.size(), (int)object.size()));
    for (size_t i = 0; i < pixels.size(); i++)
        if (!pixels[i].empty() && pixels[i].size() != object[i].size())
            CV_Error_(Error::StsUnmatchedSizes, ("%s[%d] has %d points, objectPoints[%d] has %d; they must agree",
                                                 name, (int)i, (int)pixels[i].size(), (int)i, (int)object[i].size()));
}

CameraViews readCameraViews(InputArrayOfArrays direct, const char* directName,
                            InputArrayOfArrays refracted, const char* refractedName,
                            const std::vector<std::vector<Point3d> >& object)
{
    CameraViews views;
    views.direct = readPixelViews(direct, directName);
    views.refracted = readPixelViews(refracted, refractedName);
    matchViews(views.direct, object, directName);
    matchViews(views.refracted, object, refractedName);
    return views;
}

int countSeen(const std::vector<Point2d>& pixels)
{
    return (int)std::count_if(pixels.begin(), pixels.end(), isSeen);
}

bool seesAnything(const PixelViews& views)
{
    for (const std::vector<Point2d>& view : views)
        if (std::any_of(view.begin(), view.end(), isSeen))
            return true;
    return false;
}

ImagePoints observed(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels)
{
    ImagePoints points;
    for (size_t i = 0; i < pixels.size(); i++)
        if (isSeen(pixels[i]))
        {
            points.object.push_back(object[i]);
            points.pixel.push_back(pixels[i]);
            points.index.push_back((int)i);
        }
    return points;
}

}} // namespace
