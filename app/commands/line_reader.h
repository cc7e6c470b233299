#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/prompt/prompt.h"

namespace app {

/// Reads lines from a terminal, with history and completion. While nobody types, the session
/// records ahead.
class LineReader {
public:
    /// Reads the history of earlier sessions; without a file, there is none.
    LineReader(Prompt& prompt, DebugSession& session, std::string history_file);
    /// Writes the history.
    ~LineReader();
    LineReader(const LineReader&) = delete;
    LineReader& operator=(const LineReader&) = delete;

    /// The next line; an interrupt drops the line that is being written. Empty at the end.
    std::optional<std::string> next();

    struct Editor;

private:
    std::string history_file_;
    std::unique_ptr<Editor> editor_;
};

/// Where this user's history is kept; empty where there is no place for it.
std::string history_file();

} // namespace app
