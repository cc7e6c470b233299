#pragma once

#include <set>
#include <vector>

#include "app/session/input_file.h"

namespace app {

/// Collects all looks at the disk that are taken on this thread while it lives, each once. A file
/// that is read twice and changes in between is there twice.
class InputRecorder {
public:
    InputRecorder();

    std::vector<InputFile> inputs() const { return {inputs_.begin(), inputs_.end()}; }

private:
    void note(const core::FileLook& look);

    std::set<InputFile> inputs_;
    core::FileListening listening_;
};

} // namespace app
