#include "gcode/program_library.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "gcode/lexer.h"

namespace gcode {
namespace {

namespace fs = std::filesystem;

constexpr size_t most_sources = 1000;

/// Whether a name names a file in a folder, and neither another folder nor the way out of it.
bool is_plain(const std::string& name) {
    return !name.empty() && name.find_first_of("/\\:") == std::string::npos && name != "."
           && name != ".." && name.find('\0') == std::string::npos;
}

/// The file in a folder with this name in any case, resolved; empty when there is none, or when it
/// is a link that leads out of the folder.
std::optional<fs::path> file_in(const fs::path& folder, const std::string& name) {
    std::error_code error;
    const fs::path root = fs::canonical(folder, error);
    if (error) return std::nullopt;
    std::optional<fs::path> found;
    const fs::path exact = root / name;
    if (fs::is_regular_file(exact, error)) found = fs::canonical(exact, error);
    if (!found || error || found->parent_path() != root) return std::nullopt;
    return found;
}

/// The first file in a folder, by name, that is called so in some case.
std::optional<std::string> name_in_any_case(const fs::path& folder, const std::string& wanted) {
    std::optional<std::string> found;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        std::string name = entry->path().filename().string();
        const auto same = [](char a, char b) { return upper(a) == b; };
        if (std::equal(name.begin(), name.end(), wanted.begin(), wanted.end(), same)
            && (!found || name < *found))
            found = std::move(name);
    }
    return found;
}

} // namespace

ProgramLibrary::ProgramLibrary(const Program& main, const Dialect& dialect,
                               std::vector<std::string> search_path)
    : dialect_(&dialect), search_path_(std::move(search_path)) {
    sources_.push_back({std::shared_ptr<const Program>(std::shared_ptr<void>(), &main), nullptr});
    if (search_path_.empty() && !main.file.empty()) {
        const fs::path folder = fs::path(main.file).parent_path();
        search_path_.push_back(folder.empty() ? "." : folder.string());
    }
}

const FlowIndex& ProgramLibrary::index(uint32_t source) {
    Source& entry = sources_[source];
    if (!entry.index)
        entry.index = std::make_unique<FlowIndex>(index_of(*entry.program, *dialect_));
    return *entry.index;
}

core::Result<std::optional<uint32_t>>
ProgramLibrary::find(const std::vector<std::string>& file_names) {
    for (const std::string& folder : search_path_) {
        for (const std::string& name : file_names) {
            if (!is_plain(name)) continue;
            const std::optional<fs::path> path = file_in(folder, name);
            if (!path) continue;
            if (const auto known = by_path_.find(path->string()); known != by_path_.end())
                return known->second;
            if (sources_.size() == most_sources)
                return core::fail(
                    core::ErrorCode::invalid_value,
                    fmt::format("the program calls more than {} files", most_sources));
            FEELER_TRY(Program program, read_program((fs::path(folder) / name).string()));
            sources_.push_back({std::make_shared<const Program>(std::move(program)), nullptr});
            const auto source = static_cast<uint32_t>(sources_.size() - 1);
            by_path_[path->string()] = source;
            return source;
        }
    }
    return std::nullopt;
}

core::Result<std::optional<uint32_t>>
ProgramLibrary::find_in_any_case(const std::vector<std::string>& file_names) {
    for (const std::string& folder : search_path_)
        for (const std::string& name : file_names)
            if (const auto actual = name_in_any_case(folder, name)) return find({*actual});
    return std::nullopt;
}

} // namespace gcode
