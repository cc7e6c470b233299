#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <histedit.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "app/commands/interrupt.h"
#include "app/commands/line_reader.h"
#include "app/debug/debug_session.h"
#include "app/debug/prompt/prompt.h"

namespace app {

std::string_view line_editor() { return "libedit"; }
namespace {

constexpr int longest_history = 2000;
constexpr unsigned char end_of_input = 'D' - '@'; // Ctrl-D

/// The longest common prefix.
std::string common_beginning(const std::vector<std::string>& names) {
    std::string common = names.front();
    for (const std::string& name : names) {
        const auto end = std::mismatch(common.begin(), common.end(), name.begin(), name.end());
        common.erase(end.first, common.end());
    }
    return common;
}

} // namespace

struct LineReader::Editor {
    Editor(Prompt& its_prompt, DebugSession& its_session);
    Editor(const Editor&) = delete;
    Editor& operator=(const Editor&) = delete;
    ~Editor();

    /// The next byte of standard input: 1 if there is one, 0 at the end, -1 after an interrupt.
    int read(wchar_t& character);
    /// Completes the word before the cursor to the common prefix of all candidates, and lists them
    /// if that adds nothing.
    unsigned char complete();

    Prompt& prompt;
    DebugSession& session;
    EditLine* line = ::el_init("feeler", stdin, stdout, stderr);
    ::History* history = ::history_init();
};

namespace {

LineReader::Editor& editor_of(EditLine* line);

} // namespace

int LineReader::Editor::read(wchar_t& character) {
    constexpr double slice = 0.02;       // s: too short to notice
    constexpr int hurry = 0, rest = 100; // ms until the next slice
    bool goes_on = true;
    while (!was_interrupted()) {
        ::pollfd input{STDIN_FILENO, POLLIN, 0};
        if (::poll(&input, 1, goes_on ? hurry : rest) > 0) {
            unsigned char byte = 0;
            const ssize_t count = ::read(STDIN_FILENO, &byte, 1);
            if (count < 0) continue;
            // A Ctrl-D typed while a command runs arrives as 0 when the terminal changes its mode.
            character = byte == 0 ? end_of_input : byte;
            return static_cast<int>(count);
        }
        goes_on = session.record_for(slice);
    }
    return -1;
}

unsigned char LineReader::Editor::complete() {
    const LineInfo* info = ::el_line(line);
    const std::string before(info->buffer, info->cursor);
    const std::vector<std::string> names = prompt.completions(before);
    if (names.empty()) return CC_REFRESH_BEEP;
    const size_t blank = before.find_last_of(" \t");
    const size_t begun = before.size() - (blank == std::string::npos ? 0 : blank + 1);
    std::string whole = common_beginning(names);
    if (names.size() == 1) whole += ' ';
    if (whole.size() > begun) {
        ::el_insertstr(line, whole.substr(begun).c_str());
        return CC_REFRESH;
    }
    fmt::print("\n{}\n", fmt::join(names, "  "));
    return CC_REDISPLAY;
}

LineReader::Editor::Editor(Prompt& its_prompt, DebugSession& its_session)
    : prompt(its_prompt), session(its_session) {
    using Ask = char* (*)(EditLine*);
    using Complete = unsigned char (*)(EditLine*, int);
    const Ask ask = [](EditLine*) -> char* {
        static char text[] = "(feeler) ";
        return text;
    };
    const el_rfunc_t read_one = [](EditLine* asked, wchar_t* character) {
        return editor_of(asked).read(*character);
    };
    const Complete complete_one = [](EditLine* asked, int) { return editor_of(asked).complete(); };
    ::HistEvent event;
    ::history(history, &event, H_SETSIZE, longest_history);
    ::history(history, &event, H_SETUNIQUE, 1);
    ::el_set(line, EL_CLIENTDATA, this);
    ::el_set(line, EL_PROMPT, ask);
    ::el_set(line, EL_EDITOR, "emacs");
    // Without noflsh, Ctrl-C would discard the byte that poll just announced, and the read would
    // block until the next key.
    ::el_set(line, EL_SETTY, "-d", "+noflsh", nullptr);
    ::el_set(line, EL_HIST, ::history, history);
    ::el_set(line, EL_GETCFN, read_one);
    ::el_set(line, EL_ADDFN, "complete", "Complete the word", complete_one);
    ::el_set(line, EL_BIND, "^I", "complete", nullptr);
    ::el_set(line, EL_BIND, "^R", "em-inc-search-prev", nullptr);
}

LineReader::Editor::~Editor() {
    ::history_end(history);
    ::el_end(line);
}

namespace {

LineReader::Editor& editor_of(EditLine* line) {
    void* editor = nullptr;
    ::el_get(line, EL_CLIENTDATA, &editor);
    return *static_cast<LineReader::Editor*>(editor);
}

} // namespace

LineReader::LineReader(Prompt& prompt, DebugSession& session, std::string history_file)
    : history_file_(std::move(history_file)), editor_(std::make_unique<Editor>(prompt, session)) {
    ::HistEvent event;
    if (!history_file_.empty()) ::history(editor_->history, &event, H_LOAD, history_file_.c_str());
}

LineReader::~LineReader() {
    if (history_file_.empty()) return;
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(history_file_).parent_path(),
                                        ignored);
    ::HistEvent event;
    ::history(editor_->history, &event, H_SAVE, history_file_.c_str());
}

std::optional<std::string> LineReader::next() {
    while (true) {
        int length = 0;
        // el_gets would print the prompt before it sets the terminal mode: a Ctrl-D typed at once
        // would be lost.
        ::el_set(editor_->line, EL_PREP_TERM, 1);
        const char* read = ::el_gets(editor_->line, &length);
        if (was_interrupted()) {
            clear_interrupt();
            ::tcflush(STDIN_FILENO, TCIFLUSH);
            ::el_reset(editor_->line);
            fmt::print("\n");
            continue;
        }
        if (!read || length <= 0) return std::nullopt;
        std::string line(read, static_cast<size_t>(length));
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
        ::HistEvent event;
        if (!line.empty()) ::history(editor_->history, &event, H_ENTER, line.c_str());
        return line;
    }
}

} // namespace app
