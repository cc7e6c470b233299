#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace app::viewer {

/// A program with its set-up that is shipped to try Feeler out.
struct Sample {
    std::string program, setup; // paths
    std::string title, about;   // in words
};

/// The folder of the samples: beside the installed program, in an archive that was unpacked
/// anywhere, or in the source tree above the build. Empty if there is none.
std::filesystem::path samples_folder();

/// The samples in a folder that are complete.
std::vector<Sample> samples_in(const std::filesystem::path& folder);

/// The folder for files of the user: the documents if there is such a folder, else the home folder.
std::filesystem::path own_folder();

/// Whether a path is in a folder or below it; false for an empty folder.
bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder);

} // namespace app::viewer
