// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_WAND_SCENE_HPP
#define REFRACT_TEST_WAND_SCENE_HPP

#include "run_tool.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <iomanip>
#include <map>

/* A wand that is waved through water before cameras in housings, and the files that refract_bundle reads of it. */
namespace wand {

using namespace cv;
using namespace cv::refract;

const double WAND = 200, WAND_STD = 0.5, PIXEL_SIGMA = 0.1, ARC_MINUTE = CV_PI/180/60;
const Size SIZE(1280, 1024);

struct Rig
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    Mat covariance;

    static Rig read(const std::string& file)
    {
        Rig rig;
        std::vector<int> windows;
        readRig(file, rig.cameras, rig.Rs, rig.Ts, windows, rig.covariance);
        return rig;
    }
    //! All parameters, in the order of the covariance.
    std::map<std::string, double> parameters() const
    {
        std::map<std::string, double> all;
        for (size_t c = 0; c < cameras.size(); c++)
        {
            const GlassWindow w = cameras[c]->window();
            const std::string camera = std::to_string(c + 1) + " ";
            const auto add = [&](const char* name, const std::vector<double>& values) {
                for (size_t i = 0; i < values.size(); i++)
                    all[camera + name + (values.size() > 1 ? "[" + std::to_string(i) + "]" : "")] = values[i];
            };
            const auto list = [](const Vec3d& v) { return std::vector<double>(v.val, v.val + 3); };
            const bool isRound = w.shape == WINDOW_DOME || w.shape == WINDOW_TUBE;
            add(isRound ? "center" : "normal", list(isRound ? w.center : w.normal));
            if (w.shape == WINDOW_TUBE)
                add("axis", list(w.axis));
            add(isRound ? "radius" : "distance", {isRound ? w.radius : w.distance});
            if (w.shape == WINDOW_BENT)
                add("curvature", {w.curvature});
            add("thickness[0]", w.thickness);
            Mat rvec;
            Rodrigues(Rs[c], rvec);
            for (int i = 0; i < 3 && c > 0; i++)
            {
                all[camera + "R" + std::to_string(i)] = rvec.at<double>(i);
                all[camera + "T" + std::to_string(i)] = Ts[c].at<double>(i);
            }
        }
        return all;
    }
    //! Of the covariance.
    std::vector<std::string> columnNames() const
    {
        std::vector<std::string> names;
        for (size_t c = 0; c < cameras.size(); c++)
            for (const String& name : cameras[c]->parameterNames())
                names.push_back(std::to_string(c + 1) + " " + name);
        for (size_t c = 1; c < cameras.size(); c++)
            for (const char* what : { "R", "T" })
                for (int i = 0; i < 3; i++)
                    names.push_back(std::to_string(c + 1) + " " + what + std::to_string(i));
        return names;
    }
    std::map<std::string, double> deviations() const
    {
        std::map<std::string, double> all;
        const std::vector<std::string> names = columnNames();
        for (int i = 0; i < (int)names.size(); i++)
            all[names[i]] = std::sqrt(std::max(covariance.at<double>(i, i), 0.));
        return all;
    }
};

//! Cameras on an arc, turned towards the middle of the tank.
inline Rig makeRig(int cameras, const std::vector<GlassWindow>& windows, double turned, double moved)
{
    const Matx33d K(1600, 0, 640, 0, 1600, 512, 0, 0, 1);
    Rig rig;
    for (int c = 0; c < cameras; c++)
    {
        rig.cameras.push_back(RefractiveCamera::create(K, std::vector<double>{ -0.1, 0.05, 0, 0 }, windows[c]));
        rig.cameras.back()->setImageSize(SIZE);
        Matx33d R;
        Rodrigues(Vec3d(0.02*c, 0.35*c + turned*(c > 0), 0.01*c), R);
        const Vec3d middle(0, 0, 700);
        rig.Rs.push_back(Mat(R));
        rig.Ts.push_back(Mat(Vec3d(middle - R*middle + Vec3d(moved, 2*moved, -moved)*(c > 0))));
    }
    return rig;
}

/* The truth, what is thought of it beforehand (as well as the tool's default deviations say), and what the cameras see. */
struct Wand
{
    explicit Wand(unsigned salt, int cameras = 2, int moments = 100, double startOff = 1) : random(salt)
    {
        std::vector<GlassWindow> real, thought;
        for (int c = 0; c < cameras; c++)
        {
            GlassWindow window(Vec3d(-0.08 + 0.05*c, 0.1 - 0.04*c, 1), 10, 1.49, 40 + 5*c, 1.333);
            thought.push_back(window);
            thought.back().normal = normalize(window.normal + startOff*Vec3d(0.06, -0.05, 0));
            real.push_back(asDelivered(window));
        }
        build(real, thought, moments, startOff);
    }

    //! Behind windows of any shape, each as thought and in its real place.
    Wand(unsigned salt, const std::vector<GlassWindow>& thought, std::vector<GlassWindow> placed, int moments) : random(salt)
    {
        for (GlassWindow& window : placed)
            window = asDelivered(window);
        build(placed, thought, moments, 1);
    }

    //! Within what the tool's default deviations say.
    GlassWindow asDelivered(GlassWindow window)
    {
        const bool isRound = window.shape == WINDOW_DOME || window.shape == WINDOW_TUBE;
        (isRound ? window.radius : window.distance) += random.normal(isRound ? 0.1 : 1);
        window.thickness[0] += random.normal(0.1);
        window.index[0] += random.normal(0.001);
        window.outerIndex += random.normal(0.001);
        if (!isRound)
            window.wedge = { Vec2d(random.normal(ARC_MINUTE), random.normal(ARC_MINUTE)) };
        return window;
    }

