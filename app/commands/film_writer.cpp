#include "app/commands/film_writer.h"

#include <array>
#include <cstdlib>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace app {
namespace {

/// Runs ffmpeg, which neither reads what is typed nor writes what a script would read; whether it
/// is there and was content.
template <size_t count>
bool run_ffmpeg(const std::array<const char*, count>& words) {
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, "ffmpeg", &files, nullptr,
                                      const_cast<char* const*>(words.data()), environ);
    ::posix_spawn_file_actions_destroy(&files);
    int status = 0;
    return failed == 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status)
           && WEXITSTATUS(status) == 0;
}

bool has_ffmpeg() {
    return run_ffmpeg(
        std::array{"ffmpeg", "-loglevel", "quiet", "-version", static_cast<const char*>(nullptr)});
}

/// Whether ffmpeg can write a file of this name.
bool can_write(const std::string& output) {
    return run_ffmpeg(std::array{"ffmpeg", "-y", "-loglevel", "quiet", "-f", "lavfi", "-i",
                                 "color=size=64x64:duration=0.1", "-pix_fmt", "yuv420p",
                                 output.c_str(), static_cast<const char*>(nullptr)});
}

bool join(const std::string& pattern, const std::string& output) {
    const std::string rate = std::to_string(frames_per_second);
    return run_ffmpeg(std::array{"ffmpeg", "-y", "-loglevel", "error", "-framerate", rate.c_str(),
                                 "-i", pattern.c_str(), "-pix_fmt", "yuv420p", "-vf",
                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2", output.c_str(),
                                 static_cast<const char*>(nullptr)});
}

} // namespace

core::Result<std::unique_ptr<FilmWriter>> FilmWriter::open(const std::string& output) {
    std::unique_ptr<FilmWriter> writer(new FilmWriter(output));
    if (writer->output_.extension() == ".png" || !has_ffmpeg()) return writer;
    if (!can_write(writer->unfinished())) {
        std::error_code ignored;
        std::filesystem::remove(writer->unfinished(), ignored);
        return tl::unexpected(writer->refusal());
    }
    std::string folder = std::filesystem::temp_directory_path() / "feeler-film-XXXXXX";
    if (!::mkdtemp(folder.data()))
        return core::fail(core::ErrorCode::io, "no folder can be made for the film's pictures");
    writer->folder_ = folder;
    return writer;
}

FilmWriter::~FilmWriter() {
    std::error_code ignored;
    if (folder_.empty()) return;
    std::filesystem::remove(unfinished(), ignored);
    std::filesystem::remove_all(folder_, ignored);
}

core::Error FilmWriter::refusal() const {
    return {core::ErrorCode::io,
            {},
            fmt::format("ffmpeg cannot write the film {}: name a file that can be written, of a "
                        "kind that it knows, such as .mp4",
                        output_.string())};
}

std::string FilmWriter::unfinished() const {
    return output_.parent_path() / (".unfinished-" + output_.filename().string());
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
    if (!join(folder_ / "%04d.png", unfinished())) return tl::unexpected(refusal());
    std::error_code failed;
    std::filesystem::rename(unfinished(), output_, failed);
    if (failed) return tl::unexpected(refusal());
    return std::string();
}

} // namespace app
