#include "file_output.hpp"
#include "measurement.hpp"
#include "table.hpp"
#include "views.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <sstream>

static const char MANUAL[] = R"(Measures the points of a target, in the frame of camera 1, from images through the window.

  refract_measure calib.yml IMAGE1 IMAGE2 --size=6x5 --square=39 --out=points.csv     two cameras: triangulation
  refract_measure calib.yml IMAGE --plane=0,0,1,600 --size=... --square=...           one camera: points on a plane
  refract_measure calib.yml IMAGE --size=... --square=...                             one camera: pose of the target

IMAGE may be a quoted glob ('measure1/*.png') or a corners.vnl; images of two cameras belong together when their file
stems are equal. points.csv: id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status, one row a point of the target (id counts on from view
to view); s* is one standard deviation, from the pixel noise that the calibration found and from the calibration's own
covariance, which calib.yml holds; nan where there is no answer, and status says why (0: fine; RefractiveStatus).
The table compares the distances between neighbouring points with --square.)";

namespace {

using namespace tools;

struct Options
{
    std::string calibration, image1, image2, plane, out;
    std::vector<std::string> compareWith;
    TargetOptions target;
    double pixelSigma = 0.;
    bool compare = false;
};

//! One view by one or two cameras.
struct Sight
{
    std::string stem;
    std::vector<cv::Point2d> pixels1, pixels2;
};

ViewSet readViewsOf(const std::string& source, const Target& target, const CameraCalibration& camera, bool quiet)
{
    return readViews(source, target, camera.camera->imageSize(), quiet);
}

std::vector<Sight> readSights(const Options& options, const Calibration& calibration, const Target& target, bool quiet)
{
    const ViewSet first = readViewsOf(options.image1, target, calibration.cameras[0], quiet);
    std::vector<Sight> sights;
    if (options.image2.empty())
    {
        for (const View& view : first.views)
            sights.push_back({view.stem, view.points, {}});
        return sights;
    }
    const ViewSet second = readViewsOf(options.image2, target, calibration.cameras[1], quiet);
    const bool single = first.views.size() == 1 && second.views.size() == 1;    // a pair whatever the names
    for (const View& view : first.views)
    {
        const View* other = single ? &second.views[0] : second.find(view.stem);
        if (other)
            sights.push_back({view.stem, view.points, target.alignWith(view.points, other->points)});
    }
    if (sights.empty())
        throw Failure("no image of '" + options.image1 + "' has the name of one of '" + options.image2
                      + "': images of one moment need equal names");
    return sights;
}

Measurement measure(const Options& options, const Calibration& calibration, const Target& target, const Sight& sight)
{
    const double sigma = options.pixelSigma > 0 ? options.pixelSigma : pixelSigmaOf(calibration);
    if (!sight.pixels2.empty())
        return measureStereo(calibration, sight.pixels1, sight.pixels2, sigma);
    if (options.plane.empty())
        return measureTarget(calibration, target, sight.pixels1, sigma);
    return measureOnPlane(calibration, sight.pixels1, parsePlane(options.plane), sigma);
}

std::vector<Measurement> measureAll(const Options& options, const Calibration& calibration, const Target& target,
                                    const std::vector<Sight>& sights)
{
    std::vector<Measurement> results;
    for (const Sight& sight : sights)
        results.push_back(measure(options, calibration, target, sight));
    return results;
}

std::string csvOf(const std::vector<Measurement>& measurements)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::ostringstream csv;
    csv.precision(12);
    csv << "id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status\n";
    int id = 0;
    for (const Measurement& m : measurements)
        for (size_t i = 0; i < m.points.size(); ++i)
        {
            const cv::Point2d second = m.pixels2.empty() ? cv::Point2d(nan, nan) : m.pixels2[i];
            csv << id++;
            for (const double number : {m.pixels1[i].x, m.pixels1[i].y, second.x, second.y, m.points[i].x, m.points[i].y,
                                        m.points[i].z, m.sigma[i][0], m.sigma[i][1], m.sigma[i][2]})
                std::isnan(number) ? csv << ",nan" : csv << ',' << number;
            csv << ',' << (int)m.status[i] << '\n';
        }
    return csv.str();
}