    void build(const std::vector<GlassWindow>& real, const std::vector<GlassWindow>& thought, int moments, double startOff)
    {
        truth = makeRig((int)real.size(), real, 0, 0);
        start = makeRig((int)real.size(), thought, 0.03*startOff, 8*startOff);
        length = WAND + random.normal(WAND_STD);        // not what is engraved on it
        wave(moments);
    }

    //! At other moments.
    void wave(int moments)
    {
        points.clear();
        pixels.clear();
        for (int moment = 0; moment < moments; moment++)
        {
            const Vec3d middle(random.uniform(-100, 100), random.uniform(-80, 80), random.uniform(600, 800));
            const Vec3d along(random.normal(1), random.normal(1), random.normal(1));
            points.push_back(Point3d(middle + length/2*normalize(along)));
            points.push_back(Point3d(middle - length/2*normalize(along)));
        }
        see();
    }

    //! Slowly, as a hand does: a few pixels from one moment to the next.
    void sweep(int moments)
    {
        const auto sines = [&](double size) {
            const double first = random.uniform(0, 2*CV_PI), second = random.uniform(0, 2*CV_PI);
            return [=](int moment) { return size*(0.6*std::sin(0.05*moment + first) + 0.4*std::sin(0.085*moment + second)); }; };
        const auto x = sines(100), y = sines(80), z = sines(90), a = sines(1.5), b = sines(1.5), c = sines(1.5);
        points.clear();
        pixels.clear();
        for (int moment = 0; moment < moments; moment++)
            for (int end : { 1, -1 })
                points.push_back(Point3d(Vec3d(x(moment), y(moment), 700 + z(moment))
                                         + end*length/2*normalize(Vec3d(a(moment), b(moment), c(moment)))));
        see();
    }

    void see()
    {
        const double NaN = std::numeric_limits<double>::quiet_NaN();
        for (size_t c = 0; c < truth.cameras.size(); c++)
        {
            std::vector<Point2d> seen;
            refractiveProjectPoints(points, truth.Rs[c], truth.Ts[c], truth.cameras[c], seen);
            for (Point2d& p : seen)
            {
                p += Point2d(random.normal(PIXEL_SIGMA), random.normal(PIXEL_SIGMA));
                if (!(p.x > 0 && p.y > 0 && p.x < SIZE.width - 1 && p.y < SIZE.height - 1))
                    p = Point2d(NaN, NaN);
            }
            pixels.push_back(seen);
        }
    }

    std::string matches(bool withImages = true) const
    {
        std::ostringstream csv;
        csv << std::fixed << std::setprecision(3) << (withImages ? "image,id" : "id");
        for (size_t c = 1; c <= pixels.size(); c++)
            csv << ",u" << c << ",v" << c;
        for (size_t i = 0; i < points.size(); i++)
        {
            const char* const end = i % 2 ? "b" : "a";
            csv << "\n" << (withImages ? "m" : "") << i/2 << (withImages ? "," : "") << end;
            for (const std::vector<Point2d>& ofCamera : pixels)
                if (ofCamera[i].x == ofCamera[i].x)
                    csv << "," << ofCamera[i].x << "," << ofCamera[i].y;
                else
                    csv << ",,";
        }
        return csv.str() + "\n";
    }

    //! Writes start.yml, matches.csv, lengths.csv. @param withoutWindows what the cameras look through, the options are to say
    void write(const TemporaryFolder& f, bool withoutWindows = false) const
    {
        std::vector<Ptr<RefractiveCamera> > cameras;
        for (const Ptr<RefractiveCamera>& camera : start.cameras)
        {
            cameras.push_back(camera->clone());
            if (withoutWindows)
                cameras.back()->setWindow(GlassWindow());
        }
        writeRig(f / "start.yml", cameras, start.Rs, start.Ts);
        writeFile(f / "matches.csv", matches());
        writeFile(f / "lengths.csv", format("id1,id2,length,std\na,b,%g,%g\n", WAND, WAND_STD));
    }

    scenes::Random random;
    Rig truth, start;
    double length;
    std::vector<Point3d> points;
    std::vector<std::vector<Point2d> > pixels;
};

inline std::string commandFor(const TemporaryFolder& f, const std::string& options)
{
    return "refract_bundle " + f / "start.yml" + " --points=" + f / "matches.csv --out=" + f / "calib.yml" + " --points-out="
        + f / "points.csv " + options;
}

inline ToolResult bundle(const TemporaryFolder& f, const std::string& options = "")
{
    return runTool(commandFor(f, "--lengths=" + f / "lengths.csv " + options));
}

struct Row
{
    std::string image, id;
    std::vector<double> numbers;        //!< pixels, x, y, z, sx, sy, sz, status
    double fromEnd(int k) const { return numbers[numbers.size() - k]; }
    Point3d X() const { return Point3d(fromEnd(7), fromEnd(6), fromEnd(5)); }
    int status() const { return (int)fromEnd(1); }
};

inline std::vector<Row> rowsOf(const std::string& file)
{
    std::vector<Row> rows;
    std::istringstream in(readFile(file));
    std::string line, cell;
    std::getline(in, line);
    while (std::getline(in, line))
    {
        std::istringstream cells(line);
        Row row;
        std::getline(cells, row.image, ',');
        std::getline(cells, row.id, ',');
        while (std::getline(cells, cell, ','))
            row.numbers.push_back(std::atof(cell.c_str()));
        rows.push_back(row);
    }
    return rows;
}

} // namespace wand

#endif // REFRACT_TEST_WAND_SCENE_HPP
