#pragma once

#include <compare>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/file_reads.h"

namespace app {

/// A look at the disk that a check took, and so a thing its result hangs on: what a file holds, or
/// that there is none where one was looked for.
struct InputFile {
    core::FileQuestion question{};
    std::string path;                  // of the file, or of the folder that was searched
    std::string name;                  // that was looked for in the folder
    std::optional<std::string> answer; // of a content its SHA-256

    auto operator<=>(const InputFile&) const = default;
};

/// Collects all looks at the disk that are taken on this thread while it lives, each once. A file
/// that is read twice and changes in between is there twice.
class InputRecorder {
public:
    InputRecorder();

    std::vector<InputFile> inputs() const { return {inputs_.begin(), inputs_.end()}; }

private:
    void note(const core::FileAccess& look);

    std::set<InputFile> inputs_;
    core::FileAccessObserver listening_;
};

} // namespace app
