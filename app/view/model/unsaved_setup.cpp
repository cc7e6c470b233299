#include "app/view/model/unsaved_setup.h"

#include <array>
#include <utility>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "core/base/file_reads.h"

namespace app::viewer {
namespace {

constexpr std::string_view heading = "# A set-up with edits that were not saved.";
constexpr std::array<std::string_view, 3> labels = {"# program: ", "# set-up: ", "# of: "};

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

std::filesystem::path UnsavedSetups::file_of(const std::string& program,
                                             const std::string& setup) const {
    return folder_
           / (sha256_of(absolute_path(program) + "\n" + absolute_path(setup)).substr(0, 24)
              + ".toml");
}

void UnsavedSetups::keep(const std::string& program, const std::string& setup,
                         const std::string& text, const std::string& saved) const {
    if (folder_.empty() || !write_) return;
    std::error_code ignored; // writing the file fails then
    std::filesystem::create_directories(folder_, ignored);
    static_cast<void>(
        write_(file_of(program, setup).generic_string(),
               text_of({absolute_path(program), absolute_path(setup), text, sha256_of(saved)})));
}

void UnsavedSetups::forget(const std::string& program, const std::string& setup) const {
    std::error_code ignored; // it may not be there
    if (!folder_.empty()) std::filesystem::remove(file_of(program, setup), ignored);
}

std::optional<UnsavedSetup> UnsavedSetups::find(const std::string& program,
                                                const std::string& setup,
                                                const std::string& saved) const {
    if (folder_.empty()) return std::nullopt;
    const auto bytes = core::file_bytes(file_of(program, setup));
    auto unsaved = bytes ? unsaved_in(*bytes) : std::nullopt;
    if (!unsaved || unsaved->text == saved) return std::nullopt;
    return unsaved;
}

} // namespace app::viewer
