// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/board_page.hpp"
#include "target/april_grid.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <algorithm>
#include <cmath>
#include <memory>

namespace tools {

using cv::Point2d;
using cv::Rect2d;
using cv::Size2d;

namespace {

// Millimetres. What printers leave free, and what the detectors want of light round a board.
const double MARGIN = 8., FOOTER = 18., TEXT = 3., POINT = 25.4/72;

struct Paper
{
    const char* name;
    double width, height;
};

const Paper PAPERS[] = {{"A5", 148, 210}, {"A4", 210, 297}, {"A3", 297, 420}, {"A2", 420, 594}, {"A1", 594, 841}, {"A0", 841, 1189}};

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;
using Context = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;

bool isSvg(const std::string& path)
{
    return inLowerCase(path.substr(path.find_last_of('.') + 1)) == "svg";
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned length)
{
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

//! A page whose bytes are there once it is finished. (To a file cairo writes without asking whether the disk is full.)
Surface makeSurface(std::string& bytes, bool asSvg, Size2d paper)
{
    const double width = paper.width/POINT, height = paper.height/POINT;
    if (asSvg)
        return Surface(cairo_svg_surface_create_for_stream(append, &bytes, width, height), cairo_surface_destroy);
    Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, width, height), cairo_surface_destroy);
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");      // equal input, equal bytes
    return surface;
}

void addRectangle(cairo_t* cairo, const Rect2d& r)
{
    cairo_rectangle(cairo, r.x, r.y, r.width, r.height);
}

//! The square between corners (0, 0) and (1, 1) is dark: that tells the first corner.
void addChessboard(cairo_t* cairo, cv::Size squares, double square, Point2d corner)
{
    for (int row = 0; row < squares.height; row++)
        for (int column = row % 2; column < squares.width; column += 2)
            addRectangle(cairo, Rect2d(corner.x + column*square, corner.y + row*square, square, square));
}

//! The dark modules of a marker; runs in a row are one rectangle.
void addModules(cairo_t* cairo, const cv::Mat& modules, Point2d corner, double module)
{
    for (int v = 0; v < modules.rows; v++)
        for (int u = 0, end; u < modules.cols; u = end + 1)
        {
            for (end = u; end < modules.cols && modules.at<uchar>(v, end) == 0; )
                end++;
            if (end > u)
                addRectangle(cairo, Rect2d(corner.x + u*module, corner.y + v*module, (end - u)*module, module));
        }
}

//! Tags, and the squares at the corners of each.
void addAprilGrid(cairo_t* cairo, cv::Size tags, double side, double spacing, Point2d corner)
{
    for (int row = 0; row <= tags.height; row++)
        for (int column = 0; column <= tags.width; column++)
        {
            const Point2d at = corner + Point2d(column, row)*(1 + spacing)*side;
            addRectangle(cairo, Rect2d(at.x, at.y, spacing*side, spacing*side));
            if (row == tags.height || column == tags.width)
                continue;
            const cv::Mat modules = aprilTagModules((tags.height - 1 - row)*tags.width + column);
            addModules(cairo, modules, at + Point2d(spacing, spacing)*side, side/modules.cols);
        }
}

//! The picture of modules says which squares are dark, and what the markers in the others are.
void addCharuco(cairo_t* cairo, const cv::Mat& modules, int perSquare, double square, double marker, Point2d corner)
{
    const double module = marker/(perSquare - 2), border = 0.5*(square - marker);
    for (int row = 0; row < modules.rows; row += perSquare)
        for (int column = 0; column < modules.cols; column += perSquare)
        {
            const Point2d at(corner.x + column/perSquare*square, corner.y + row/perSquare*square);
            if (modules.at<uchar>(row, column) == 0)
            {
                addRectangle(cairo, Rect2d(at.x, at.y, square, square));
                continue;
            }
            addModules(cairo, modules(cv::Rect(column + 1, row + 1, perSquare - 2, perSquare - 2)), at + Point2d(border, border), module);
        }
}

void drawRuler(cairo_t* cairo, Point2d left)
{
    cairo_set_line_width(cairo, 0.15);
    for (int mm = 0; mm <= (int)BoardPage::RULER; mm++)
    {
        cairo_move_to(cairo, left.x + mm, left.y);
        cairo_rel_line_to(cairo, 0, mm % 10 == 0 ? -5 : mm % 5 == 0 ? -3.5 : -2);
    }
    cairo_move_to(cairo, left.x - 0.075, left.y);
    cairo_rel_line_to(cairo, BoardPage::RULER + 0.15, 0);
    cairo_stroke(cairo);
}

//! The font is cairo's own: no file is needed, and each machine writes the same.
void drawText(cairo_t* cairo, const std::string& text, Point2d at, double width)
{
    cairo_select_font_face(cairo, "@cairo:", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, TEXT);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text.c_str(), &extents);
    cairo_set_font_size(cairo, TEXT*std::min(1., width/extents.x_advance));
    cairo_move_to(cairo, at.x, at.y);
    cairo_show_text(cairo, text.c_str());
}

} // namespace

BoardPage::BoardPage(const Target& target, double millimetres, const std::string& paper)
    : target_(target), millimetres_(millimetres)
{
    Point2d last;
    for (const cv::Point3d& p : target.objectPoints())
        last = Point2d(std::max(last.x, p.x*millimetres), std::max(last.y, p.y*millimetres));
    choosePaper(paper, Size2d(last.x + 2*border(), last.y + 2*border()));
    board_.x = 0.5*(paper_.width - board_.width);
    board_.y = MARGIN + 0.5*(paper_.height - 2*MARGIN - FOOTER - board_.height);
}

