#pragma once

#include <compare>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/file_reads.h"

namespace app {

/// A file access that affects the result of a check: the content of a file, or the fact that it
/// does not exist.
struct InputFile {
    core::FileQuestion question{};
    std::string path;                  // of the file, or of the folder that was searched
    std::string name;                  // name searched for in the folder
    std::optional<std::string> answer; // for content: its SHA-256

    auto operator<=>(const InputFile&) const = default;
};

/// Records each distinct file access of this thread while the object exists. A file that changes
/// between two reads is recorded twice.
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
