// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BOARD_PAGE_HPP
#define REFRACT_TOOLS_BOARD_PAGE_HPP

#include "target/target.hpp"

struct _cairo;      // cairo_t

/* A target on paper, in true size. Below it what it is, as the other tools want to hear it, and a ruler to check the print with. */
namespace tools {

struct BoardPage
{
    static constexpr double RULER = 100.;           //!< mm

    /** @param millimetres a unit of the target's lengths has
    @param paper A0 ... A5, either way round; WxH in mm; empty: the smallest of A4 to A0 that the target fits on, or one made to
    measure. Throws Failure if the target does not fit */
    BoardPage(const Target& target, double millimetres, const std::string& paper);

    cv::Size2d paper() const { return paper_; }     //!< mm
    cv::Rect2d board() const { return board_; }     //!< dark and light squares, or dots; mm from the paper's top left corner
    std::string paperName() const { return paperName_; }    //!< "A4", "210x300 mm"

    //! Of the target's points, in the order of objectPoints(), mm from the paper's top left corner.
    std::vector<cv::Point2d> points() const;

    /** Writes .pdf or .svg, by the path's extension.
    @param lines what stands under the board */
    void write(const std::string& path, const std::vector<std::string>& lines) const;

private:
    double square() const { return target_.square()*millimetres_; }
    double border() const;      //!< from the outermost points to the board's edge
    void drawBoard(_cairo* cairo) const;
    void choosePaper(const std::string& paper, cv::Size2d board);
    bool place(cv::Size2d board, cv::Size2d paper);     //!< false: it does not fit
    cv::Size2d neededPaper() const;
    cv::Point2d onPage(const cv::Point2d& onBoard) const;

    const Target& target_;
    double millimetres_;
    cv::Size2d paper_;
    cv::Rect2d board_;
    bool isTurned_ = false;     //!< by a quarter, to fit on smaller paper
    std::string paperName_;
};

} // namespace tools

#endif // REFRACT_TOOLS_BOARD_PAGE_HPP
