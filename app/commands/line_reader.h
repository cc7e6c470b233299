#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace app {

class DebugSession;
class Prompt;

/// What edits lines on this system, for --version.
std::string_view line_editor();

/// Reads lines from a terminal, with history and completion. While the user is idle, the session
/// records ahead.
class LineReader {
public:
    /// Loads the history of earlier sessions; an empty `history_file` means no history.
    LineReader(Prompt& prompt, DebugSession& session, std::string history_file);
    /// Saves the history.
    ~LineReader();
    LineReader(const LineReader&) = delete;
    LineReader& operator=(const LineReader&) = delete;

    /// The next line; an interrupt discards the line being typed. Empty at end of input.
    std::optional<std::string> next();

    struct Editor;

private:
    std::string history_file_;
    std::unique_ptr<Editor> editor_;
};

} // namespace app
