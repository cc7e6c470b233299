#include "app/view/model/unsaved_setup.h"

#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "core/base/file_reads.h"

namespace app::viewer {

using core::platform::FileLock;

namespace {

constexpr int most_files = 20; // of one program and set-up

constexpr std::string_view heading = "# A set-up with edits that were not saved.";
constexpr std::array<std::string_view, 3> labels = {"# program: ", "# set-up: ", "# of: "};

std::filesystem::path lock_of(std::filesystem::path file) {
    return file.replace_extension(".lock");
}

/// Takes a line off the beginning of a text; without its end.
std::string_view take_line(std::string_view& text) {
    const size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    return line;
}

} // namespace

std::string text_of(const UnsavedSetup& unsaved) {
    std::string text = std::string(heading) + "\n";
    const std::array<const std::string*, 3> values = {&unsaved.program, &unsaved.setup,
                                                      &unsaved.base};
    for (size_t i = 0; i < labels.size(); ++i) text += std::string(labels[i]) + *values[i] + "\n";
    return text + unsaved.text;
}

std::optional<UnsavedSetup> unsaved_in(const std::string& text) {
    std::string_view rest = text;
    if (take_line(rest) != heading) return std::nullopt;
    UnsavedSetup unsaved;
    const std::array<std::string*, 3> values = {&unsaved.program, &unsaved.setup, &unsaved.base};
    for (size_t i = 0; i < labels.size(); ++i) {
        const std::string_view line = take_line(rest);
        if (!line.starts_with(labels[i])) return std::nullopt;
        *values[i] = line.substr(labels[i].size());
    }
    unsaved.text = rest;
    return unsaved;
}

std::filesystem::path UnsavedSetups::file_of(const std::string& program, const std::string& setup,
                                             int number) const {
    const std::string key = sha256_of(absolute_path(program) + "\n" + absolute_path(setup));
    return folder_ / fmt::format("{}-{}.toml", key.substr(0, 24), number);
}

UnsavedSetups::File UnsavedSetups::free_file(const std::string& program,
                                             const std::string& setup) const {
    if (folder_.empty()) return {};
    std::error_code ignored; // taking the lock fails then
    std::filesystem::create_directories(folder_, ignored);
    for (int number = 1; number < most_files; ++number) {
        File file{file_of(program, setup, number), {}};
        bool is_held = false;
        file.lock = FileLock::take(lock_of(file.path), is_held);
        if (!is_held && !core::is_there(file.path)) return file;
    }
    return {file_of(program, setup, most_files), {}};
}

bool UnsavedSetups::keep(const std::filesystem::path& file, const std::string& program,
                         const std::string& setup, const std::string& text,
                         const std::string& saved) const {
    if (folder_.empty() || !write_) return false;
    const UnsavedSetup kept{absolute_path(program), absolute_path(setup), text, sha256_of(saved)};
    return write_(file.generic_string(), text_of(kept)).has_value();
}

void UnsavedSetups::forget(const std::filesystem::path& file) {
    std::error_code ignored; // it may not be there
    if (!file.empty()) std::filesystem::remove(file, ignored);
}

std::vector<UnsavedSetup> UnsavedSetups::find(const std::string& program, const std::string& setup,
                                              const std::string& saved) const {
    if (folder_.empty()) return {};
    std::multimap<std::filesystem::file_time_type, UnsavedSetup> by_time;
    for (int number = 1; number <= most_files; ++number) {
        const std::filesystem::path file = file_of(program, setup, number);
        const auto bytes = core::file_bytes(file);
        auto unsaved = bytes ? unsaved_in(*bytes) : std::nullopt;
        if (!unsaved || unsaved->text == saved) continue;
        bool is_held = false;
        FileLock::take(lock_of(file), is_held);
        if (is_held) continue; // another window is open
        unsaved->file = file;
        std::error_code ignored; // it is taken for an old one
        by_time.emplace(std::filesystem::last_write_time(file, ignored), *std::move(unsaved));
    }
    std::vector<UnsavedSetup> found;
    for (auto& [time, unsaved] : by_time) found.push_back(std::move(unsaved));
    return found;
}

} // namespace app::viewer
