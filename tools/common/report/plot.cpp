// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/plot.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <unistd.h>

namespace tools {

namespace {

//! A folder of its own for what goes to and comes from gnuplot.
class TemporaryFolder
{
public:
    TemporaryFolder()
    {
        std::string name = (temporaryFolder() / "refract-plot-XXXXXX").string();
        if (!mkdtemp(&name[0]))
            throw Failure("cannot make a temporary folder in " + temporaryFolder().string() + ": make room there or set TMPDIR");
        path_ = name;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::string file(const char* name) const { return (path_/name).string(); }
private:
    std::filesystem::path path_;
};

std::string readAll(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

} // namespace

Plot::Plot(int width, int height)
{
    script_.precision(9);
    script_ << "set terminal svg size " << width << ',' << height << " dynamic noenhanced font 'sans-serif,12' linewidth 1\n"
            << "set encoding utf8\n"
            << "set border linecolor rgb '#94a3b8'\n"
            << "set tics nomirror textcolor rgb '#334155'\n"
            << "set grid linecolor rgb '#e2e8f0' linewidth 1 linetype 1\n"
            << "set key textcolor rgb '#334155'\n"
            << "set palette defined (0 '#1e3a8a', 0.25 '#0284c7', 0.5 '#10b981', 0.75 '#facc15', 1 '#dc2626')\n";
}

void Plot::data(const std::string& name, const std::vector<std::vector<double>>& rows)
{
    script_ << '$' << name << " << EOD\n";
    for (const std::vector<double>& row : rows)
    {
        for (double value : row)
            if (std::isfinite(value))
                script_ << value << ' ';
            else
                script_ << "NaN ";
        script_ << '\n';
    }
    script_ << "EOD\n";
}

void Plot::paths(const std::string& name, const std::vector<std::vector<cv::Point2d>>& paths)
{
    const double gap = std::numeric_limits<double>::quiet_NaN();        // gnuplot lifts the pen
    std::vector<std::vector<double>> rows;
    for (const std::vector<cv::Point2d>& path : paths)
    {
        for (const cv::Point2d& p : path)
            rows.push_back({p.x, p.y});
        rows.push_back({gap, gap});
    }
    data(name, rows);
}

//! Of a line camera the picture is low, but not its labels.
static int heightOf(cv::Size image) { return std::max(200, 70 + 460*image.height/image.width); }

Plot::Plot(cv::Size image) : Plot(600, heightOf(image))
{
    script_ << "set lmargin at screen " << 60./600 << "\nset rmargin at screen " << 480./600 << "\nset xrange [-0.5:"
            << image.width - 0.5 << "]\nset yrange [" << image.height - 0.5 << ":-0.5]\n"
            << "set size ratio -1\nset xlabel 'u, px'\nset ylabel 'v, px' offset 1,0\n";
}

std::string Plot::svg() const
{
    const TemporaryFolder folder;
    // A script file, not a pipe: had gnuplot to give up early, the pipe's signal would end the tool.
    const std::string script = folder.file("script"), picture = folder.file("picture.svg"), messages = folder.file("messages");
    std::ofstream(script, std::ios::binary) << "set output " << quoted(picture) << '\n' << script_.str() << "\nunset output\n";
    if (std::system(("gnuplot \"" + script + "\" 2>\"" + messages + '"').c_str()) != 0)
        throw Failure("gnuplot could not draw a picture of the report: " + readAll(messages));
    const std::string text = readAll(picture);
    const size_t start = text.find("<svg");     // without the XML head, to stand inside a page
    if (start == std::string::npos)
        throw Failure("gnuplot wrote no SVG: its terminal 'svg' is missing; install gnuplot-nox");
    return text.substr(start);
}

void Plot::checkAvailable(const std::string& option)
{
    // That it is there is not enough: what it lacks would be found at the end of a calibration.
    if (std::system("gnuplot -e 'set terminal svg' >/dev/null 2>&1") != 0)
        throw Failure(option + " needs gnuplot with its terminal 'svg' to draw its pictures: install gnuplot-nox");
}

std::string Plot::withBars(const std::string& name, const std::string& x, int y, int deviation, const std::string& colour)
{
    const std::string style = " linecolor rgb '" + colour + "' notitle", shown = "$" + name + " using " + x + ":";
    return shown + cv::format("($%d-$%d):(0):(2*$%d) with vectors nohead linewidth 1.5", y, deviation, deviation) + style + ", " + shown
        + std::to_string(y) + " with points pointtype 7 pointsize 0.35" + style;
}

std::string Plot::quoted(const std::string& quantity, const std::string& unit)
{
    return quoted(unit.empty() ? quantity : quantity + ", " + unit);
}

std::string Plot::quoted(const std::string& text)
{
    std::string result = "'";
    for (char c : text)
        result += c == '\'' ? std::string("''") : std::string(1, c == '\n' ? ' ' : c);
    return result + "'";
}

} // namespace tools
