#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace app::viewer {

/// Whether the extension of a path is that of a mesh or a CAD file, or of a set-up. A FreeCAD
/// document counts as a job.
bool is_mesh_file(const std::string& path);
bool is_setup_file(const std::string& path);

/// Whether a file is a tool library, by its extension, or a machine: by its extension, or a TOML
/// file that describes axes.
bool is_tool_library(const std::string& path);
bool is_machine_file(const std::string& path);

/// Whether a file is a job of a CAM system, has offsets that a control has written, or configures
/// LinuxCNC, by its extension.
bool is_cam_job(const std::string& path);
bool is_offset_file(const std::string& path);
bool is_ini_file(const std::string& path);

/// Polls files for changes.
class FileWatch {
public:
    /// Polls these files from now on. Of those that were polled before, changes that have not been
    /// reported yet still count.
    void set(const std::vector<std::string>& paths);
    /// The present state of a file is no change: it has just been saved.
    void take_as_known(const std::string& path);

    /// Whether a file has changed and was then the same in two calls in a row, so that it is not
    /// read while it is being written.
    bool has_changed();
    /// The first file that existed and was deleted or empty in the last call; empty: none.
    const std::string& missing() const { return missing_; }

private:
    struct Seen {
        std::string path;
        std::filesystem::file_time_type time = {};
        uintmax_t size = 0;

        bool operator==(const Seen&) const = default;
    };
    void check_for_missing(const std::vector<Seen>& now);
    static Seen observe(const std::string& path);

    std::vector<Seen> known_, last_;
    std::string missing_;
};

} // namespace app::viewer
