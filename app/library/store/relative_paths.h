#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "app/check/input_file.h"
#include "app/library/result/program_result.h"

namespace app {

struct CheckJob;

/// Where files lie as seen from the folder that a database is for: the same from wherever one
/// calls, and wherever the folder is moved to with all that is in it. No link is followed and no
/// `..` taken back, but for those above the folder: from a place one comes to the very file that
/// whoever gave the path would have come to, also after links have changed. (A `.` counts as
/// nothing also behind a file.)
class RelativePaths {
public:
    /// Of a database in a file; `.feeler` is for the folder that it lies in.
    explicit RelativePaths(const std::string& database);

    /// Relative if the path leads into the folder or shares some of the way; empty if it is.
    std::string place_of(const std::string& path) const;

    /// An absolute path to a place.
    std::string path_of(const std::string& place) const;

    /// Whether the folder's name still leads to it, and the working folder is the same. Where a
    /// link was swapped or a folder renamed since, paths and places are those of different files.
    bool still_hold() const;

    /// The folder, with all links followed.
    const std::string& folder() const { return folder_; }

private:
    std::string working_folder_, named_folder_, folder_; // absolute; the second as it was given
    std::array<FileStamp, 3> stamps_{};                  // of all three
};

/// A job with places in place of paths.
CheckJob placed(const CheckJob& job, const RelativePaths& places);

/// A look with places in place of paths, and back.
InputFile placed(InputFile input, const RelativePaths& places);
InputFile asked_again(InputFile input, const RelativePaths& places);

/// Whether any text of a result may name a file or a folder of its check by its path, beside the
/// program and the set-up: as the job names them, as the check asked for them, or any in `folder`.
/// Rather yes than no: such a text is right only where the same paths are given.
bool quotes_paths(const ProgramResult& result, const CheckJob& job,
                  const std::vector<InputFile>& inputs, const std::string& folder);

/// The same result for the same job under other names of program and set-up.
ProgramResult renamed(ProgramResult result, const CheckJob& job);

} // namespace app
