#include "assess/consistency.hpp"
#include "assess/measurement.hpp"
#include "assess/target_lengths.hpp"
#include "calibrate/units.hpp"
#include "console/file_output.hpp"
#include "console/outputs.hpp"
#include "console/table.hpp"
#include "target/detected_views.hpp"

#include <cmath>
#include <iostream>
#include <limits>
#include <set>
#include <sstream>

static const char MANUAL[] = R"(Measures the points of a target, in the frame of camera 1, from images through the window.

  refract_measure calib.yml IMAGE1 IMAGE2 --size=6x5 --square=39 --out=points.csv     two cameras: triangulation
  refract_measure calib.yml IMAGE --plane=0,0,1,600 --size=... --square=...           one camera: points on a plane
  refract_measure calib.yml IMAGE --size=... --square=...                             one camera: pose of the target

IMAGE may be a quoted glob ('measure1/*.png') or a corners.vnl; images of two cameras belong together when their file
stems are equal. Images without target or without partner are skipped, and named on stderr.

points.csv: image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status, one row a point of the target; image is the file's stem (of camera 1), id
counts within the target; s* is one standard deviation, from the pixel noise that the calibration found and from the
calibration's own covariance, which calib.yml holds; nan where there is no answer. status: 0 fine; 1 to 8 why there is no
answer (RefractiveStatus); 9 the pixels contradict each other by more than 5 standard deviations of noise and calibration: the
point has the s* of that misfit, and far beyond it is nan; of a pose that its points contradict, all s* are nan. Look for
swapped images, images of two moments, a moved camera.

The table compares the distances between neighbouring points with --square, which must be in the unit of the calibration.

Exit code: 0 done, 1 could not do it, 2 done and written, but not to be trusted: more than half of the points have status 9,
or the distances between neighbouring points are on average more than 20 % off.)";

namespace {

using namespace tools;

struct Options
{
    std::string calibration, image1, image2, plane, out;
    std::vector<std::string> compareWith;
    TargetOptions target;
    double pixelSigma = 0.;
    bool compare = false, noWindow = false;
    std::string unit;

