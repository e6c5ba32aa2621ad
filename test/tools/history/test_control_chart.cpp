// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* Control charts of simulated rigs: false alarms as stated, drifts found soon, and named. What checks tell of a rig comes
from simulated images through the same code as in refract_check; so does every check of a drift. */
#include "assess/check_scenes.hpp"
#include "history/drift.hpp"
#include "console/failure.hpp"
#include "normal_draw.hpp"
#include "temporary_folder.hpp"
#include <nlohmann/json.hpp>
#include <fstream>
#include <map>

using namespace check_scenes;

namespace {

const double FALSE_ALARM = 1./370., MONTH = 30.4375*86400.;
const std::string START = "2026-01-15T08:00:00Z";

//! One rig, calibrated, and its checks, one a month.
struct RigWithHistory
{
    Scene scene;
    Calibrated rig;
    MatrixXd covariance;
    CheckHistory history;

    RigWithHistory(const Scene& ofScene, scenes::Random& random) : scene(ofScene), rig(calibrated(ofScene, random)),
        covariance(toEigen(withWedges(rig.input).covariance)) {}

    //! @return whether the check by itself says that something changed
    bool check(const RigModel& now, scenes::Random& random, double falseAlarm = 1e-6)
    {
        const CheckResult result = checkRig(rig.input, newViews(scene, now, random), falseAlarm);
        CheckRecord record = recordOf(result.charted, {}, timeAt(secondsOf(START) + MONTH*(double)history.checks.size()), history);
        record.sigma = result.sigma;
        record.dof = rig.input.dof;
        history.checks.push_back(record);
        return result.changed;
    }
};

RigModel tilted(const RigModel& rig, int c, double degrees, double azimuth)
{
    RigModel result = rig.clone();
    GlassWindow window = result.cameras[c]->window();
    const Vec3d across = normalize(window.normal.cross(Vec3d(0, 1, 0)));
    window.normal = normalize(window.normal + std::tan(degrees*CV_PI/180)
                              * (std::cos(azimuth)*across + std::sin(azimuth)*window.normal.cross(across)));
    result.cameras[c]->setWindow(window);
    return result;
}

//! Scores of checks in which nothing changed, of a rig calibrated anew, with noises that their residuals state within their freedom.
class InControl
{
public:
    InControl(const CheckHistory& history, const MatrixXd& covariance) : ofCalibration_(scenes::rootOf(covariance))
    {
        for (const CheckRecord& check : history.checks)
            ofNoise_.push_back(scenes::rootOf(check.information - check.byParameters*covariance*check.byParameters.transpose()));
    }

