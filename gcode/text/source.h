#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// The lines of a file of any length, of which a few stretches are in memory at a time. Lines are
/// met in order or jumped to; what was left is read again.
///
/// The memory it needs is that of the windows and 16 bytes for each stretch of the file.
class LineWindows {
public:
    /// Errors: io when the file cannot be read. `window` is the size of a stretch in bytes.
    static core::Result<std::shared_ptr<LineWindows>> open(const std::string& path, size_t window);

    ~LineWindows();
    LineWindows(const LineWindows&) = delete;
    LineWindows& operator=(const LineWindows&) = delete;

    /// The text of a line, counted from 1, until the next call; empty after the last one.
    ///
    /// Errors: io when the file cannot be read or has changed; syntax, as read_program, when the
    /// part
    ///         read on the way is not an NC program.
    core::Result<std::optional<std::string_view>> line(size_t number);

private:
    struct Mark {
        uint64_t offset = 0;     // of a stretch in the file
        uint64_t first_line = 1; // counted from 1
    };
    struct Window {
        size_t stretch = 0;
        uint64_t first_line = 0;
        uint64_t last_use = 0; // 0: it holds nothing yet
        std::string text{};
        std::vector<uint32_t> starts{};

        bool holds(uint64_t number) const {
            return number >= first_line && number - first_line < starts.size();
        }
        std::string_view line(uint64_t number) const;
    };

    LineWindows(std::string path, int file, size_t size);

    core::Error refusal(core::ErrorCode code, std::string_view what, uint64_t line = 0) const;
    core::Result<void> go_to(uint64_t number);
    core::Result<void> load(size_t stretch);
    core::Result<bool> read_stretch(uint64_t offset, std::string& text) const;
    core::Result<void> check(const Window& window) const;
    core::Result<void> note_end(const Window& window, uint64_t offset, bool is_last);

    std::string path_;
    int file_;
    size_t size_;
    std::vector<Mark> marks_ = std::vector<Mark>(1); // of the stretches that were met
    std::optional<Mark> end_;                        // where the file ends, once that was met
    std::vector<Window> windows_;
    size_t current_ = 0; // the window that was used last
    uint64_t uses_ = 0;
    bool has_block_ = false;
};

/// The longest line that is read, in bytes.
constexpr size_t longest_line = 65536;

/// An NC program: as text with an index of its lines, or read in windows from its file. Keep it
/// where it is while blocks refer to it.
struct Program {
    std::string file; // as the user gave it; may be empty
    std::string text; // without a byte-order mark; empty when it is read in windows
    std::vector<uint32_t> line_starts;
    std::shared_ptr<LineWindows> windows{};

    /// Of a program that is not read in windows.
    size_t line_count() const { return line_starts.size(); }

    /// Errors: when it is read in windows, those of read_program, found on the way.
    core::Result<bool> has_line(size_t number) const;

    /// The text of a line that it has, counted from 1, without its line end. When it is read in
    /// windows the text is valid until the next line is requested.
    std::string_view line(size_t number) const;

    /// The same, or empty when there is no such line.
    ///
    /// Errors: as has_line.
    core::Result<std::optional<std::string_view>> find_line(size_t number) const;
};

/// The program in a file.
///
/// Errors: io when it cannot be read (missing, a directory, no permission); syntax when it is not
///         an NC program (empty, binary, a line longer than `longest_line`).
/// Cost:   reads in chunks and stops at the first error, so a huge file of one line is cheap to
/// refuse.
core::Result<Program> read_program(const std::string& path);

/// The program in a file, to be run from its beginning to its end: read in windows when it is long,
/// so that memory does not grow with it.
///
/// Errors: io and syntax as read_program, as far as they are in the first window; the others when
///         the line at fault is reached.
core::Result<Program> open_program(const std::string& path, size_t window = size_t(1) << 18);

/// The program in a text. `file` is the name that errors carry.
///
/// Errors: syntax, as read_program.
core::Result<Program> program_from_text(std::string_view text, std::string file = {});

} // namespace gcode
