#include "app/batch/input_files.h"

#include "app/session/digest.h"
#include "core/base/file_reads.h"
#include "gcode/program_folder.h"

namespace app {
namespace {

std::optional<std::string> place_of(const InputFile& input) {
    const auto found = gcode::file_in(input.path, input.name);
    return found ? std::optional(found->string()) : std::nullopt;
}

} // namespace

bool InputAnswers::is_same(const InputFile& input) {
    switch (input.question) {
    case core::FileQuestion::content:
        return input.answer && !input.answer->empty() && content_of(input.path) == *input.answer;
    case core::FileQuestion::presence:
        return core::presence_of(input.path) == input.answer;
    case core::FileQuestion::in_folder:
        return place_of(input) == input.answer;
    case core::FileQuestion::any_case:
        return name_in_any_case(input) == input.answer;
    case core::FileQuestion::listing:
        return false; // no check hangs on all the names in a folder
    }
    return false;
}

std::optional<std::string> InputAnswers::name_in_any_case(const InputFile& input) {
    auto name = gcode::name_in_any_case(names_of(input.path), input.name);
    core::note_look({input.question, input.path, input.name, name});
    return name;
}

void InputAnswers::forget() {
    const std::lock_guard lock(mutex_);
    contents_.clear();
    names_.clear();
}

std::string InputAnswers::content_of(const std::string& path) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto known = contents_.find(path); known != contents_.end()) return known->second;
    }
    const std::optional<std::string> bytes = core::file_bytes(path);
    std::string content = bytes ? sha256_of(*bytes) : std::string();
    const std::lock_guard lock(mutex_);
    return contents_.emplace(path, std::move(content)).first->second;
}

const std::vector<std::string>& InputAnswers::names_of(const std::string& folder) {
    const std::lock_guard lock(mutex_);
    const auto [found, is_new] = names_.try_emplace(folder);
    if (is_new) found->second = gcode::names_in(folder);
    return found->second;
}

} // namespace app