    //! From the pose of a target of known shape, the distances come out as they went in.
    bool lengthsMeasured() const { return !image2.empty() || !plane.empty(); }
};

//! One view by one or two cameras.
struct Sight
{
    std::string stem;
    std::vector<cv::Point2d> pixels1, pixels2;
};

void sayMissing(const ViewSet& set, const std::string& which, const Command& command)
{
    if (!set.withoutTarget.empty())
        command.warn("skipped" + which + ", as the target was not found: " + listed(set.withoutTarget));
}

void sayAlone(const std::vector<std::string>& stems, int camera, int other, const Command& command)
{
    if (!stems.empty())
        command.warn(format("skipped of camera %d, as camera %d has no image of that name with the target: ", camera, other)
                     + listed(stems));
}

std::vector<Sight> readSights(const Options& options, const Calibration& calibration, const Target& target,
                              const Command& command)
{
    const auto readOf = [&](const std::string& source, int c) {
        return readViews(source, target, calibration.cameras[c].camera->imageSize(), command.quiet());
    };
    const ViewSet first = readOf(options.image1, 0);
    std::vector<Sight> sights;
    if (options.image2.empty())
    {
        sayMissing(first, "", command);
        for (const DetectedView& view : first.views)
            sights.push_back({view.stem, view.points, {}});
        return sights;
    }
    const ViewSet second = readOf(options.image2, 1);
    const bool single = first.files.size() == 1 && second.files.size() == 1 && first.views.size() == 1
                        && second.views.size() == 1;        // a pair whatever the names
    std::vector<std::string> alone1, alone2;
    std::set<std::string> paired;
    for (const DetectedView& view : first.views)
    {
        const DetectedView* other = single ? &second.views[0] : second.find(view.stem);
        if (!other)
        {
            alone1.push_back(view.stem);
            continue;
        }
        paired.insert(other->stem);
        sights.push_back({view.stem, view.points, target.alignWith(view.points, other->points)});
    }
    for (const DetectedView& view : second.views)
        if (!paired.count(view.stem))
            alone2.push_back(view.stem);
    if (sights.empty())
        throw Failure("no image of '" + options.image1 + "' has the name of one of '" + options.image2
                      + "': images of one moment need equal names");
    sayMissing(first, " of camera 1", command);
    sayMissing(second, " of camera 2", command);
    sayAlone(alone1, 1, 2, command);
    sayAlone(alone2, 2, 1, command);
    return sights;
}

double pixelSigma(const Options& options, const Calibration& calibration)
{
    return options.pixelSigma > 0 ? options.pixelSigma : pixelSigmaOf(calibration);
}

Measurement measure(const Options& options, const Calibration& calibration, const Target& target, const Sight& sight)
{
    const double sigma = pixelSigma(options, calibration);
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

void judge(const Options& options, const Calibration& calibration, std::vector<Measurement>& results)
{
    for (Measurement& m : results)
        if (!m.pixels2.empty())
            judgePartners(calibration, pixelSigma(options, calibration), m);
        else if (options.plane.empty())
            judgePose(pixelSigma(options, calibration), m);
}

//! What contradicts itself, or empty.
std::string contradictionIn(const std::vector<Sight>& sights, const std::vector<Measurement>& results)
{
    std::vector<std::string> names;
    int points = 0, all = 0, nowhere = 0;
    double worst = 0;
    for (size_t i = 0; i < results.size(); i++)
    {
        const Measurement& m = results[i];
        all += (int)m.points.size();
        if (!m.inconsistent())
            continue;
        names.push_back(sights[i].stem);
        points += m.inconsistent();
        for (size_t k = 0; k < m.points.size(); k++)
            nowhere += m.status[k] == INCONSISTENT && m.points[k].x != m.points[k].x;
        worst = std::max(worst, m.worstMisfit);
    }
    if (names.empty())
        return "";
    const bool pairs = !results[0].pixels2.empty();
    const std::string left = pairs ? "the two pixels of a point miss each other by up to %.3g px"
                                   : "the pose leaves residuals of up to %.3g px per coordinate";
    return format("%d of %d points contradict themselves by far more than the noise: ", points, all)
        + format(left.c_str(), pairs ? std::sqrt(2.)*worst : worst) + " (" + listed(names) + "; status 9"
        + (nowhere == points ? ", no answer" : nowhere ? format(", %d of them without answer", nowhere)
           : pairs ? ", large sx, sy, sz" : ", no sx, sy, sz")
        + "). "
        + (pairs ? "Check that left and right are not swapped, that the images of a pair are of one moment, and that no camera "
                   "and no window has moved since the calibration"
                 : "Check --size, --square, that the target is flat, and that camera and window are those of the calibration");
}

bool mostContradict(const std::vector<Measurement>& results)
{
    int all = 0, wrong = 0;
    for (const Measurement& m : results)
    {
        all += m.seenPoints();
        wrong += m.inconsistent();
    }
    return 2*wrong > all;
}

//! What lengths say that are far from the target's, or empty.
std::string wrongLengths(const Target& target, const std::vector<Measurement>& results)
{
    const double FAR_OFF = 0.2;
    double sum = 0;
    int count = 0;
    for (const Measurement& m : results)
        for (const double ratio : lengthRatios(target, m.points))
        {
            sum += ratio;
            count++;
        }
    if (!count || std::abs(sum/count - 1) <= FAR_OFF)
        return "";
    return format("the distances between neighbouring points are on average %.3g times those of the target: is --square=%g "
                  "right, in the unit of the calibration, and are images and calibration of the same cameras?", sum/count,
                  target.square());
}

void sayNoisier(const Options& options, const Calibration& calibration, const std::vector<Sight>& sights,
                const std::vector<Measurement>& results, const Command& command)
{
    const double sigma = pixelSigma(options, calibration), few = 3.;
    std::vector<std::string> names;
    double worst = 0;
    for (size_t i = 0; i < results.size(); i++)
        if (!results[i].inconsistent() && results[i].noise > few*sigma)
        {
            names.push_back(sights[i].stem);
            worst = std::max(worst, results[i].noise);
        }
    if (!names.empty())
        command.warn(format("the pixels are noisier than in the calibration: up to %.3g px per coordinate instead of %.3g px, in ",
                            worst, sigma) + listed(names) + "; sx, sy, sz say so. Check focus, light, motion, and the target");
}

//! What sx, sy and sz leave out.
void sayUncovered(const Options& options, const Calibration& calibration, const Command& command)
{
    if (!(pixelSigma(options, calibration) > 0))
        command.warn("'" + options.calibration + "' does not say how large the noise of a pixel is, so sx, sy, sz are not known: "
                     "calibrate with refract_calib, or give --pixel-sigma");
    else if (calibration.covariance.empty())
        command.warn("'" + options.calibration + "' has no covariance: sx, sy, sz cover the noise of the pixels, and take the "
                     "calibration as exact");
}

//! A cell of a table with commas between; blanks are quoted too, for readers that split at them.
std::string cellOf(const std::string& text)
{
    if (text.find_first_of(", ;\t\"\n\r") == std::string::npos)
        return text;
    std::string cell = "\"";
    for (char c : text)
        cell += c == '"' ? std::string("\"\"") : std::string(1, c);
    return cell + "\"";
}

std::string csvOf(const std::vector<Sight>& sights, const std::vector<Measurement>& measurements)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::ostringstream csv;
    csv.precision(12);
    csv << "image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status\n";
    for (size_t k = 0; k < sights.size(); k++)
        for (size_t i = 0; i < sights[k].pixels1.size(); i++)
        {
            const Measurement& m = measurements[k];
            const cv::Point2d second = m.pixels2.empty() ? cv::Point2d(nan, nan) : m.pixels2[i];
            csv << cellOf(sights[k].stem) << ',' << i;
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
            squares += error*error;
            sum += error;
            largest = std::max(largest, std::abs(error));
            lengths++;
        }
        for (size_t i = 0; i < m.points.size(); i++)
            if (m.points[i].z == m.points[i].z)
            {
                near = std::min(near, m.points[i].z);
                far = std::max(far, m.points[i].z);
                depthSigma += m.sigma[i][2];
            }
        answers += m.answers();
        points += (int)m.points.size();
    }
    std::vector<std::string> row = {name, format("%d of %d", answers, points), format("%.1f ... %.1f", near, far),
                                    std::isnan(depthSigma) ? "unknown" : format("%.4f", depthSigma/answers)};
    if (lengthsMeasured)
        row.insert(row.end(), {format("%.4f", std::sqrt(squares/lengths)), format("%+.4f", sum/lengths),
                               format("%.4f", largest)});
    return row;
}

