#ifndef REFRACT_TOOLS_RIG_DATA_HPP
#define REFRACT_TOOLS_RIG_DATA_HPP

#include "target/detected_views.hpp"

/* Which images belong together: what one or two cameras saw of a board at each of its poses. */
namespace tools {

//! Where the images of one or two cameras are, without and through the window; empty: there are none.
struct RigSources
{
    std::string direct[2], glass[2];
};

//! What was found in them; no views: there are none.
struct RigViewSets
{
    ViewSet direct[2], glass[2];

    std::vector<const ViewSet*> all() const { return {&direct[0], &glass[0], &direct[1], &glass[1]}; }
};

//! readViews of each source; imageSize[c]: of each camera.
RigViewSets readViewSets(const RigSources& sources, const Target& target, const cv::Size imageSize[2], bool quiet);

//! One pose of the board, and what each camera saw of it. An empty array: no image, or the board was not found.
struct Moment
{
    std::string stem;
    std::vector<cv::Point2d> direct[2], glass[2];

    bool hasDirect(int camera) const { return !direct[camera].empty(); }
    bool hasGlass(int camera) const { return !glass[camera].empty(); }
    bool hasGlass() const { return hasGlass(0) || hasGlass(1); }
    bool isPair(int camera) const { return hasDirect(camera) && hasGlass(camera); }
};

struct RigData
{
    int cameraCount = 1;
    std::vector<cv::Point3d> objectPoints;      //!< of the target, the same at every moment
    std::vector<std::pair<int, int>> neighbours;        //!< points next to each other, as Target::neighbours()
    std::vector<Moment> moments;
    cv::Size imageSize[2];

    int countPairs(int camera) const;
};

//! 0, 1, 2, ...
std::vector<int> allMoments(const RigData& data);

/** Sorts views into moments. Equal stems are one moment; with `unpaired` a direct and a glass image never are, while
the two cameras of a rig still are. Points are renumbered where the target's symmetry makes two images of a moment
disagree. There are two cameras if the second has views through the window. */
RigData pairViews(const Target& target, const RigViewSets& sets, bool unpaired);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_DATA_HPP
