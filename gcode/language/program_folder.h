#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace gcode {

/// The file in a folder with this name, resolved; empty when there is none, or when it is a link
/// that leads out of the folder. File access observers are notified.
std::optional<std::filesystem::path> file_in(const std::filesystem::path& folder,
                                             const std::string& name);

/// The names of all that is in a folder, sorted; none when it cannot be read.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// The same, and why they are not all.
std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& failure);

/// The first name that is called so in some case; `wanted` is in capitals.
std::optional<std::string> name_in_any_case(std::span<const std::string> names,
                                            const std::string& wanted);

} // namespace gcode
