// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/check_history.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "console/json.hpp"
#include "console/sha256.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <filesystem>
#include <fstream>

using namespace cv::refract;
using cv::format;

namespace tools {

namespace {

const char* const KIND = "refract_check history";
const double HUNDREDTHS = 100.;         // of pixels
const char* const CHAINED_LATER = "chained_later";      // a record that was not chained when it was read: whatever it says, it said then

Json jsonOf(const MatrixXd& matrix)
{
    Json rows = Json::array();
    for (const auto& row : matrix.rowwise())
        rows.append(std::vector<double>(row.begin(), row.end()));
    return rows;
}

VectorXd vectorOf(const Json& json)
{
    const std::vector<double> values = json.asNumbers();
    return Eigen::Map<const VectorXd>(values.data(), (Eigen::Index)values.size());
}

//! @param columns of each row
MatrixXd matrixOf(const Json& json, Eigen::Index rows, Eigen::Index columns)
{
    if ((Eigen::Index)json.items().size() != rows)
        throw Failure("rows are missing");
    MatrixXd matrix(rows, columns);
    for (Eigen::Index i = 0; i < rows; i++)
    {
        const VectorXd row = vectorOf(json.at((size_t)i));
        if (row.size() != columns)
            throw Failure("numbers are missing");
        matrix.row(i) = row;
    }
    return matrix;
}

//! What a reader wants to see: each change by itself, as if nothing else had changed.
Json valuesOf(const CheckHistory& history, const CheckRecord& check)
{
    Json values = Json::array();
    Eigen::Index first = 0;
    for (int c : check.changes)
    {
        const ChartedChange& change = history.changes[c];
        const int size = change.size();
        const MatrixXd C = inverse(check.information.block(first, first, size, size));
        const VectorXd value = change.factor*timesVector(C, check.score.segment(first, size));
        const VectorXd std = std::abs(change.factor)*C.diagonal().cwiseSqrt();
        values.append({{"name", change.name}, {"value", std::vector<double>(value.begin(), value.end())},
                       {"std", std::vector<double>(std.begin(), std.end())}, {"unit", change.unit}});
        first += size;
    }
    return values;
}

Json jsonOf(const CalibrationImage& image)
{
    std::vector<int> hundredths;
    for (const cv::Point2d& p : image.pixels)
        hundredths.insert(hundredths.end(), {cvRound(HUNDREDTHS*p.x), cvRound(HUNDREDTHS*p.y)});
    return {{"name", image.name}, {"camera", image.camera + 1}, {"hundredths_px", hundredths}};
}

CalibrationImage shownOf(const Json& json)
{
    CalibrationImage image;
    image.name = json.at("name").asText();
    const double camera = json.at("camera").asNumber();
    if (!(camera >= 1. && camera <= MAX_CAMERAS))
        throw Failure("an image is of no camera");
    image.camera = (int)camera - 1;
    const std::vector<int> hundredths = json.at("hundredths_px").asWholes();
    for (size_t i = 0; i + 1 < hundredths.size(); i += 2)
        image.pixels.push_back(cv::Point2d(hundredths[i], hundredths[i + 1])/HUNDREDTHS);
    image.mean = meanOfSeen(image.pixels);
    return image;
}

//! All that is kept of a check; the values are for readers, and no more than what the rest says.
Json keptOf(const CheckHistory& history, const CheckRecord& check)
{
    Json images = Json::array(), shown = Json::array();
    for (const CheckedImage& image : check.images)
        images.append({{"name", image.name}, {"sha256", image.sha256}});
    for (const CalibrationImage& image : check.shown)
        shown.append(jsonOf(image));
    return {{"time", check.time}, {"verdict", check.verdict}, {"images", images}, {"shown", shown}, {"sigma_px", check.sigma},
            {"dof", check.dof}, {"changes", check.changes}, {"score", std::vector<double>(check.score.begin(), check.score.end())},
            {"information", jsonOf(check.information)}, {"by_parameters", jsonOf(check.byParameters)},
            {"values", valuesOf(history, check)}};
}

//! Empty in the file of an older tool.
std::string textOrNone(const Json& json, const std::string& name)
{
    try
    {
        return json.at(name).asText();
    }
    catch (const Json::Error&)
    {
        return "";
    }
}

//! The same, whatever program wrote it last.
Json inOneForm(const Json& json)
{
    if (json.isNumber())
        return json.asNumber();
    Json list = Json::array(), object = Json::object();
    if (json.isList())
        for (const Json& item : json.items())
            list.append(inOneForm(item));
    std::vector<std::string> names = json.names();
    std::sort(names.begin(), names.end());
    for (const std::string& name : names)
        object.set(name, inOneForm(json.at(name)));
    return json.isList() ? list : json.isObject() ? object : json;
}

//! Of a record as the file has it, with what the file says of the rig and of the charts that the record's numbers are of.
std::string hashOf(const Json& record, const Json& file)
{
    Json hashed = Json::object(), charts = Json::array();
    for (const std::string& name : record.names())
        if (name != "sha256")
            hashed.set(name, record.at(name));
    for (int c : record.at("changes").asWholes())
        charts.append(file.at("charts").at((size_t)c));
    hashed.set("charts", charts);
    for (const char* const name : {"calibration_sha256", "window_serial"})
        hashed.set(name, file.at(name));
    return sha256Of(inOneForm(hashed).text(-1));
}

//! Where records are not as they were written.
std::vector<std::string> brokenLinks(const Json& file)
{
    std::vector<std::string> edited, later, broken;
    std::string before;
    for (const Json& record : file.at("checks").items())
    {
        const std::string hash = textOrNone(record, "sha256"), time = record.at("time").asText();
        if (hash.empty() || !textOrNone(record, CHAINED_LATER).empty())
            later.push_back(time);
        if (!hash.empty() && hash != hashOf(record, file))
            edited.push_back(time);
        if (!hash.empty() && textOrNone(record, "previous") != before)
            broken.push_back("what was before the check of " + time + " was deleted, or put elsewhere");
        before = hash;
    }
    if (!edited.empty())
        broken.insert(broken.begin(), (edited.size() == 1 ? "the check of " + edited[0] + " was edited"
            : format("%zu checks were edited, of %s to %s", edited.size(), edited.front().c_str(), edited.back().c_str()))
            + ", or what the file says of their charts and of the rig");
    if (textOrNone(file, "last") != before)
        broken.push_back("the last check was deleted");
    if (!later.empty())
        broken.push_back(format("%zu check%s, up to that of %s, had no SHA-256: of an older tool, or it was taken out, and nothing shows "
                                "whether they were edited", later.size(), later.size() == 1 ? "" : "s", later.back().c_str()));
    return broken;
}

CheckRecord checkOf(const Json& json, const std::vector<ChartedChange>& changes)
{
    CheckRecord check;
    check.time = parseTime(json.at("time").asText(), "time");
    check.verdict = json.at("verdict").asText();
    for (const Json& image : json.at("images").items())
        check.images.push_back({image.at("name").asText(), image.at("sha256").asText()});
    check.written = json;
    if (!textOrNone(json, "sha256").empty())
        for (const Json& image : json.at("shown").items())
            check.shown.push_back(shownOf(image));
    check.sigma = json.at("sigma_px").asNumber();
    check.dof = json.at("dof").asNumber();
    check.changes = json.at("changes").asWholes();
    Eigen::Index count = 0;
    for (int c : check.changes)
        count += changes.at(c).size();
    check.score = vectorOf(json.at("score"));
    if (check.score.size() != count || !(check.dof > 0.))
        throw Failure("numbers are missing");
    check.information = matrixOf(json.at("information"), count, count);
    const Json& byParameters = json.at("by_parameters");
    check.byParameters = matrixOf(byParameters, count, count ? (Eigen::Index)byParameters.at(0).items().size() : 0);
    return check;
}

CheckHistory historyOf(const Json& json)
{
    if (json.at("file").asText() != KIND)
        throw Failure("it is another file");
    CheckHistory history;
    history.calibration = json.at("calibration_sha256").asText();
    history.serial = json.at("window_serial").asText();
    for (const Json& change : json.at("charts").items())
        history.changes.push_back({change.at("name").asText(), change.at("unit").asText(),
                                   change.at("axes").asTexts(), change.at("factor").asNumber()});
    for (const ChartedChange& change : history.changes)
        if (change.axes.empty() || change.axes.size() > 3)
            throw Failure("the chart '" + change.name + "' has " + std::to_string(change.axes.size()) + " axes");
    for (const Json& check : json.at("checks").items())
    {
        history.checks.push_back(checkOf(check, history.changes));
        const size_t n = history.checks.size();
        if (n > 1 && history.checks[n - 1].time < history.checks[n - 2].time)
            throw Failure("its checks are not in the order of their times");
    }
    history.last = textOrNone(json, "last");
    history.broken = brokenLinks(json);
    return history;
}

//! The one of that name, added if it is new.
int indexOf(std::vector<ChartedChange>& changes, const Change& change)
{
    for (size_t i = 0; i < changes.size(); i++)
        if (changes[i].name == change.chart)
            return (int)i;
    changes.push_back({change.chart, change.quantities[0].unit, change.axes, change.chartFactor});
    return (int)changes.size() - 1;
}

} // namespace

CheckHistory readHistory(const std::string& filename)
{
    if (!std::filesystem::exists(filename))
        return {};
    std::string why;
    try
    {
        std::ifstream in(filename, std::ios::binary);
        return historyOf(Json::read(in));
    }
    catch (const Json::Error&)
    {
        why = "it is cut short or another file";
    }
    catch (const std::out_of_range&)
    {
        why = "numbers are missing";
    }
    catch (const Failure& e)
    {
        why = e.what();
    }
    throw Failure("'" + filename + "' is no history of checks: " + why + ". It must be what refract_check --history wrote; to begin a new "
                  "one, name a file that is not there");
}

void writeHistory(const std::string& filename, const CheckHistory& history)
{
    Json charts = Json::array(), checks = Json::array();
    for (const ChartedChange& change : history.changes)
        charts.append({{"name", change.name}, {"unit", change.unit}, {"axes", change.axes}, {"factor", change.factor}});
    Json file = {{"file", KIND}, {"calibration_sha256", history.calibration}, {"window_serial", history.serial}, {"charts", charts}};
    std::string last = history.last;
    for (const CheckRecord& check : history.checks)
    {
        Json record = check.written;        // what is there keeps what it says of itself, right or wrong
        if (textOrNone(record, "sha256").empty())
        {
            const bool isNew = !record.isObject();
            record = keptOf(history, check);
            if (!isNew)
                record.set(CHAINED_LATER, "yes");
            record.set("previous", last);
            last = hashOf(record, file);
            record.set("sha256", last);
        }
        checks.append(record);
    }
    file.set("checks", checks);
    file.set("last", last);
    writeText(filename, file.text(1) + '\n');
}

CheckRecord recordOf(const ChartedScore& score, const std::vector<std::string>& files, const std::string& time, CheckHistory& history,
                     const std::vector<CalibrationImage>& shown)
{
    CheckRecord check;
    check.time = time;
    for (const CalibrationImage& image : shown)
        check.shown.push_back(shownOf(jsonOf(image)));      // as it comes back
    for (const std::string& file : files)
        check.images.push_back({std::filesystem::path(file).filename().string(), sha256OfFile(file)});
    for (const Change& change : score.changes)
        check.changes.push_back(indexOf(history.changes, change));
    check.score = score.score;
    check.information = score.information;
    check.byParameters = score.byParameters;
    return check;
}

void requireSameRig(CheckHistory& history, const std::string& filename, const Calibration& calibration,
                    const std::string& calibrationFile)
{
    const std::string sha256 = sha256OfFile(calibrationFile), serial = calibration.label.serial;
    if (history.checks.empty())
    {
        history.calibration = sha256;
        history.serial = serial;
    }
    const auto named = [](const std::string& text) { return text.empty() ? "no serial number" : "the serial number '" + text + "'"; };
    if (serial != history.serial)
        throw Failure("the window of '" + calibrationFile + "' has " + named(serial) + ", that of '" + filename + "' "
                      + named(history.serial) + ": it is the history of another rig; give the one of this rig, or a new file");
    if (sha256 != history.calibration)
        throw Failure("'" + filename + "' is the history of another calibration than '" + calibrationFile + "', or that file was edited: "
                      "give the calibration that its checks were made with, or begin a new history, in a new file");
}

void requireNotCalibrated(const CheckRecord& check, const Calibration& calibration, double tolerance)
{
    const std::vector<CalibrationImage>& used = calibration.provenance.images;
    const std::string why = " calibrated, stored anew or cropped perhaps, or its target was not moved since: a check needs images of its "
                            "own";
    for (const CheckedImage& image : check.images)
        if (findImage(used, image.sha256))
            throw Failure("'" + image.name + "'" + why);
    for (const CalibrationImage& image : check.shown)
        if (findImage(used, image.camera, image.pixels, tolerance))
            throw Failure("'" + image.name + cv::format("' of camera %d", image.camera + 1) + why);
    const std::vector<std::string> moved = movedAlike(used, check.shown, tolerance);
    if (!moved.empty())
        throw Failure("'" + moved[0] + "'" + why);
}

void requireNew(const CheckHistory& history, const std::string& filename, const CheckRecord& check, double tolerance)
{
    if (history.checks.empty())
        return;
    const std::string last = history.checks.back().time;
    if (check.time < last)
        throw Failure("the last check of '" + filename + "' is of " + last + ", this one of " + check.time + ": time does not run "
                      "backwards; is the clock right? Give the time at which the images were taken (--date)");
    for (const CheckRecord& before : history.checks)
        for (const CalibrationImage& image : check.shown)
            if (const CalibrationImage* const old = findImage(before.shown, image.camera, image.pixels, tolerance))
                throw Failure("'" + image.name + cv::format("' of camera %d is in '", image.camera + 1) + filename + "' already, as '"
                              + old->name + "' of the check of " + before.time + ", stored anew or cropped perhaps: each check needs "
                              "images of its own. If the target stands where it stood then, say --fixed-target");
    for (const CheckRecord& before : history.checks)
    {
        const std::vector<std::string> moved = movedAlike(before.shown, check.shown, tolerance);
        if (!moved.empty())
            throw Failure("'" + moved[0] + "' and others show the target as images of the check of " + before.time + " do, all by as much "
                          "beside: resampled perhaps. Each check needs images of its own. If the target stands where it stood then, say "
                          "--fixed-target");
    }
    for (const CheckRecord& before : history.checks)
        for (const CheckedImage& old : before.images)
            for (const CheckedImage& image : check.images)
                if (image.sha256 == old.sha256)
                    throw Failure("'" + image.name + "' is in '" + filename + "' already, as '" + old.name + "' of the check of "
                                  + before.time + ": each check needs images of its own");
}

} // namespace tools
