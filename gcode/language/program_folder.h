#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace gcode {

/// The resolved path of a file in a folder; empty when there is no such file, or when it is a link
/// that leads out of the folder. File access observers are notified.
std::optional<std::filesystem::path> file_in(const std::filesystem::path& folder,
                                             const std::string& name);

/// The names of all entries of a folder, sorted; empty when it cannot be read.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// The names of all entries of a folder, sorted. If some could not be read, `failure` has the
/// reason.
std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& failure);

/// The first name that equals `wanted` regardless of case; `wanted` is in capitals.
std::optional<std::string> name_in_any_case(std::span<const std::string> names,
                                            const std::string& wanted);

} // namespace gcode
