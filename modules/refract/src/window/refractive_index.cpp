// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/materials.hpp"
#include <cctype>
#include <locale>
#include <numeric>
#include <sstream>

namespace cv { namespace refract {

namespace {

//! A material with the numbers that were given after its name.
struct NamedMaterial
{
    const Material* material;
    std::vector<double> values;
};

std::string lower(std::string text)
{
    for (char& c : text)
        c = (char)std::tolower((unsigned char)c);
    return text;
}

//! How many letters must change to make one of the other.
int editDistance(const std::string& a, const std::string& b)
{
    std::vector<int> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (size_t i = 0; i < a.size(); i++)
    {
        int diagonal = row[0];
        row[0] = (int)i + 1;
        for (size_t j = 0; j < b.size(); j++)
        {
            const int change = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({change, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

//! A slip of the finger, or the rest left out: so few letters that another word is not meant.
bool isNear(const std::string& typed, const std::string& known)
{
    const size_t LEAST_BEGINNING = 3;
    return editDistance(typed, known) <= (int)(typed.size() + 3)/4 ||
           (typed.size() >= LEAST_BEGINNING && known.compare(0, typed.size(), typed) == 0);
}

void failUnknown(const std::string& name)
{
    std::string near, names;
    for (const Material& m : materials())
    {
        names += (names.empty() ? "" : ", ") + std::string(m.name);
        for (const char* word : {m.name, m.otherName})
            if (word && isNear(lower(name), lower(word)))
                near += (near.empty() ? "" : ", ") + std::string("'") + word + "'";
    }
    CV_Error_(Error::StsBadArg, ("material is '%s', which is not known; %s%s%s", name.c_str(), near.empty() ? "those that are: " :
                                 "nearest is ", near.empty() ? names.c_str() : near.c_str(),
                                 near.empty() ? "; of any other give the index" : ""));
}

const Material& findMaterial(const std::string& name)
{
    for (const Material& m : materials())
        if (lower(name) == lower(m.name) || (m.otherName && lower(name) == lower(m.otherName)))
            return m;
    failUnknown(name);
    return materials()[0];
}

double readNumber(const std::string& whole, const std::string& text)
{
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());       // the user's may have a decimal comma
    double value;
    if (!(stream >> value) || stream.peek() != std::istringstream::traits_type::eof())
        CV_Error_(Error::StsBadArg, ("material is '%s'; '%s' is not a number", whole.c_str(), text.c_str()));
    return value;
}

//! One KEY=VALUE.
void readParameter(const std::string& whole, const std::string& text, NamedMaterial& named)
{
    const size_t equals = text.find('=');
    const std::string key = lower(text.substr(0, equals));
    const std::vector<MaterialParameter>& parameters = named.material->parameters;
    std::string keys;
    for (size_t i = 0; i < parameters.size(); i++)
    {
        const MaterialParameter& p = parameters[i];
        keys += std::string(i ? ", " : " but ") + p.key;
        if (equals == std::string::npos || key != lower(p.key))
            continue;
        const double value = readNumber(whole, text.substr(equals + 1));
        if (!(value >= p.least && value <= p.most))
            CV_Error_(Error::StsOutOfRange, ("material is '%s'; %s of %s must be from %g to %g", whole.c_str(), p.key,
                                             named.material->name, p.least, p.most));
        named.values[i] = value;
        return;
    }
    CV_Error_(Error::StsBadArg, ("material is '%s'; '%s' is no KEY=VALUE that %s has: it has none%s", whole.c_str(),
                                 text.c_str(), named.material->name, keys.c_str()));
}

NamedMaterial readMaterial(const std::string& text)
{
    const size_t colon = text.find(':');
    NamedMaterial named{&findMaterial(text.substr(0, colon)), {}};
    for (const MaterialParameter& p : named.material->parameters)
        named.values.push_back(p.usual);
    if (colon == std::string::npos)
        return named;
    for (size_t begin = colon; begin != std::string::npos; )
    {
        const size_t end = text.find(',', begin + 1);
        readParameter(text, text.substr(begin + 1, end == std::string::npos ? end : end - begin - 1), named);
        begin = end;
    }
    return named;
}

} // namespace

double refractiveIndex(const String& material, double wavelengthNm)
{
    const NamedMaterial named = readMaterial(material);
    const Material& m = *named.material;
    if (!(wavelengthNm >= m.shortest && wavelengthNm <= m.longest))
        CV_Error_(Error::StsOutOfRange, ("the index of %s is known from %g to %g nm; wavelengthNm is %g", m.name, m.shortest,
                                         m.longest, wavelengthNm));
    return m.index(wavelengthNm/1000., named.values);
}

double refractiveIndexTolerance(const String& material)
{
    return readMaterial(material).material->tolerance;
}

}} // namespace
