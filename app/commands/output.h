#pragma once

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

/// Writes a result to a file, or to standard output when `path` is empty. A file is replaced only
/// once all of the new one is on disk; the old one stays when something goes wrong. A device or
/// pipe is written to as it is, a link is followed.
///
/// Errors: io, with the path.
core::Result<void> write_output(const std::string& path, const std::string& text);

/// The stamp of the file that this process has written last at a path, as it left it; none where it
/// has written none.
FileStamp written_stamp(const std::string& path);

/// Refuses an output file that is one of the files that are read.
///
/// Errors: invalid_value, with the path.
core::Result<void> check_output(const std::string& output, std::initializer_list<std::string> read);

/// A result that is written piece by piece, to a file or to standard output, as write_output does.
/// The old file stays unless the new one is finished.
class OutputStream {
public:
    OutputStream(OutputStream&&) noexcept;
    ~OutputStream();

    /// Errors: io, with the path.
    static core::Result<OutputStream> open(const std::string& path);

    core::Result<void> write(std::string_view text);

    /// Puts everything written in its place. Nothing may be written after.
    core::Result<void> finish();

    /// Leaves the old file as it is. What was written for it goes to standard output, whole files
    /// only being what a name stands for.
    core::Result<void> give_up();

private:
    struct State;
    explicit OutputStream(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// Prints to standard error, without control characters; what cannot be written there is lost.
void print_error(const core::Error& error);
void print_note(const std::string& text);

/// Prints an error: what the command then ends with.
ExitCode failed(const core::Error& error);

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
