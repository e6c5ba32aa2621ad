// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TARGET_HPP
#define REFRACT_TOOLS_TARGET_HPP

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tools {

class OptionParser;

//! --pattern, --size, --square (and --marker, --dictionary for ChArUco, --tag-spacing for AprilGrid) as given on the command line.
struct TargetOptions
{
    std::string pattern = "chessboard";
    std::string size;
    double square = 0.;
    double marker = 0.;                         //!< ChArUco: side of a marker; 0 = 3/4 of a square
    std::string dictionary = "DICT_4X4_250";    //!< ChArUco
    double tagSpacing = 0.;                     //!< AprilGrid: between tags, in sides of a tag; 0 = 0.3
    bool legacy = false;                        //!< ChArUco: of the layout before OpenCV 4.6
    bool partial = false;                       //!< chessboard: any piece of it will do, see detectPartialChessboard()
    std::string dots;                           //!< --target: the file that says where the dots are; empty: a flat board

    bool given() const { return !size.empty() || !dots.empty(); }
    void addTo(OptionParser& parser, bool required);
    void addDotsTo(OptionParser& parser);       //!< --target, after addTo()
};

/* A calibration target: its points, and how to find them in an image. Those of a flat one are row by row in the plane z = 0; dots whose
places a file says are anywhere.

The order of the points is the same in every image as far as the target allows. A chessboard with one even and one odd
side, an asymmetric circle grid with an odd number of rows, ChArUco and AprilGrid have no ambiguity: the first point is told by
the pattern (chessboard: the first square between corners is dark). On the others the first point is the one
nearest to the image's top left among those the symmetry allows; alignWith() makes two views agree. */
class Target
{
public:
    enum Pattern { CHESSBOARD, CIRCLES, ACIRCLES, CHARUCO, APRILGRID, DOTS };

    explicit Target(const TargetOptions& options);

    Pattern pattern() const { return pattern_; }
    bool isDotGrid() const { return pattern() == CIRCLES || pattern() == ACIRCLES; }
    //! Of a dot grid that refract_board draws and refract_simulate renders.
    double dotRadius() const { return 0.3*(pattern() == ACIRCLES ? 2 : 1)*square_; }
    cv::Size size() const { return size_; }                 //!< inner corners, dots, or corners of tags
    std::string sizeText() const;                           //!< as --size has it; AprilGrid: tags
    std::string patternName() const;                        //!< as --pattern has it
    double square() const { return square_; }               //!< DOTS: 0, as there are none
    const std::vector<std::string>& ids() const { return ids_; }    //!< DOTS: what the file calls each; else empty
    bool partial() const { return partial_; }               //!< any piece of it will do
    int count() const { return size_.area(); }
    const std::vector<cv::Point3d>& objectPoints() const { return objectPoints_; }

    //! ChArUco, AprilGrid: the board seen from the front, its outer squares' corner at pixel (-0.5, -0.5); else empty.
    cv::Mat drawing(int pixelsPerSquare) const;

    //! From the outermost points to the edge of what is drawn, in squares: AprilGrid's are narrower.
    double border() const { return pattern_ == APRILGRID ? tagSpacing_ : 1.; }
    double tagSpacing() const { return tagSpacing_; }       //!< AprilGrid: between tags, in sides of a tag

    double marker() const { return marker_; }               //!< ChArUco: side of a marker

    //! ChArUco: the board in whole modules, that of a marker's border being one, whatever the true size of markers; else empty.
    cv::Mat modules() const;

    //! Pairs of points next to each other in a row or column, of DOTS none; objectPoints() tells how far apart they are.
    std::vector<std::pair<int, int>> neighbours() const;

    /** Pixels of the points in an 8-bit grey image, NaN where one was not seen; empty if the target was not found, which is
    known after some seconds in any image.
    @param other a chessboard's size, if it was not found but one of another size is in the image (the longer side first) */
    std::vector<cv::Point2d> detect(const cv::Mat& grey, cv::Size* other = nullptr) const;

    //! Whether it is worth while to look for the target: a fast detector finds it, of a chessboard in a small copy of the image.
    bool isLikelySeen(const cv::Mat& grey) const;

    /** The same points, renumbered by the target's symmetry so that the target is turned as in `reference`, another
    view of it by the same or a similarly turned camera. */
    std::vector<cv::Point2d> alignWith(const std::vector<cv::Point2d>& reference,
                                       const std::vector<cv::Point2d>& points) const;

private:
    std::vector<cv::Point2d> canonical(const std::vector<cv::Point2d>& points, const cv::Mat& grey) const;
    //! Renumberings that give the same pattern, the unchanged one first.
    std::vector<std::vector<int>> symmetries() const;

    Pattern pattern_;
    cv::Size size_;
    double square_, marker_, tagSpacing_;
    int dictionary_;
    bool partial_, legacy_;
    std::vector<cv::Point3d> objectPoints_;
    std::vector<std::string> ids_;
};

//! True where the point was seen.
inline bool seen(const cv::Point2d& p) { return p.x == p.x && p.y == p.y; }

//! Out of an image by more than a pixel, as no corner found at its border is. @param size may be empty: not known
inline bool isFarOutside(const cv::Point2d& p, cv::Size size)
{
    const double BEYOND = 1.;
    return !size.empty() && (std::min(p.x, p.y) < -0.5 - BEYOND || p.x > size.width - 0.5 + BEYOND || p.y > size.height - 0.5 + BEYOND);
}

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_HPP
