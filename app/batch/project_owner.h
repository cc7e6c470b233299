#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace app {

/// Finds the project that has a say in a folder.
class ProjectOwners {
public:
    /// The project file in this folder, else in the nearest above it, no higher than `top`; empty
    /// when there is none. What has its name counts, be it a link that leads nowhere.
    std::string of(const std::filesystem::path& folder, const std::filesystem::path& top);

private:
    bool holds_project(const std::filesystem::path& folder);

    std::map<std::string, bool> known_; // folders
};

} // namespace app
