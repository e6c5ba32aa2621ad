#include "wrong_points.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const char* reasonOf(uchar status)
{
    switch (status)
    {
    case GLASS_IMAGE_MOVED: return "its board is not where the other images of the moment have it";
    case GLASS_IMAGE_UNUSABLE: return "hardly any of its points fit one pose of the board";
    default: return "points that do not fit: hidden, smeared or wrongly detected";
    }
}

//! Takes the marked points out; true if there were any.
bool clean(std::vector<Point2d>& pixels, uchar status, const Mat& inliers, Dropped& dropped)
{
    dropped.image = status == GLASS_IMAGE_MOVED || status == GLASS_IMAGE_UNUSABLE;
    dropped.why = reasonOf(status);
    dropped.points = 0;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        if (!seen(pixels[i]) || (!dropped.image && inliers.at<uchar>((int)i)))
            continue;
        pixels[i] = Point2d(NAN, NAN);
        dropped.points++;
    }
    if (dropped.image)
        pixels.clear();
    return dropped.points > 0;
}

} // namespace

std::string Dropped::sentence() const
{
    return format("'%s' (camera %d, %s): %s: %s", view.c_str(), camera + 1, glass ? "through the window" : "direct",
                  image ? "the whole image" : format("%d point(s)", points).c_str(), why.c_str());
}

WrongPoints dropWrongPoints(RigData& data, const Rig& start, int flags)
{
    Fit fit;
    try
    {
        fit = fitRig(data, start, allMoments(data), flags | GLASS_ROBUST);
    }
    catch (const cv::Exception& e)
    {
        return {{}, e.err};
    }
    WrongPoints wrong;
    for (int i = 0; i < (int)data.moments.size(); i++)
        for (int c = 0; c < data.cameraCount; c++)
            for (bool glass : {true, false})
            {
                Moment& m = data.moments[i];
                const int column = 2 * c + glass;
                Dropped dropped{m.stem, c, glass, 0, false, ""};
                if (clean(glass ? m.glass[c] : m.direct[c], fit.imageStatus.at<uchar>(i, column),
                          fit.inliers[fit.imageStatus.cols * i + column], dropped))
                    wrong.dropped.push_back(dropped);
            }
    return wrong;
}

} // namespace tools
