#ifndef REFRACT_FUZZ_SCRATCH_HPP
#define REFRACT_FUZZ_SCRATCH_HPP

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

namespace fuzz {

//! A folder of this process's own, removed at the end.
class Scratch
{
public:
    Scratch()
    {
        std::string name = (std::filesystem::temp_directory_path() / "refract-fuzz-XXXXXX").string();
        if (!mkdtemp(&name[0]))
            throw std::runtime_error("cannot make a temporary folder");
        path_ = name;
    }
    ~Scratch()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    std::string write(const std::string& name, const std::string& content) const
    {
        const std::string path = (path_ / name).string();
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }

private:
    std::filesystem::path path_;
};

} // namespace fuzz

#endif // REFRACT_FUZZ_SCRATCH_HPP
