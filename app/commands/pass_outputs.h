#pragma once

#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/batch/watched_files.h"

namespace app {

/// What the passes of a watch write. A file that one of them has written tells of that version: it
/// does not outlive a pass that could not write it anew.
class PassOutputs {
public:
    explicit PassOutputs(const std::vector<std::string>& paths);

    /// A pass begins.
    void begin_pass();

    /// It is over: takes away what it has not written but one before it has, and says so. What was
    /// there before the watch, what somebody else has written since, and what is read, stays.
    void end_pass(const WatchedFiles& read);

private:
    struct Output {
        std::string path;
        FileStamp before = {}; // as the last pass left it that wrote it
    };

    std::vector<Output> outputs_;
};

} // namespace app
