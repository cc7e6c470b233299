#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace core::platform {
class RandomAccessFile;
}

namespace gcode {

/// The lines of a file of any length. Only a few chunks are in memory at a time. Lines can be read
/// in any order; chunks that were dropped are read again.
///
/// Memory: the windows, and 16 bytes for each chunk of the file.
class LineWindows {
public:
    /// Errors: io when the file cannot be read. `window` is the size of a chunk in bytes.
    static core::Result<std::shared_ptr<LineWindows>> open(const std::string& path, size_t window);

    ~LineWindows();
    LineWindows(const LineWindows&) = delete;
    LineWindows& operator=(const LineWindows&) = delete;

    /// The text of a line, counted from 1; empty after the last line. Valid until the next call.
    ///
    /// Errors: io when the file cannot be read or has changed; syntax, as read_program, when a part
    ///         read on the way is not an NC program.
    core::Result<std::optional<std::string_view>> line(size_t number);

private:
    struct Mark {
        uint64_t offset = 0;     // of a chunk in the file
        uint64_t first_line = 1; // counted from 1
    };
    struct Window {
        size_t stretch = 0;
        uint64_t first_line = 0;
        uint64_t last_use = 0; // 0: the window is empty
        std::string text{};
        std::vector<uint32_t> starts{};

        bool holds(uint64_t number) const {
            return number >= first_line && number - first_line < starts.size();
        }
        std::string_view line(uint64_t number) const;
    };

    LineWindows(std::string path, core::platform::RandomAccessFile&& file, size_t size);

    core::Error refusal(core::ErrorCode code, std::string_view what, uint64_t line = 0) const;
    core::Result<void> go_to(uint64_t number);
    core::Result<void> load(size_t stretch);
    core::Result<bool> read_stretch(uint64_t offset, std::string& text) const;
    core::Result<void> check(const Window& window) const;
    core::Result<void> note_end(const Window& window, uint64_t offset, bool is_last);

    std::string path_;
    std::unique_ptr<const core::platform::RandomAccessFile> file_;
    size_t size_;
    std::vector<Mark> marks_ = std::vector<Mark>(1); // of the chunks read so far
    std::optional<Mark> end_;                        // end of the file, once it was reached
    std::vector<Window> windows_;
    size_t current_ = 0; // the most recently used window
    uint64_t uses_ = 0;
    bool has_block_ = false;
};

/// The longest line that is accepted, in bytes.
constexpr size_t longest_line = 65536;

/// An NC program: its whole text with an index of its lines, or windows on its file. Do not move it
/// while blocks refer to it.
struct Program {
    std::string file; // as the user gave it; may be empty
    std::string text; // without a byte-order mark; empty when it is read in windows
    std::vector<uint32_t> line_starts;
    std::shared_ptr<LineWindows> windows{};

    /// Only for programs that are not read in windows.
    size_t line_count() const { return line_starts.size(); }

    /// Errors: for a program read in windows, those of read_program, found on the way.
    core::Result<bool> has_line(size_t number) const;

    /// The text of an existing line, counted from 1, without its line end. In a program read in
    /// windows, it is valid until the next line is requested.
    std::string_view line(size_t number) const;

    /// The text of a line, as `line`, or empty when there is no such line.
    ///
    /// Errors: as has_line.
    core::Result<std::optional<std::string_view>> find_line(size_t number) const;
};

/// Reads a program from a file.
///
/// Errors: io when it cannot be read (missing, a directory, no permission); syntax when it is not
///         an NC program (empty, binary, a line longer than `longest_line`).
/// Cost: reads in chunks and stops at the first error, so refusing a huge file of one line is
///       cheap.
core::Result<Program> read_program(const std::string& path);

/// Opens a program to be run from start to end. A long program is read in windows, so that memory
/// does not grow with its length.
///
/// Errors: io and syntax as read_program, if they occur in the first window; later ones when the
///         faulty line is reached.
core::Result<Program> open_program(const std::string& path, size_t window = size_t(1) << 18);

/// Makes a program from a text, for callers of the library that have no file. `file` is the name
/// used in errors.
///
/// Errors: syntax, as read_program.
core::Result<Program> program_from_text(std::string_view text, std::string file = {});

} // namespace gcode
