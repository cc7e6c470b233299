#include "gcode/language/program_folder.h"

#include <algorithm>
#include <system_error>

#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "gcode/language/lexer.h"

namespace gcode {

namespace fs = std::filesystem;

namespace {

std::optional<fs::path> found_in(const fs::path& folder, const std::string& name) {
    std::error_code error;
    const fs::path root = fs::canonical(folder, error);
    if (error) return std::nullopt;
    std::optional<fs::path> found;
    const fs::path exact = root / name;
    if (fs::is_regular_file(exact, error)) found = fs::canonical(exact, error);
    if (!found || error || found->parent_path() != root) return std::nullopt;
    return found;
}

} // namespace

std::optional<fs::path> file_in(const fs::path& folder, const std::string& name) {
    const std::optional<fs::path> path = found_in(folder, name);
    const std::string path_text = path ? path->string() : std::string();
    core::notify_file_access({core::FileAccessKind::in_folder, folder.generic_string(), name,
                              path ? std::optional<std::string_view>(path_text) : std::nullopt});
    return path;
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::error_code ignored;
    return names_in(folder, ignored);
}

std::vector<std::string> names_in(const fs::path& folder, std::error_code& failure) {
    std::vector<std::string> names = core::platform::names_in(folder, failure);
    std::sort(names.begin(), names.end());
    return names;
}

std::optional<std::string> name_in_any_case(std::span<const std::string> names,
                                            const std::string& wanted) {
    const auto same = [](char a, char b) { return upper(a) == b; };
    for (const std::string& name : names)
        if (std::equal(name.begin(), name.end(), wanted.begin(), wanted.end(), same)) return name;
    return std::nullopt;
}

} // namespace gcode