double BoardPage::border() const
{
    return target_.isDotGrid() ? target_.dotRadius()*millimetres_ : target_.border()*square();
}

Size2d BoardPage::neededPaper() const
{
    return Size2d(std::max(board_.width, RULER + 2) + 2*MARGIN, board_.height + FOOTER + 2*MARGIN);
}

//! As it is, or turned by a quarter, which the text below it is not.
bool BoardPage::place(Size2d board, Size2d paper)
{
    for (const bool turned : {false, true})
    {
        isTurned_ = turned;
        board_ = turned ? Rect2d(0, 0, board.height, board.width) : Rect2d(0, 0, board.width, board.height);
        const Size2d needed = neededPaper();
        if (needed.width <= paper.width && needed.height <= paper.height)
        {
            paper_ = paper;
            return true;
        }
    }
    return false;
}

void BoardPage::choosePaper(const std::string& paper, Size2d board)
{
    for (const Paper& p : PAPERS)
    {
        if (paper.empty() ? p.height < 297 : paper != p.name)
            continue;
        // As the board lies, so that the paper's edges are where its own are.
        const Size2d upright(p.width, p.height), across(p.height, p.width);
        const bool isWide = board.width > board.height;
        paperName_ = p.name;
        if (place(board, isWide ? across : upright) || place(board, isWide ? upright : across))
            return;
    }
    isTurned_ = false;
    board_ = Rect2d(0, 0, board.width, board.height);
    const Size2d needed = neededPaper();
    paper_ = Size2d(std::ceil(needed.width), std::ceil(needed.height));
    if (!paper.empty())
    {
        const bool isNamed = std::any_of(std::begin(PAPERS), std::end(PAPERS), [&](const Paper& p) { return paper == p.name; });
        if (isNamed || !place(board, Size2d(parseSize(paper, "--paper"))))
            throw Failure("--paper=" + paper + cv::format(": the board with its ruler needs %.0fx%.0f mm; take larger paper, or fewer or "
                                                          "smaller squares", paper_.width, paper_.height));
    }
    paperName_ = cv::format("%.0fx%.0f mm", paper_.width, paper_.height);
}

Point2d BoardPage::onPage(const Point2d& onBoard) const
{
    return isTurned_ ? Point2d(board_.br().x - onBoard.y, board_.y + onBoard.x) : board_.tl() + onBoard;
}

std::vector<Point2d> BoardPage::points() const
{
    std::vector<Point2d> points;
    for (const cv::Point3d& p : target_.objectPoints())
        points.push_back(onPage(Point2d(border() + p.x*millimetres_, border() + p.y*millimetres_)));
    return points;
}

void BoardPage::drawBoard(cairo_t* cairo) const
{
    const cv::Size squares(target_.size().width + 1, target_.size().height + 1);
    const Point2d origin = onPage(Point2d()), x = onPage(Point2d(1, 0)) - origin, y = onPage(Point2d(0, 1)) - origin;
    const cairo_matrix_t fromBoard = {x.x, x.y, y.x, y.y, origin.x, origin.y};
    cairo_save(cairo);
    cairo_transform(cairo, &fromBoard);
    const cv::Mat modules = target_.modules();
    switch (target_.pattern())
    {
    case Target::CHESSBOARD:
        addChessboard(cairo, squares, square(), Point2d());
        break;
    case Target::CHARUCO:
        addCharuco(cairo, modules, modules.cols/squares.width, square(), target_.marker()*millimetres_, Point2d());
        break;
    case Target::APRILGRID:
        addAprilGrid(cairo, target_.size()/2, square(), target_.tagSpacing(), Point2d());
        break;
    case Target::CIRCLES:
    case Target::ACIRCLES:
        for (const cv::Point3d& p : target_.objectPoints())
        {
            cairo_new_sub_path(cairo);
            cairo_arc(cairo, border() + p.x*millimetres_, border() + p.y*millimetres_, border(), 0, 2*CV_PI);
        }
        break;
    case Target::DOTS:              // not on a board
        break;
    }
    cairo_fill(cairo);
    cairo_restore(cairo);
}

void BoardPage::write(const std::string& path, const std::vector<std::string>& lines) const
{
    requireWritable(path);
    std::string bytes;
    const Surface surface = makeSurface(bytes, isSvg(path), paper_);
    const Context context(cairo_create(surface.get()), cairo_destroy);
    cairo_t* cairo = context.get();
    cairo_scale(cairo, 1/POINT, 1/POINT);       // from here on in millimetres
    drawBoard(cairo);
    const double bottom = paper_.height - MARGIN;
    drawRuler(cairo, Point2d(MARGIN + 1, bottom - 8));
    for (size_t i = 0; i < lines.size(); i++)
        drawText(cairo, lines[i], Point2d(MARGIN + 1, bottom - 4 + 4*(double)i), paper_.width - 2*MARGIN - 2);
    cairo_show_page(cairo);
    cairo_surface_finish(surface.get());
    for (const cairo_status_t status : {cairo_surface_status(surface.get()), cairo_status(cairo)})
        if (status != CAIRO_STATUS_SUCCESS)
            throw Failure("'" + path + "' cannot be written: " + cairo_status_to_string(status));
    writeText(path, bytes);
}

} // namespace tools
