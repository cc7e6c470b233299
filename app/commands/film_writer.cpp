#include "app/commands/film_writer.h"

#include <array>
#include <cstdlib>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace app {
namespace {

/// Runs ffmpeg, without its talk; whether it is there and was content.
template <size_t count>
bool run_ffmpeg(const std::array<const char*, count>& words) {
    static_assert(count > 1);
    pid_t child = 0;
    if (::posix_spawnp(&child, "ffmpeg", nullptr, nullptr, const_cast<char* const*>(words.data()),
                       environ)
        != 0)
        return false;
    int status = 0;
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool has_ffmpeg() {
    return run_ffmpeg(std::array{"ffmpeg", "-loglevel", "quiet", "-f", "lavfi", "-i",
                                 "color=size=16x16:duration=0.1", "-f", "null", "-",
                                 static_cast<const char*>(nullptr)});
}

bool join(const std::string& pattern, const std::string& output) {
    const std::string rate = std::to_string(frames_per_second);
    return run_ffmpeg(std::array{"ffmpeg", "-y", "-loglevel", "error", "-framerate", rate.c_str(),
                                 "-i", pattern.c_str(), "-pix_fmt", "yuv420p", "-vf",
                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2", output.c_str(),
                                 static_cast<const char*>(nullptr)});
}

std::filesystem::path new_folder() {
    std::string name = std::filesystem::temp_directory_path() / "feeler-film-XXXXXX";
    return ::mkdtemp(name.data()) ? std::filesystem::path(name) : std::filesystem::path();
}

} // namespace

FilmWriter::FilmWriter(const std::string& output) : output_(output) {
    if (output_.extension() != ".png" && has_ffmpeg()) folder_ = new_folder();
}

FilmWriter::~FilmWriter() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

std::string FilmWriter::picture(size_t number) const {
    const std::string name = fmt::format("{}-{:04}.png", output_.stem().string(), number);
    return (folder_.empty() ? output_.parent_path() / name
                            : folder_ / fmt::format("{:04}.png", number))
        .string();
}

core::Result<void> FilmWriter::add(const render::Image& image) {
    return render::write_png(image, picture(++count_));
}

core::Result<std::string> FilmWriter::finish() {
    if (folder_.empty()) return fmt::format("{} to {}", picture(1), picture(count_));
    // With its extension, by which ffmpeg knows what to write, and beside what it takes the place
    // of.
    const std::filesystem::path unfinished =
        output_.parent_path() / (".unfinished-" + output_.filename().string());
    std::error_code failed;
    if (join(folder_ / "%04d.png", unfinished)) {
        std::filesystem::rename(unfinished, output_, failed);
        if (!failed) return std::string();
    }
    std::filesystem::remove(unfinished, failed);
    return core::fail(core::ErrorCode::io,
                      fmt::format("ffmpeg could not write the film {}: name another file, of a "
                                  "kind that it knows, such as .mp4",
                                  output_.string()));
}

} // namespace app