    void draw(CheckHistory& history, scenes::Random& random) const
    {
        std::mt19937_64 engine((unsigned)random.below(1 << 30));
        std::map<double, double> noises;            // by the estimate
        const auto noiseOf = [&](const CheckRecord& check) {
            const auto [noise, isNew] = noises.emplace(check.sigma, 0.);
            if (isNew)
                noise->second = std::sqrt(check.dof/std::chi_squared_distribution<double>(check.dof)(engine));
            return noise->second;
        };
        const VectorXd dp = noiseOf(history.checks[0])*scenes::drawn(ofCalibration_, random);
        for (size_t t = 0; t < history.checks.size(); t++)
        {
            CheckRecord& check = history.checks[t];
            check.score = check.byParameters*dp + noiseOf(check)*scenes::drawn(ofNoise_[t], random);
        }
    }

private:
    MatrixXd ofCalibration_;
    std::vector<MatrixXd> ofNoise_;
};

struct Alarms
{
    long atRisk = 0, first = 0;     //!< checks up to the first alarm of each history
    double rate() const { return (double)first/(double)std::max(1L, atRisk); }
};

//! Of histories drawn anew with what checks tell as they are.
Alarms alarmsInControl(RigWithHistory& rig, double falseAlarm, int histories, scenes::Random& random)
{
    const std::vector<ChartLimit> limits = chartLimits(rig.history, rig.covariance, falseAlarm);
    const InControl inControl(rig.history, rig.covariance);
    Alarms alarms;
    for (int i = 0; i < histories; i++)
    {
        inControl.draw(rig.history, random);
        for (const ChartPoint& point : controlCharts(rig.history, rig.covariance, limits))
        {
            alarms.atRisk++;
            if (!point.isAlarm())
                continue;
            alarms.first++;
            break;
        }
    }
    return alarms;
}

struct Drifts
{
    int tried = 0, found = 0, first = 0, beside = 0;
    double needed = 0.;                     //!< checks, mean
};

//! The window of the last camera drifts from the second check on, by that much at each.
Drifts drifts(const Scene& scene, double degrees, int trials, unsigned salt)
{
    Drifts sum;
    for (int trial = 0; trial < trials; trial++)
    {
        scenes::Random random(salt + (unsigned)trial);
        RigWithHistory rig(scene, random);
        rig.check(rig.rig.truth, random);
        const int camera = (int)rig.rig.truth.cameras.size() - 1;
        int window = -1;
        for (size_t c = 0; c < rig.history.changes.size(); c++)
            if (rig.history.changes[c].name == (camera ? format("window of camera %d: tilt", camera + 1) : "window: tilt"))
                window = (int)c;
        REQUIRE(window >= 0);
        const int within = 5;
        const double azimuth = random.uniform(0, 2*CV_PI);
        for (int n = 1; n <= within; n++)
            rig.check(tilted(rig.rig.truth, camera, n*degrees, azimuth), random);
        const std::vector<ChartPoint> points = controlCharts(rig.history, rig.covariance,
                                                             chartLimits(rig.history, rig.covariance, FALSE_ALARM));
        sum.tried++;
        const auto alarm = std::find_if(points.begin() + 1, points.end(), [](const ChartPoint& p) { return p.isAlarm(); });
        if (alarm == points.end())
            continue;
        sum.found++;
        sum.needed += (double)(alarm - points.begin());
        rig.history.checks.resize((size_t)(alarm - points.begin()) + 1);
        const std::vector<DriftCause> causes = driftCauses(rig.history, rig.covariance);
        const bool isNamed = std::any_of(causes.begin(), causes.end(), [&](const DriftCause& c) { return c.change == window; });
        const bool isFirst = !causes.empty() && causes[0].change == window;
        sum.first += isFirst;
        sum.beside += isNamed && !isFirst;
    }
    sum.needed /= std::max(1, sum.found);
    return sum;
}

void print(const std::string& name, double degrees, const Drifts& d)
{
    std::cout << format("[numbers] %s: a drift of %g degrees a month in one window: found in %d of %d, after %.1f checks; the window named "
                        "first in %d, beside by 'or' in %d\n", name.c_str(), degrees, d.found, d.tried, d.needed, d.first, d.beside)
              << std::flush;
}

} // namespace

TEST_CASE("Innovations of checks that share a calibration's error are independent and of their stated covariance", "[history]")
{
    scenes::Random random(6100);
    std::cout << "seed " << scenes::seed() << '\n';
    RigWithHistory rig(allScenes()[1], random);
    for (int t = 0; t < 3; t++)
        rig.check(rig.rig.truth, random);
    for (CheckRecord& check : rig.history.checks)
        check.dof = 1e9;
    const InControl inControl(rig.history, rig.covariance);
    const int trials = 1500;
    double t2[3] = {}, together = 0.;
    int rank = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        inControl.draw(rig.history, random);
        InnovationFilter filter(rig.covariance);
        VectorXd last;
        for (int t = 0; t < 3; t++)
        {
            const Innovation e = filter.add(rig.history.checks[t], rig.history.changes, rig.history.checks[t].score);
            t2[t] += e.value.col(0).dot(e.inverse*e.value.col(0))/trials;
            const VectorXd u = e.stdAlone.cwiseInverse().asDiagonal()*e.alone;
            if (t > 0)
                together += u.dot(last)/((double)u.size()*2*trials);
            last = u;
            rank = e.rank();
        }
    }
    for (double mean : t2)              // the mean of chi^2, with its standard deviation
        CHECK(mean == Approx(rank).margin(4.*std::sqrt(2.*rank/trials)));
    CHECK(std::abs(together) < 4./std::sqrt(2.*trials));
}

TEST_CASE("Charts raise as many false alarms as stated", "[history]")
{
    scenes::Random random(6000);
    std::cout << "seed " << scenes::seed() << '\n';
    RigWithHistory rig(allScenes()[1], random);
    for (int t = 0; t < 8; t++)
        rig.check(rig.rig.truth, random);
    const bool isNoiseTheirOwn = GENERATE(false, true);         // as that of scenes, or of images that are noisier
    for (size_t t = 1; isNoiseTheirOwn && t < rig.history.checks.size(); t++)
    {
        rig.history.checks[t].dof = 40;
        rig.history.checks[t].sigma *= 1 + 1e-3*(double)t;
    }
    CAPTURE(isNoiseTheirOwn);
    const double stated = 0.05;
    const Alarms alarms = alarmsInControl(rig, stated, 600, random);
    std::cout << format("[numbers] false alarms in control: 1 in %.1f checks, stated 1 in %.0f (%ld alarms)\n", 1./alarms.rate(), 1./stated,
                        alarms.first);
    const double expected = stated*(double)alarms.atRisk;
    CHECK((double)alarms.first == Approx(expected).margin(4.*std::sqrt(expected) + 0.05*expected));
}

