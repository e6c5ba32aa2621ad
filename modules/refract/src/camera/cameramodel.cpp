// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "camera/cameramodel.hpp"
#include "camera/storage.hpp"
#include "lens/models.hpp"
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>

namespace cv { namespace refract {

namespace {

//! Recursive descent over the subset of Python literals that a .cameramodel uses.
class Parser
{
public:
    Parser(const std::string& text, const String& filename) : p_(text.c_str()), filename_(filename) {}

    CameraModel parse()
    {
        CameraModel model;
        std::vector<double> size, place(6, 0.);
        expect('{');
        while (!accept('}'))
        {
            const std::string key = string();
            expect(':');
            if (key == "lensmodel")
                model.lensModel = string();
            else if (key == "intrinsics")
                model.intrinsics = numbers();
            else if (key == "imagersize")
                size = numbers();
            else if (key == "extrinsics")
                place = numbers();
            else
                skip();
            if (!accept(','))
            {
                expect('}');
                break;
            }
        }
        if (model.lensModel.empty() || model.intrinsics.empty())
            fail("lensmodel or intrinsics is missing");
        for (double side : size)
            if (!(side >= 0 && side <= INT_MAX))
                fail("imagersize is not two numbers of pixels");
        if (size.size() == 2)
            model.imageSize = Size((int)size[0], (int)size[1]);
        if (place.size() != 6)
            fail("extrinsics are not six numbers");
        model.rvec = Vec3d(place.data());
        model.tvec = Vec3d(place.data() + 3);
        return model;
    }

private:
    void fail(const char* what) const
    {
        CV_Error_(Error::StsParseError, ("%s is not an mrcal .cameramodel: %s", filename_.c_str(), what));
    }

    void space()
    {
        for (;; p_++)
            if (*p_ == '#')
            {
                while (p_[1] && *p_ != '\n')
                    p_++;
            }
            else if (!*p_ || !std::isspace((unsigned char)*p_))
                return;
    }

    bool accept(char c)
    {
        space();
        if (*p_ != c)
            return false;
        p_++;
        return true;
    }

    void expect(char c)
    {
        if (!accept(c))
            fail(format(*p_ ? "'%c' expected" : "it ends where '%c' is expected", c).c_str());
    }

    std::string string()
    {
        space();
        if (*p_ == 'b')         // bytes
            p_++;
        const char quote = *p_;
        if (quote != '\'' && quote != '"')
            fail("a string is expected");
        const char* begin = ++p_;
        while (*p_ && *p_ != quote)
            p_ += *p_ == '\\' && p_[1] ? 2 : 1;
        if (!*p_)
            fail("a string does not end");
        return std::string(begin, p_++);
    }

    double number()
    {
        space();
        const char* begin = p_;
        while (*p_ && std::strchr("+-.0123456789eE", *p_))
            p_++;
        std::istringstream text(std::string(begin, p_));
        text.imbue(std::locale::classic());     // the user's may have a decimal comma
        double value;
        if (!(text >> value) || !text.eof())
            fail("a number is expected");
        return value;
    }

    std::vector<double> numbers()
    {
        std::vector<double> values;
        const char close = accept('(') ? ')' : (expect('['), ']');
        while (!accept(close))
        {
            values.push_back(number());
            if (!accept(','))
            {
                expect(close);
                break;
            }
        }
        return values;
    }

    //! Passes over any value: strings may hold anything, brackets nest.
    void skip()
    {
        int nesting = 0;
        for (space(); *p_; space())
        {
            if (nesting == 0 && (*p_ == ',' || *p_ == '}'))
                return;
            if (*p_ == '\'' || *p_ == '"')
            {
                string();
                continue;
            }
            if (*p_ == '[' || *p_ == '(' || *p_ == '{')
                nesting++;
            else if (*p_ == ']' || *p_ == ')' || *p_ == '}')
                nesting--;
            p_++;
        }
        fail("it ends within a value");
    }

    const char* p_;
    String filename_;
};

} // namespace

bool isCameraModel(const String& filename)
{
    const String suffix = ".cameramodel";
    return filename.size() > suffix.size() && filename.substr(filename.size() - suffix.size()) == suffix;
}

CameraModel readCameraModel(const String& filename)
{
    std::ifstream file(filename.c_str());
    if (!file)
        CV_Error_(Error::StsObjectNotFound, ("%s cannot be opened", filename.c_str()));
    std::stringstream text;
    text << file.rdbuf();
    return Parser(text.str(), filename).parse();
}

Ptr<RefractiveCamera> cameraFrom(const CameraModel& model)
{
    Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(model.lensModel, model.intrinsics);
    camera->setImageSize(model.imageSize);
    return camera;
}

static String mrcalName(const String& model, size_t coefficients, const String& filename)
{
    const String name = mrcalNameOf(model, coefficients);
    if (name.empty())
        CV_Error_(Error::StsBadArg, ("%s: mrcal has no lens %s with %d coefficients; save it as YAML", filename.c_str(),
                                     model.c_str(), (int)coefficients));
    return name;
}

CameraModel cameraModelOf(const RefractiveCamera& camera, const String& filename)
{
    const GlassWindow window = camera.window();
    if (!window.thickness.empty() || window.innerIndex != window.outerIndex)
        CV_Error_(Error::StsBadArg, ("%s: a .cameramodel cannot state a window; save it as YAML, or export it with "
                                     "refract_export --to=mrcal", filename.c_str()));
    if (camera.imageSize().empty())
        CV_Error_(Error::StsBadArg, ("%s: a .cameramodel states the image size; call setImageSize first", filename.c_str()));
    const Mat K = camera.cameraMatrix(), D = camera.distCoeffs();
    CameraModel model = { mrcalName(camera.lensModel(), D.total(), filename),
                          { K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2) },
                          camera.imageSize(), Vec3d(), Vec3d() };
    if (!D.empty())
        model.intrinsics.insert(model.intrinsics.end(), D.ptr<double>(), D.ptr<double>() + D.total());
    return model;
}

static std::string textOf(const CameraModel& model)
{
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(17);
    text << "{\n    'lensmodel':  '" << model.lensModel << "',\n\n"
         << "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n    'intrinsics': [ ";
    for (double value : model.intrinsics)
        text << value << ", ";
    text << "],\n\n    # extrinsics are rt_fromref\n    'extrinsics': [ ";
    for (const Vec3d& part : { model.rvec, model.tvec })
        text << part[0] << ", " << part[1] << ", " << part[2] << ", ";
    text << "],\n\n    'imagersize': [ " << model.imageSize.width << ", " << model.imageSize.height << " ]\n}\n";
    return text.str();
}

void saveCameraModel(const String& filename, const CameraModel& model)
{
    const std::string text = textOf(model);
    saveWhole(filename, [&](const String& path)
    {
        std::ofstream file(path.c_str());
        return (file << text).flush().good();
    });
}

}} // namespace
