#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace app::viewer {

/// Whether a path has the ending of a mesh, or of a set-up.
bool is_mesh_file(const std::string& path);
bool is_setup_file(const std::string& path);

/// The set-up and the files it names: meshes, and the machine with its own. They are found even
/// where the set-up cannot be read as a whole.
std::vector<std::string> files_of_setup(const std::string& setup);

/// Files that are looked at now and then, to see whether somebody has saved them again.
class FileWatch {
public:
    void set(std::vector<std::string> paths);

    /// Whether one of them has changed since the last time, and has rested since: a file that is
    /// still being written is not read.
    bool has_changed();
    /// The first that was there and is gone or empty, at rest as of the last look; or nothing.
    const std::string& missing() const { return missing_; }

private:
    struct Seen {
        std::string path;
        std::filesystem::file_time_type time = {};
        uintmax_t size = 0;

        bool operator==(const Seen&) const = default;
    };
    void look_for_missing(const std::vector<Seen>& now);
    static Seen look_at(const std::string& path);

    std::vector<Seen> known_, last_;
    std::string missing_;
};

} // namespace app::viewer