std::vector<std::string> rowOf(const std::string& name, const Target& target, const std::vector<Measurement>& results,
                               bool lengthsMeasured)
{
    double squares = 0, sum = 0, largest = 0, near = std::numeric_limits<double>::infinity(), far = -near, depthSigma = 0;
    int lengths = 0, answers = 0, points = 0;
    for (const Measurement& m : results)
    {
        for (const double error : lengthErrors(target, m.points))
        {
            squares += error * error;
            sum += error;
            largest = std::max(largest, std::abs(error));
            ++lengths;
        }
        for (size_t i = 0; i < m.points.size(); ++i)
            if (m.status[i] == cv::refract::REFRACT_OK)
            {
                near = std::min(near, m.points[i].z);
                far = std::max(far, m.points[i].z);
                depthSigma += m.sigma[i][2];
            }
        answers += m.answers();
        points += (int)m.points.size();
    }
    std::vector<std::string> row = {name, format("%d of %d", answers, points), format("%.1f ... %.1f", near, far),
                                    std::isnan(depthSigma) ? "unknown" : format("%.4f", depthSigma / answers)};
    if (lengthsMeasured)
        row.insert(row.end(), {format("%.4f", std::sqrt(squares / lengths)), format("%+.4f", sum / lengths),
                               format("%.4f", largest)});
    return row;
}

void printTable(const Options& options, const Calibration& calibration, const Target& target,
                const std::vector<Sight>& sights, const std::vector<Measurement>& results)
{
    // From the pose of a target of known shape, the distances come out as they went in.
    const bool lengthsMeasured = !options.image2.empty() || !options.plane.empty();
    Table table(lengthsMeasured ? std::vector<std::string>{"", "points", "depth z", "mean sz", "length RMS error",
                                                           "mean error", "largest"}
                                : std::vector<std::string>{"", "points", "depth z", "mean sz"});
    if (options.compare)
        table.add(rowOf("glass ignored", target, measureAll(options, withoutWindows(calibration), target, sights),
                        lengthsMeasured));
    for (const std::string& file : options.compareWith)
    {
        const Calibration other = readCalibration(file);
        if (other.cameras.size() != calibration.cameras.size())
            throw Failure("'" + file + "' has another number of cameras than '" + options.calibration + "'");
        table.add(rowOf(std::filesystem::path(file).stem().string(), target, measureAll(options, other, target, sights), lengthsMeasured));
    }
    const bool alone = !options.compare && options.compareWith.empty();
    table.add(rowOf(alone ? "measured" : "with the window", target, results, lengthsMeasured));
    std::cout << sights.size() << (sights.size() == 1 ? " view" : " views")
              << (lengthsMeasured ? "; distances between neighbouring points, measured minus true:\n\n"
                                  : "; points from the pose of the target:\n\n");
    table.print(std::cout);
}

void addOptions(CLI::App& app, Options& options)
{
    app.add_option("calib.yml", options.calibration, "what refract_calib wrote")->required();
    app.add_option("IMAGE", options.image1, "of camera 1")->required();
    app.add_option("IMAGE2", options.image2, "of camera 2");
    options.target.addTo(app, true);
    app.add_option("--plane", options.plane, "a,b,c,d: the target lies on a x + b y + c z = d in the camera's frame");
    app.add_option("--out", options.out, "points.csv to write");
    app.add_option("--pixel-sigma", options.pixelSigma, "standard deviation of a pixel coordinate (default: that "
                   "of the calibration's residuals)")->check(CLI::PositiveNumber);
    app.add_flag("--compare", options.compare, "show also what comes out if the glass is ignored");
    app.add_option("--compare-with", options.compareWith, "show also what another calibration gives");
}

void checkCombination(const Options& options, const Calibration& calibration)
{
    if (!options.image2.empty() && !calibration.stereo())
        throw Failure("'" + options.calibration + "' has one camera, but there are images of two: calibrate the pair "
                      "(refract_calib --direct2 --glass2), or give one image");
    if (!options.plane.empty() && !options.image2.empty())
        throw Failure("--plane is for one camera: leave it out, or give one image");
    if (!options.plane.empty())
        parsePlane(options.plane);
}

} // namespace

int main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        Options options;
        addOptions(command.app, options);
        command.parse();

        const Target target(options.target);
        const Calibration calibration = readCalibration(options.calibration);
        checkCombination(options, calibration);
        const std::vector<Sight> sights = readSights(options, calibration, target, command.quiet());
        const std::vector<Measurement> results = measureAll(options, calibration, target, sights);
        int answers = 0;
        for (const Measurement& m : results)
            answers += m.answers();
        if (!answers)
            throw Failure("no point of the target could be measured: are images and calibration of the same cameras?");
        if (!options.out.empty())
            writeText(options.out, csvOf(results));
        if (!command.quiet())
            printTable(options, calibration, target, sights, results);
        return DONE;
    });
}
