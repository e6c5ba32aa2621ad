#include "wrong_points.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Images = std::vector<std::vector<Mat>>;       // per camera, per view

Images imagesOf(const RigData& data, bool glass)
{
    Images images(data.cameraCount);
    for (int c = 0; c < data.cameraCount; c++)
        for (const Moment& m : data.moments)
            images[c].push_back(Mat(glass ? m.glass[c] : m.direct[c], true));
    return images;
}

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
    const Rig rig = start.clone();
    const int cameras = data.cameraCount, stereo = cameras == 2 ? GLASS_FREE_EXTRINSICS : 0;
    std::vector<int> windows = {0};
    std::vector<Mat> Rs = {Mat::eye(3, 3, CV_64F)}, Ts = {Mat::zeros(3, 1, CV_64F)}, rvecs, tvecs, inliers;
    if (cameras == 2)
    {
        windows.push_back(flags & GLASS_SHARED_WINDOW ? 0 : 1);
        Rs.push_back(Mat(rig.R, true));
        Ts.push_back(Mat(rig.T, true));
    }
    Mat status;
    try
    {
        calibrateGlassRig(std::vector<std::vector<Point3d>>(data.moments.size(), data.objectPoints), imagesOf(data, true),
                          imagesOf(data, false), rig.cameras, windows, Rs, Ts, rvecs, tvecs, noArray(), noArray(), noArray(),
                          status, inliers, noArray(), (flags & ~GLASS_SHARED_WINDOW) | GLASS_ROBUST | stereo);
    }
    catch (const cv::Exception& e)
    {
        return {{}, e.err};
    }
    WrongPoints wrong;
    for (int i = 0; i < (int)data.moments.size(); i++)
        for (int c = 0; c < cameras; c++)
            for (bool glass : {true, false})
            {
                Moment& m = data.moments[i];
                const int column = 2 * c + !glass;
                Dropped dropped{m.stem, c, glass, 0, false, ""};
                if (clean(glass ? m.glass[c] : m.direct[c], status.at<uchar>(i, column), inliers[2 * cameras * i + column], dropped))
                    wrong.dropped.push_back(dropped);
            }
    return wrong;
}

} // namespace tools
