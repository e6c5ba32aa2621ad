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

PixelViews readPixelViews(InputArrayOfArrays a, const char* name, HalfPixels halves)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    PixelViews views(countViews(a, name));
    for (int i = 0; i < (int)views.size(); i++)
    {
        const Mat view = a.getMat(i);
        if (!view.empty())
            views[i] = readPoints2(view, format("%s[%d]", name, i).c_str());
        for (Point2d& pixel : views[i])
            if (halves == HalfPixels::NOT_SEEN && !isWhole(pixel))
                pixel = Point2d(NaN, NaN);
    }
    return views;
}

CovarianceViews readCovarianceViews(const std::vector<Mat>& a, const PixelViews& pixels, const String& name)
{
    if (a.empty())
        return CovarianceViews();
    if (a.size() != pixels.size())
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d views, but the pixels have %d; they must agree", name.c_str(), (int)a.size(),
                                             (int)pixels.size()));
    CovarianceViews views;
    for (size_t i = 0; i < a.size(); i++)
        views.push_back(readPixelCovariances(a[i], pixels[i], format("%s[%d]", name.c_str(), (int)i)));
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
                            const std::vector<std::vector<Point3d> >& object, HalfPixels halves)
{
    CameraViews views;
    views.direct = readPixelViews(direct, directName, halves);
    views.refracted = readPixelViews(refracted, refractedName, halves);
    matchViews(views.direct, object, directName);
    matchViews(views.refracted, object, refractedName);
    return views;
}

int countSeen(const std::vector<Point2d>& pixels)
{
    return (int)std::count_if(pixels.begin(), pixels.end(), isSeen);
}

int countWhole(const std::vector<Point2d>& pixels)
{
    return (int)std::count_if(pixels.begin(), pixels.end(), isWhole);
}

bool seesAnything(const PixelViews& views)
{
    for (const std::vector<Point2d>& view : views)
        if (std::any_of(view.begin(), view.end(), isSeen))
            return true;
    return false;
}

int ImagePoints::rows() const
{
    int count = 0;
    for (size_t i = 0; i < pixel.size(); i++)
        count += rowsOf(i);
    return count;
}

ImagePoints observed(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels, const PixelCovariances& covariances,
                     double variance)
{
    ImagePoints points;
    const bool isUsual = covariances.empty() && variance == 1 && std::none_of(pixels.begin(), pixels.end(), isHalf);
    for (size_t i = 0; i < pixels.size(); i++)
        if (isSeen(pixels[i]))
        {
            if (!isUsual)
                points.whitening.push_back(Whitening(pixels[i], covariances.empty() ? PixelCovariance() : covariances[i],
                                                     std::sqrt(variance)));
            points.object.push_back(object[i]);
            points.pixel.push_back(pixels[i]);
            points.index.push_back((int)i);
        }
    return points;
}

}} // namespace
