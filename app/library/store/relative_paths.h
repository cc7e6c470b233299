#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "app/check/input_file.h"
#include "app/library/result/program_result.h"

namespace app {

struct CheckJob;

/// Paths relative to the folder of a database ("places"). They do not depend on the working folder,
/// and stay the same if the folder is moved with its contents. Links are not followed and `..` is
/// not resolved, except above the folder: a place leads to the same file as the original path, also
/// after links have changed. (A `.` is dropped even after a file.)
class RelativePaths {
public:
    /// For a database file: relative to its folder, or to the parent folder if that is `.feeler`.
    explicit RelativePaths(const std::string& database);

    /// The place of a path: relative if the path is in the folder or shares a parent with it,
    /// otherwise absolute; empty for an empty path.
    std::string relative(const std::string& path) const;

    /// The absolute path of a place.
    std::string absolute(const std::string& relative_path) const;

    /// Whether the name of the folder still leads to it, and the working folder is the same. If a
    /// link or folder has been replaced since, paths and places refer to different files.
    bool are_still_valid() const;

    /// The folder, with all links followed.
    const std::string& folder() const { return folder_; }

private:
    std::string working_folder_, named_folder_, folder_; // absolute; the second one as given
    std::array<FileStamp, 3> stamps_{};                  // of these three folders
};

/// A job with its paths replaced by places.
CheckJob with_relative_paths(const CheckJob& job, const RelativePaths& paths);

/// An access with paths replaced by places, and back.
InputFile with_relative_paths(InputFile input, const RelativePaths& paths);
InputFile with_absolute_paths(InputFile input, const RelativePaths& paths);

/// Whether any text of a result may contain the path of a file or folder of its check (as in the
/// job, as accessed, or any in `folder`), apart from the members for program and set-up. True if in
/// doubt: such a text is only correct for a job with the same paths.
bool quotes_paths(const ProgramResult& result, const CheckJob& job,
                  const std::vector<InputFile>& inputs, const std::string& folder);

/// The result with the paths of program and set-up replaced by those of the job.
ProgramResult renamed(ProgramResult result, const CheckJob& job);

} // namespace app