TEST_CASE("A drift of a window is found soon, and named", "[history]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const Drifts d = drifts(allScenes()[1], 0.02, 3, 6200);
    print("stereo", 0.02, d);
    CHECK(d.found == d.tried);
    CHECK(d.first + d.beside >= d.tried - 1);
}

TEST_CASE("A history survives its file, and a check that does not fit is refused", "[history]")
{
    scenes::Random random(6300);
    std::cout << "seed " << scenes::seed() << '\n';
    RigWithHistory rig(allScenes()[0], random);
    for (int t = 0; t < 2; t++)
        rig.check(rig.rig.truth, random);
    rig.history.checks[1].images = {{"a.png", "0123"}};
    const TemporaryFolder folder;
    const std::string file = folder / "history.json";
    writeHistory(file, rig.history);
    const CheckHistory read = readHistory(file);
    REQUIRE(read.checks.size() == 2);
    CHECK(read.changes.size() == rig.history.changes.size());
    for (int t = 0; t < 2; t++)
    {
        CHECK(read.checks[t].time == rig.history.checks[t].time);
        CHECK(read.checks[t].score == rig.history.checks[t].score);
        CHECK(read.checks[t].information == rig.history.checks[t].information);
        CHECK(read.checks[t].byParameters == rig.history.checks[t].byParameters);
    }
    CheckRecord next = rig.history.checks[1];
    CHECK_THROWS_AS(requireNew(read, file, next), Failure);             // the same image
    next.images[0].sha256 = "4567";
    CHECK_NOTHROW(requireNew(read, file, next));                        // at the same time
    next.time = "2026-01-14T08:00:00Z";
    CHECK_THROWS_AS(requireNew(read, file, next), Failure);
    CHECK(readHistory(folder / "none.json").checks.empty());
    for (const std::string text : {"", "{}", "[1, 2]", "{\"file\": \"refract_check history\"}", "no JSON"})
    {
        std::ofstream(file) << text;
        CHECK_THROWS_AS(readHistory(file), Failure);
    }
}

TEST_CASE("An edited or deleted check is told, at each reading", "[history]")
{
    scenes::Random random(6700);
    RigWithHistory rig(allScenes()[0], random);
    for (int t = 0; t < 3; t++)
        rig.check(rig.rig.truth, random);
    const TemporaryFolder folder;
    const std::string file = folder / "history.json";
    writeHistory(file, rig.history);
    CHECK(readHistory(file).broken.empty());
    std::ifstream in(file);
    const nlohmann::json written = nlohmann::json::parse(in);
    using Edit = std::function<void(nlohmann::json&)>;
    const auto brokenAfter = [&](const Edit& edit) {
        nlohmann::json edited = written;
        edit(edited);
        std::ofstream(file) << edited.dump();
        CheckHistory next = readHistory(file);
        next.checks.push_back(rig.history.checks[2]);
        writeHistory(file, next);
        return readHistory(file).broken;                    // it stays so when it is written again, with a new check
    };
    CHECK(brokenAfter([](nlohmann::json&) {}).empty());
    const Edit edits[] = {
        [](nlohmann::json& file) { file["checks"][1]["score"][0] = 1e-3; },
        [](nlohmann::json& file) { file["checks"][2]["verdict"] = "unchanged!"; },
        [](nlohmann::json& file) { file["checks"][0]["values"][0]["value"][0] = 0.; },         // what a reader looks at
        [](nlohmann::json& file) { file["checks"][2]["remark"] = "added"; },
        [](nlohmann::json& file) { file["charts"][0]["factor"] = 1e-3; },
        [](nlohmann::json& file) { std::swap(file["charts"][0]["name"], file["charts"][1]["name"]); },
        [](nlohmann::json& file) { file["calibration_sha256"] = "0123"; },
        [](nlohmann::json& file) { file["window_serial"] = "W-2"; },
        [](nlohmann::json& file) { file["checks"].erase(1); },
        [](nlohmann::json& file) { file["checks"].erase(0); },
        [](nlohmann::json& file) { file["checks"].erase(2); },
        [](nlohmann::json& file) { file["checks"] = nlohmann::json::array(); }};
    for (const Edit& edit : edits)
    {
        CAPTURE(&edit - edits);
        CHECK(brokenAfter(edit).size() == 1);
    }
    // As if an older tool had written them.
    const std::vector<std::string> broken = brokenAfter([](nlohmann::json& file) {
        file.erase("last");
        for (nlohmann::json& check : file["checks"])
        {
            check["verdict"] = "unchanged!";
            check.erase("sha256");
            check.erase("previous");
        }
    });
    REQUIRE(broken.size() == 1);
    CHECK(broken[0].find("3 checks, up to that of " + rig.history.checks[2].time + ", had no SHA-256") == 0);
}

