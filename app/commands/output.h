#pragma once

#include <cstdio>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/base/file_stamp.h"
#include "app/commands/commands.h"
#include "core/base/result.h"

namespace app {

class WatchedFiles;

/// Writes a result to a file, or to standard output if `path` is empty. Replaces an existing file
/// only after the new one is completely on disk; on error the old one stays. Devices and pipes are
/// written directly; links are followed.
///
/// Errors: io, with the path.
core::Result<void> write_output(const std::string& path, const std::string& text);

/// The stamp of the file that this process last wrote at a path, taken right after writing; an
/// empty stamp if it wrote none.
FileStamp written_stamp(const std::string& path);

/// Refuses an output file that is one of the files `read`.
///
/// Errors: invalid_value, with the path.
core::Result<void> check_output(const std::string& output, std::initializer_list<std::string> read);

/// A result written piece by piece, to a file or to standard output, as by write_output. The old
/// file stays until finish succeeds.
class OutputStream {
public:
    OutputStream(OutputStream&&) noexcept;
    ~OutputStream();

    /// Errors: io, with the path.
    static core::Result<OutputStream> open(const std::string& path);

    core::Result<void> write(std::string_view text);

    /// Moves the finished file to its final path. Nothing may be written afterwards.
    core::Result<void> finish();

    /// Leaves the old file unchanged and copies the unfinished output to standard output, so that a
    /// file name never holds a partial result.
    core::Result<void> give_up();

private:
    struct State;
    explicit OutputStream(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// How text for people may look on a stream.
struct TerminalStyle {
    size_t width = 80;   // columns: those of the terminal or of COLUMNS; 80 if it is no terminal
    bool colour = false; // on a terminal, unless NO_COLOR is set
};

/// The style for `stream`.
TerminalStyle terminal_style(std::FILE* stream);

/// Prints to standard error, without control characters. Failures to write are ignored.
void print_error(const core::Error& error);
void print_note(const std::string& text);

/// Prints an error and returns the exit status for it.
ExitCode failed(const core::Error& error);

/// The output files of a watch. A file written by one pass describes that version of the inputs; it
/// is deleted if a later pass could not rewrite it.
class WatchOutputs {
public:
    explicit WatchOutputs(const std::vector<std::string>& paths);

    void begin_pass();

    /// Deletes the outputs that an earlier pass wrote and this one did not, and reports that. Files
    /// from before the watch, files changed since by another process and files that were read stay.
    void end_pass(const WatchedFiles& read);

private:
    struct Output {
        std::string path;
        FileStamp before = {}; // what we had written at the start of the pass
    };

    std::vector<Output> outputs_;
};

} // namespace app
