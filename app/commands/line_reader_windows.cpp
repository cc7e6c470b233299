#define WIN32_LEAN_AND_MEAN
#include <windows.h>

// After windows.h.
#include <cstdio>
#include <filesystem>

#include "app/commands/interrupt.h"
#include "app/commands/line_reader.h"
#include "app/debug/debug_session.h"
#include "core/base/platform.h"

namespace app {

std::string_view line_editor() { return "the console"; }

/// The console edits the line and keeps the history of this session; there is no completion.
struct LineReader::Editor {
    DebugSession& session;
};

namespace {

/// Waits for a key or an interrupt. While the user is idle, the session records ahead.
void wait_for_key(HANDLE console, DebugSession& session) {
    constexpr double slice = 0.02;         // s: too short to notice
    constexpr DWORD hurry = 0, rest = 100; // ms until the next slice
    bool goes_on = true;
    while (!was_interrupted()
           && ::WaitForSingleObject(console, goes_on ? hurry : rest) == WAIT_TIMEOUT)
        goes_on = session.record_for(slice);
}

/// One line, with its line end. Empty: an interrupt, or the end of input, which has no error.
std::wstring read_line(HANDLE console) {
    std::wstring line(8192, L'\0');
    DWORD length = 0;
    ::SetLastError(ERROR_SUCCESS);
    if (!::ReadConsoleW(console, line.data(), static_cast<DWORD>(line.size()), &length, nullptr))
        length = 0;
    line.resize(length);
    return line;
}

} // namespace

LineReader::LineReader(Prompt&, DebugSession& session, std::string)
    : editor_(std::make_unique<Editor>(Editor{session})) {}

LineReader::~LineReader() = default;

std::optional<std::string> LineReader::next() {
    constexpr wchar_t end_of_input = L'Z' - L'@'; // Ctrl-Z
    const HANDLE console = ::GetStdHandle(STD_INPUT_HANDLE);
    while (true) {
        std::fputs("(feeler) ", stdout);
        std::fflush(stdout);
        wait_for_key(console, editor_->session);
        std::wstring line = was_interrupted() ? std::wstring() : read_line(console);
        // Ctrl-C ends a read with this error, maybe before its handler has run.
        if (was_interrupted() || ::GetLastError() == ERROR_OPERATION_ABORTED) {
            clear_interrupt();
            std::fputs("\n", stdout);
            continue;
        }
        if (line.empty() || line.starts_with(end_of_input)) return std::nullopt;
        while (!line.empty() && (line.back() == L'\n' || line.back() == L'\r')) line.pop_back();
        return std::filesystem::path(line).string();
    }
}

} // namespace app