TEST_CASE("A time to come is refused", "[history]")
{
    CHECK_THROWS_AS(requirePast("2999-01-01", "--date"), Failure);
    CHECK_NOTHROW(requirePast(timeOfNow().substr(0, 10), "--date"));
    CHECK_THROWS_AS(requireDate("2024-01-01T00:00", "--date"), Failure);
}

TEST_CASE("Times are read as ISO 8601 writes them", "[history]")
{
    CHECK(parseTime("2026-11-26", "--date") == "2026-11-26T00:00:00Z");
    CHECK(parseTime("2026-11-26T08:30", "--date") == "2026-11-26T08:30:00Z");
    CHECK(parseTime("2026-11-26T08:30:01Z", "--date") == "2026-11-26T08:30:01Z");
    CHECK(parseTime("2026-11-26T00:30:00+01:00", "--date") == "2026-11-25T23:30:00Z");
    CHECK(parseTime("2026-11-26T08:30-05:30", "--date") == "2026-11-26T14:00:00Z");
    for (const std::string text : {"", "yesterday", "2026-02-30", "2026-13-01", "2026-11-26T25:00", "2026-11-26 08:30",
                                   "2026-11-26T08:30:00ZZ", "26.11.2026", "2026-11-26T08"})
    {
        INFO(text);
        CHECK_THROWS_AS(parseTime(text, "--date"), Failure);
    }
}

TEST_CASE("How often charts raise a false alarm", "[.monte-carlo][history]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    for (const Scene& scene : allScenes())
    {
        scenes::Random random(6001);
        RigWithHistory rig(scene, random);
        for (int t = 0; t < 36; t++)
            rig.check(rig.rig.truth, random);
        const Alarms alarms = alarmsInControl(rig, FALSE_ALARM, scenes::trials(6000), random);
        std::cout << format("[numbers] %s, %zu charted parameters: false alarms 1 in %.0f checks (%ld in %ld), stated 1 in 370\n",
                            scene.name.c_str(), (size_t)firstParameters(rig.history.changes).back(), 1./alarms.rate(), alarms.first,
                            alarms.atRisk) << std::flush;
        CHECK(alarms.rate()/FALSE_ALARM == Approx(1.).margin(0.1));
    }
}

TEST_CASE("How often a history of simulated images raises a false alarm, the check by itself included", "[.monte-carlo][history]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const double stated = 0.05;
    const int checks = 12;
    Alarms alarms;
    for (int trial = 0; trial < scenes::trials(60); trial++)
    {
        scenes::Random random(6400 + (unsigned)trial);
        const Scene scene = allScenes()[trial % 4];
        RigWithHistory rig(scene, random);
        std::vector<bool> changed;
        for (int t = 0; t < checks; t++)
            changed.push_back(rig.check(rig.rig.truth, random, 0.05*stated));
        const std::vector<ChartPoint> points = controlCharts(rig.history, rig.covariance,
                                                             chartLimits(rig.history, rig.covariance, 0.95*stated));
        for (int t = 0; t < checks; t++)
        {
            alarms.atRisk++;
            if (!points[t].isAlarm() && !changed[t])
                continue;
            alarms.first++;
            break;
        }
    }
    std::cout << format("[numbers] from images: false alarms in %.1f %% of %ld checks (%ld), stated %.0f %%\n", 100.*alarms.rate(),
                        alarms.atRisk, alarms.first, 100.*stated);
    const double expected = stated*(double)alarms.atRisk;
    CHECK((double)alarms.first == Approx(expected).margin(4.*std::sqrt(expected)));
}

TEST_CASE("How soon a drift of a window is found", "[.monte-carlo][history]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    for (const Scene& scene : allScenes())
    {
        if (!scene.nominal.windows.empty())         // one window of three cameras: tilted() moves one camera's part of it
            continue;
        const Drifts d = drifts(scene, 0.02, scenes::trials(40), 6500);
        print(scene.name, 0.02, d);
        CHECK(d.found >= 0.9*d.tried);
        CHECK(d.first + d.beside >= 0.9*d.found);
    }
}
