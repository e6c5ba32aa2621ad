// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/models.hpp"
#include <locale>
#include <sstream>

namespace cv { namespace refract {

namespace {

std::vector<String> wordsOf(const char* text)
{
    std::istringstream stream(text);
    std::vector<String> words;
    for (std::string word; stream >> word; )
        words.push_back(word);
    return words;
}

//! The model that a name is of; throws if there is none, or if it must be one of mrcal's and is not.
const LensModel& modelOf(const String& lensModel, bool mrcalOnly)
{
    String known;
    for (const LensModel& m : lensModels())
    {
        if (mrcalOnly && !m.isMrcal())
            continue;
        if (m.isNameOf(lensModel))
            return m;
        known += (known.empty() ? "" : ", ") + m.pattern();
    }
    CV_Error_(Error::StsBadArg, ("lensModel is %s; known are %s", lensModel.c_str(), known.c_str()));
}

//! The values in a model's name, in the order of its keys.
std::vector<double> valuesInName(const String& lensModel, const LensModel& model)
{
    std::istringstream rest(lensModel.substr(model.name.size()));
    rest.imbue(std::locale::classic());
    std::vector<double> values;
    for (const String& key : model.keys)
    {
        std::string text;
        double value = NAN;
        if (std::getline(rest, text, '=') && text == "_" + key && rest >> value)
            values.push_back(value);
    }
    if (values.size() != model.keys.size() || rest.peek() != std::char_traits<char>::eof())
        CV_Error_(Error::StsBadArg, ("lensModel is %s; its name must be %s", lensModel.c_str(), model.pattern().c_str()));
    return values;
}

} // namespace

std::vector<double> LensSpec::parameters() const
{
    std::vector<double> p = { cameraMatrix(0, 0), cameraMatrix(1, 1), cameraMatrix(0, 2), cameraMatrix(1, 2) };
    p.insert(p.end(), distCoeffs.begin(), distCoeffs.end());
    return p;
}

void LensSpec::requireCount(const std::vector<size_t>& allowed) const
{
    String counts;
    for (size_t i = 0; i < allowed.size(); i++)
    {
        if (allowed[i] == distCoeffs.size())
            return;
        counts += (i == 0 ? "" : i + 1 < allowed.size() ? ", " : " or ") + std::to_string(before + allowed[i]);
    }
    CV_Error_(Error::StsBadSize, ("%s has %d values; %s has %s", argument.c_str(), (int)(before + distCoeffs.size()),
                                  model.c_str(), counts.c_str()));
}

void LensSpec::requireNoSkew() const
{
    if (cameraMatrix(0, 1) != 0)
        CV_Error_(Error::StsBadArg, ("cameraMatrix(0, 1) is %g; this lens model has no skew", cameraMatrix(0, 1)));
}

String LensModel::pattern() const
{
    String text = name;
    for (const String& key : keys)
        text += "_" + key + "=...";
    return text;
}

bool LensModel::isNameOf(const String& lensModel) const
{
    const String start = keys.empty() ? name : name + "_" + keys[0] + "=";
    return keys.empty() ? lensModel == start : lensModel.compare(0, start.size(), start) == 0;
}

const std::vector<LensModel>& lensModels()
{
#define REFRACT_ROW(name, keys, maker, ...) { name, wordsOf(keys), maker, { __VA_ARGS__ } },
    static const std::vector<LensModel> models = { REFRACT_LENS_MODELS(REFRACT_ROW) };
#undef REFRACT_ROW
    return models;
}

Ptr<Lens> makeLens(const LensSpec& given)
{
    LensSpec spec = given;
    const LensModel& model = modelOf(spec.model, false);
    spec.inName = valuesInName(spec.model, model);
    if (!model.coefficients.empty())
        spec.requireCount(model.coefficients);
    return model.make(spec);
}

Ptr<Lens> makeLens(const String& model, const std::vector<double>& p)
{
    const size_t CORE = 4;
    if (p.size() < CORE)
        CV_Error_(Error::StsBadSize, ("intrinsics has %d values; it must have fx, fy, cx, cy and the coefficients of %s",
                                      (int)p.size(), model.c_str()));
    for (size_t i = 0; i < p.size(); i++)
        if (!std::isfinite(p[i]) || (i < 2 && !(p[i] > 0)))
            CV_Error_(Error::StsBadArg, ("intrinsics[%d] is %g; focal lengths must be positive, all finite", (int)i, p[i]));
    return makeLens({ model, Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1), std::vector<double>(p.begin() + CORE, p.end()),
                      "intrinsics", CORE });
}

Ptr<Lens> makeMrcalLens(const String& model, const std::vector<double>& intrinsics)
{
    modelOf(model, true);
    return makeLens(model, intrinsics);
}

String mrcalNameOf(const String& lensModel, size_t coefficients)
{
    const LensModel& model = modelOf(lensModel, false);
    if (model.isMrcal())
        return lensModel;
    for (const LensModel& m : lensModels())
        if (m.isMrcal() && m.make == model.make && m.coefficients == std::vector<size_t>(1, coefficients))
            return m.name;
    return String();
}

}} // namespace
