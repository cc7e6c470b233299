#include "app/library/store/input_files.h"

#include "app/base/sha256.h"
#include "core/base/file_reads.h"
#include "gcode/language/program_folder.h"

namespace app {
namespace {

std::optional<std::string> answer_of(const InputFile& input) {
    const auto found = gcode::file_in(input.path, input.name);
    return found ? std::optional(found->string()) : std::nullopt;
}

} // namespace

bool InputAnswers::is_same(const InputFile& input) {
    switch (input.question) {
    case core::FileAccessKind::content:
        return input.answer && !input.answer->empty() && content_of(input.path) == *input.answer;
    case core::FileAccessKind::presence:
        return core::presence_of(input.path) == input.answer;
    case core::FileAccessKind::in_folder:
        return answer_of(input) == input.answer;
    case core::FileAccessKind::any_case:
        return name_in_any_case(input) == input.answer;
    case core::FileAccessKind::listing:
    case core::FileAccessKind::kind:
        return false; // no result depends on these, only the choice of programs
    }
    return false;
}

std::optional<std::string> InputAnswers::name_in_any_case(const InputFile& input) {
    auto name = gcode::name_in_any_case(*names_of(input.path), input.name);
    core::notify_file_access({input.question, input.path, input.name, name});
    return name;
}

template <typename T, typename Read>
T InputAnswers::ask(std::map<std::string, Known<T>>& known, const std::string& path, Read&& read) {
    Known<T> now{.stamp = stamp_of(path)};
    now.was_fresh = may_change_unseen(now.stamp);
    {
        const std::lock_guard lock(mutex_);
        const auto found = known.find(path);
        if (found != known.end() && !found->second.was_fresh && found->second.stamp == now.stamp)
            return found->second.answer;
    }
    now.answer = read(path);
    const std::lock_guard lock(mutex_);
    return (known[path] = std::move(now)).answer;
}

std::string InputAnswers::content_of(const std::string& path) {
    core::notify_file_access({core::FileAccessKind::content, path, {}, {}});
    return ask(contents_, path, sha256_of_file);
}

InputAnswers::Names InputAnswers::names_of(const std::string& folder) {
    return ask(names_, folder, [](const std::string& path) {
        return std::make_shared<const std::vector<std::string>>(gcode::names_in(path));
    });
}

} // namespace app
