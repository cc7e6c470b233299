#include "gcode/exec/frame.h"

#include <filesystem>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/language.h"
#include "gcode/language/program_folder.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

namespace fs = std::filesystem;

constexpr size_t most_sources = 1000;

/// Whether a name is a plain file name that does not lead out of its folder.
bool is_plain(const std::string& name) {
    return !name.empty() && name.find_first_of("/\\:") == std::string::npos && name != "."
           && name != ".." && name.find('\0') == std::string::npos;
}

std::optional<std::string> found_in_any_case(const std::string& folder, const std::string& name) {
    const std::optional<std::string> actual = name_in_any_case(names_in(folder), name);
    core::notify_file_access({core::FileAccessKind::any_case, folder, name, actual});
    return actual;
}

} // namespace

ProgramLibrary::ProgramLibrary(const Program& main, const Dialect& dialect,
                               std::vector<std::string> search_path)
    : dialect_(&dialect), search_path_(std::move(search_path)) {
    sources_.push_back({std::shared_ptr<const Program>(std::shared_ptr<void>(), &main), nullptr});
    if (search_path_.empty() && !main.file.empty()) {
        const fs::path folder = fs::path(main.file).parent_path();
        search_path_.push_back(folder.empty() ? "." : folder.generic_string());
    }
}

ProgramLibrary::~ProgramLibrary() = default;

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
            FEELER_TRY(Program program, read_program((fs::path(folder) / name).generic_string()));
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
            if (const auto actual = found_in_any_case(folder, name)) return find({*actual});
    return std::nullopt;
}

} // namespace gcode
