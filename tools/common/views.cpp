#include "views.hpp"
#include "corners_vnl.hpp"
#include "progress.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <set>

namespace tools {

int View::seenCount() const
{
    return (int)std::count_if(points.begin(), points.end(), seen);
}

const View* ViewSet::find(const std::string& stem) const
{
    const auto found = std::find_if(views.begin(), views.end(), [&](const View& v) { return v.stem == stem; });
    return found == views.end() ? nullptr : &*found;
}

namespace {

std::string sizeText(cv::Size size)
{
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void addView(ViewSet& set, const std::string& path, const std::vector<cv::Point2d>& points)
{
    if (points.empty())
        set.withoutTarget.push_back(path);
    else
        set.views.push_back({stemOf(path), path, points});
}

//! Images are read and searched in parallel; the result and the error reported do not depend on the order.
ViewSet detectViews(const std::vector<std::string>& paths, const Target& target, cv::Size imageSize, bool quiet)
{
    const int count = (int)paths.size();
    std::vector<std::vector<cv::Point2d>> points(count);
    std::vector<cv::Size> sizes(count);
    std::vector<std::exception_ptr> errors(count);
    Progress progress("searching images for the target", count, quiet);
    cv::parallel_for_(cv::Range(0, count), [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i)
        {
            try
            {
                const cv::Mat grey = readGrey(paths[i]);
                sizes[i] = grey.size();
                points[i] = target.detect(grey);
            }
            catch (...)
            {
                errors[i] = std::current_exception();
            }
            progress.step();
        }
    }, count);

    ViewSet set;
    set.files = paths;
    set.imageSize = imageSize;
    for (int i = 0; i < count; ++i)
    {
        if (errors[i])
            std::rethrow_exception(errors[i]);
        if (set.imageSize.empty())
            set.imageSize = sizes[i];
        if (sizes[i] != set.imageSize)
            throw Failure("'" + paths[i] + "' is " + sizeText(sizes[i]) + " pixels, not "
                          + sizeText(set.imageSize) + ": all images of a camera must have one size");
        addView(set, paths[i], points[i]);
    }
    return set;
}

ViewSet viewsOfVnl(const std::string& path, const Target& target, cv::Size imageSize)
{
    if (imageSize.empty())
        throw Failure("'" + path + "' does not say how large the images are: add --image-size=WIDTHxHEIGHT");
    ViewSet set;
    set.files = {path};
    set.imageSize = imageSize;
    for (const auto& image : readCornersVnl(path, target.count()))
        addView(set, image.first, image.second);
    return set;
}

void requireDistinctStems(const ViewSet& set, const std::string& source)
{
    std::set<std::string> stems;
    for (const View& view : set.views)
        if (!stems.insert(view.stem).second)
            throw Failure("two images of '" + source + "' are called '" + view.stem
                          + "': each moment needs a name of its own, as the names pair views");
}

} // namespace

ViewSet readViews(const std::string& source, const Target& target, cv::Size imageSize, bool quiet)
{
    const bool vnl = std::filesystem::path(source).extension() == ".vnl";
    const ViewSet set = vnl ? viewsOfVnl(source, target, imageSize)
                            : detectViews(expandGlob(source), target, imageSize, quiet);
    if (set.views.empty())
        throw Failure("the target was not found in any image of '" + source + "': check --pattern and --size="
                      + sizeText(target.size()) + " (inner corners or dots), light and focus");
    requireDistinctStems(set, source);
    return set;
}

} // namespace tools
