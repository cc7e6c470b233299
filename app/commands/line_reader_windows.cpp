#define WIN32_LEAN_AND_MEAN
#include <windows.h>

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

/// Waits for a key. While the user is idle, the session records ahead.
void wait_for_key(HANDLE console, DebugSession& session) {
    constexpr double slice = 0.02;         // s: too short to notice
    constexpr DWORD hurry = 0, rest = 100; // ms until the next slice
    bool goes_on = true;
    while (::WaitForSingleObject(console, goes_on ? hurry : rest) == WAIT_TIMEOUT)
        goes_on = session.record_for(slice);
}

} // namespace

LineReader::LineReader(Prompt&, DebugSession& session, std::string)
    : editor_(std::make_unique<Editor>(Editor{session})) {}

LineReader::~LineReader() = default;

std::optional<std::string> LineReader::next() {
    constexpr DWORD longest = 8192;
    constexpr wchar_t end_of_input = L'Z' - L'@'; // Ctrl-Z
    const HANDLE console = ::GetStdHandle(STD_INPUT_HANDLE);
    while (true) {
        std::fputs("(feeler) ", stdout);
        std::fflush(stdout);
        wait_for_key(console, editor_->session);
        std::wstring line(longest, L'\0');
        DWORD length = 0;
        const bool is_read = ::ReadConsoleW(console, line.data(), longest, &length, nullptr) != 0;
        if (was_interrupted()) {
            clear_interrupt();
            std::fputs("\n", stdout);
            continue;
        }
        line.resize(is_read ? length : 0);
        while (!line.empty() && (line.back() == L'\n' || line.back() == L'\r')) line.pop_back();
        if (length == 0 || line.starts_with(end_of_input)) return std::nullopt;
        return std::filesystem::path(line).generic_string();
    }
}

} // namespace app
