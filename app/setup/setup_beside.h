#pragma once

#include <string>

namespace app {

/// The name of the file that says what the programs of a folder are checked against.
constexpr const char* project_file_name = "feeler.toml";

/// The set-up that stands beside a program under its name, `plate.toml` for `plate.nc`; empty when
/// there is none. A project file is none. What has that name counts, also a link that leads nowhere
/// or a folder: whoever reads it then says so.
std::string setup_beside(const std::string& program);

} // namespace app