//! To compare with: without windows they are welcome too.
std::vector<Calibration> readOthers(const Options& options, const Calibration& calibration)
{
    std::vector<Calibration> others;
    for (const std::string& file : options.compareWith)
    {
        others.push_back(readCalibration(file));
        if (others.back().cameras.size() != calibration.cameras.size())
            throw Failure("'" + file + "' has another number of cameras than '" + options.calibration + "'");
    }
    return others;
}

void printTable(const Options& options, const Calibration& calibration, const std::vector<Calibration>& others,
                const Target& target, const std::vector<Sight>& sights, const std::vector<Measurement>& results)
{
    const bool lengthsMeasured = options.lengthsMeasured();
    Table table(lengthsMeasured ? std::vector<std::string>{"", "points", "depth z", "mean sz", "length RMS error",
                                                           "mean error", "largest"}
                                : std::vector<std::string>{"", "points", "depth z", "mean sz"});
    if (options.compare)
        table.add(rowOf("glass ignored", target, measureAll(options, withoutWindows(calibration), target, sights),
                        lengthsMeasured));
    for (size_t i = 0; i < others.size(); i++)
        table.add(rowOf(stemOf(options.compareWith[i]), target, measureAll(options, others[i], target, sights), lengthsMeasured));
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
    app.add_option("--unit", options.unit, "unit of --square; what refract_calib had, or nothing")
        ->check(CLI::IsMember(unitNames()));
    app.add_option("--plane", options.plane, "a,b,c,d: the target lies on a x + b y + c z = d in the camera's frame");
    app.add_option("--out", options.out, "points.csv to write");
    app.add_flag("--no-window", options.noWindow, "calib.yml has no glass_window, and there is none");
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
        const Options options = parsed(command, addOptions);
        const Target target(options.target);
        const Calibration calibration = readCalibration(options.calibration);
        requireWindows(calibration, options.calibration, options.noWindow);
        requireSameUnit(calibration, target.square(), options.unit);
        checkCombination(options, calibration);
        std::vector<std::string> inputs = {options.calibration, options.image1, options.image2};
        inputs.insert(inputs.end(), options.compareWith.begin(), options.compareWith.end());
        checkOutputs({{"--out", options.out, OUTPUT_TEXT}}, inputs);
        const std::vector<Calibration> others = readOthers(options, calibration);
        const std::vector<Sight> sights = readSights(options, calibration, target, command);
        std::vector<Measurement> results = measureAll(options, calibration, target, sights);
        judge(options, calibration, results);
        const std::string contradiction = contradictionIn(sights, results);
        int answers = 0;
        for (const Measurement& m : results)
            answers += m.answers();
        if (!answers)
            throw Failure(contradiction.empty() ? "no point of the target could be measured: are images and calibration of the "
                                                  "same cameras?" : contradiction);
        if (!contradiction.empty())
            command.warn(contradiction);
        const std::string lengths = options.lengthsMeasured() ? wrongLengths(target, results) : "";
        if (!lengths.empty())
            command.warn(lengths);
        sayNoisier(options, calibration, sights, results, command);
        sayUncovered(options, calibration, command);
        if (!options.out.empty())
            writeText(options.out, csvOf(sights, results));
        if (!command.quiet())
            printTable(options, calibration, others, target, sights, results);
        return mostContradict(results) || !lengths.empty() ? LIMIT_NOT_MET : DONE;
    });
}
