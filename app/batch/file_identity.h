#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace app {

/// Tells whether two paths are the same file by its name, however its folder is spelled.
class FileIdentities {
public:
    /// The same for `ok/a.nc`, `ok/../ok/a.nc` and `/lib/ok/a.nc`. Links to folders are followed; a
    /// link to a file is a file of its own, as another set-up may stand beside it.
    std::string of(const std::filesystem::path& path);

private:
    std::map<std::string, std::filesystem::path> folders_; // whole, by how they were spelled
};

} // namespace app
