// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PLOT_HPP
#define REFRACT_TOOLS_PLOT_HPP

#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace tools {

/* A picture drawn by gnuplot, as SVG text to put into a page.

    Plot plot(600, 400);
    plot.data("views", {{0, 0.1}, {1, 0.2}});
    plot << "plot $views using 1:2 with lines\n";
    std::string svg = plot.svg();
*/
class Plot
{
public:
    Plot(int width, int height);

    //! For a picture over an image: of a width that leaves room for a colour scale, and a height that fits.
    explicit Plot(cv::Size image);

    //! Rows of numbers that commands call $name; NaN is a gap.
    void data(const std::string& name, const std::vector<std::vector<double>>& rows);

    //! gnuplot commands.
    template <typename T> Plot& operator<<(const T& text)
    {
        script_ << text;
        return *this;
    }

    //! Paths on the paper, x and y, with a gap after each.
    void paths(const std::string& name, const std::vector<std::vector<cv::Point2d>>& paths);

    //! Runs gnuplot; throws Failure with its message if it fails.
    std::string svg() const;

    //! Throws Failure that says what to install if there is no gnuplot. @param option that asks for pictures
    static void checkAvailable(const std::string& option = "--report");

    /** What "plot" shows of points with their deviation to either side: gnuplot's own error bars have a white disc over their middle.
    @param x, y, deviation columns or expressions of the data, as 1 or ($1+5) */
    static std::string withBars(const std::string& name, const std::string& x, int y, int deviation, const std::string& colour);

    //! A text as a gnuplot string constant.
    static std::string quoted(const std::string& text);
    //! What an axis shows; the unit may be unknown.
    static std::string quoted(const std::string& quantity, const std::string& unit);

private:
    std::ostringstream script_;
};

} // namespace tools

#endif // REFRACT_TOOLS_PLOT_HPP
