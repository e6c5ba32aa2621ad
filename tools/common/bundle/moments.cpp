// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/moments.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "diagnose/plain_fit.hpp"
#include <algorithm>
#include <cmath>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MOST_LATE = 10;               // moments
const int FEWEST_POINTS = 20;           // that two cameras see
const double FAR_BETTER = 0.25;         // of what rays miss each other by: a start that is off bends it, by as much for all moments
const double APART_PX = 10.;            // less is the start's doing

//! The row of the same mark so many moments later; -1: there is none.
std::vector<int> rowsLater(const Matches& matches, int moments)
{
    std::map<std::string, int> order;
    std::vector<std::string> images;
    std::map<PointName, int> rows;
    for (size_t i = 0; i < matches.names.size(); i++)
    {
        if (order.insert({matches.names[i].image, (int)images.size()}).second)
            images.push_back(matches.names[i].image);
        rows[matches.names[i]] = (int)i;
    }
    std::vector<int> later;
    for (const PointName& name : matches.names)
    {
        const int moment = order[name.image] + moments;
        const auto row = moment < 0 || moment >= (int)images.size() ? rows.end() : rows.find({images[moment], name.id});
        later.push_back(row == rows.end() ? -1 : row->second);
    }
    return later;
}

//! What a camera saw so many moments later, in place of what it saw.
Matches shifted(const Matches& matches, int camera, int moments)
{
    Matches result = matches;
    const std::vector<int> rows = rowsLater(matches, moments);
    for (size_t i = 0; i < rows.size(); i++)
    {
        result.pixels[camera][i] = rows[i] < 0 ? Point2d(NAN, NAN) : matches.pixels[camera][rows[i]];
        if (!matches.stds.empty())
            result.stds[camera][i] = rows[i] < 0 ? NAN : matches.stds[camera][rows[i]];
    }
    return result;
}

std::string lateSentence(int camera, int late, const char* before, double asGiven, double moved)
{
    return format("the pixels of camera %d stand %d image(s) too far %s in the table: %s %.3g px, and by %.3g px if they are moved back. "
                  "Give pixels of one moment in one row", camera + 1, std::abs(late), late > 0 ? "down" : "up", before, asGiven, moved);
}

} // namespace

double missOf(const BundleStart& start, const RigPixels& pixels, int camera)
{
    Mat errors;
    const std::vector<Point3d> points = triangulate(start.rig, pixels, TRIANGULATE_MIDPOINT, errors);
    std::vector<double> missed;
    for (size_t i = 0; i < points.size(); i++)
    {
        int cameras = 0;
        double worst = 0.;
        for (int c = 0; c < errors.cols; c++)
            if (seen(pixels[c][i]))
            {
                const double error = errors.at<double>((int)i, c);
                worst = std::max(worst, std::isfinite(error) ? error : NO_FIT);
                cameras++;
            }
        if (cameras > 1 && seen(pixels[camera][i]))
            missed.push_back(worst);
    }
    return (int)missed.size() < FEWEST_POINTS ? NO_FIT : median(missed);
}

void requireSameMoments(const BundleStart& start, const Matches& matches)
{
    double best = NO_FIT, before = 0.;
    int camera = 0, late = 0;
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        const double asGiven = missOf(start, matches.pixels, c);
        for (int moments = -MOST_LATE; moments <= MOST_LATE && asGiven > APART_PX && asGiven < NO_FIT; moments++)
        {
            const double miss = moments ? missOf(start, shifted(matches, c, moments).pixels, c) : NO_FIT;
            if (miss < best)
                best = miss, before = asGiven, camera = c, late = moments;
        }
    }
    if (best < FAR_BETTER*before)
        throw Failure(lateSentence(camera, late, "the middling point's rays miss each other by", before, best));
}

bool isNoisy(double sigma, double knownSigma)
{
    const double SHARP = 0.25, NOISIER = 2.;        // px; of the known noise
    return !(sigma < (knownSigma > 0. ? NOISIER*knownSigma : SHARP));
}

std::string lateCamera(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust, double sigma)
{
    std::string sentence;
    double least = EXPLAINS*sigma;
    const auto attempt = [&](int camera, int late) {
        const Matches some = thinned(shifted(matches, camera, late), lengths);
        const double now = adjustBundle(start, some, lengths, robust, ENOUGH_ITERATIONS).fit.sigma;
        if (now < least)
        {
            least = now;
            sentence = lateSentence(camera, late, "the fit misses them by", sigma, now);
        }
        return now;
    };
    for (int c = 0; c < matches.cameraCount(); c++)
        for (int side : {-1, 1})
            try
            {
                double before = sigma;
                for (int moments = 1; moments <= MOST_LATE; moments++)
                {
                    const double now = attempt(c, side*moments);
                    if (!(now < before))
                        break;
                    before = now;
                }
            }
            catch (const Failure&)          // no fit, no explanation
            {
            }
    return sentence;
}

} // namespace tools
