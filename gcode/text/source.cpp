#include "gcode/text/source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "gcode/text/program_text.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Enough for a loop across the border of two chunks that calls subprograms elsewhere.
constexpr size_t window_count = 4;

/// Length of the complete lines of a text: up to and including its last line end. A CR at the very
/// end may be the first half of CR LF.
size_t whole_lines(std::string_view text) {
    if (text.ends_with('\r')) text.remove_suffix(1);
    const size_t last = text.find_last_of("\r\n");
    return last == std::string_view::npos ? 0 : last + 1;
}

} // namespace

std::string_view LineWindows::Window::line(uint64_t number) const {
    const auto at = static_cast<size_t>(number - first_line);
    const size_t end = at + 1 < starts.size() ? starts[at + 1] : text.size();
    return without_line_end(std::string_view(text).substr(starts[at], end - starts[at]));
}

LineWindows::LineWindows(std::string path, core::platform::RandomAccessFile&& file, size_t size)
    : path_(std::move(path)),
      file_(std::make_unique<core::platform::RandomAccessFile>(std::move(file))),
      size_(size),
      windows_(window_count) {}

LineWindows::~LineWindows() = default;

core::Error LineWindows::refusal(ErrorCode code, std::string_view what, uint64_t line) const {
    return {code, {.line = static_cast<uint32_t>(line)}, fmt::format("{} {}", path_, what), path_};
}

core::Result<std::shared_ptr<LineWindows>> LineWindows::open(const std::string& path,
                                                             size_t window) {
    std::error_code failure;
    auto file = core::platform::RandomAccessFile::open(path, failure);
    if (!file)
        return core::fail(ErrorCode::io,
                          fmt::format("cannot read {}: {}", path, failure.message()));
    return std::shared_ptr<LineWindows>(new LineWindows(path, std::move(*file), window));
}

core::Result<std::optional<std::string_view>> LineWindows::line(size_t number) {
    if (number == 0) return std::nullopt;
    if (!windows_[current_].holds(number)) {
        if (auto there = go_to(number); !there) return tl::unexpected(std::move(there).error());
        if (!windows_[current_].holds(number)) return std::nullopt;
    }
    return windows_[current_].line(number);
}

/// Makes the window that contains a line the current one, if the line exists.
core::Result<void> LineWindows::go_to(uint64_t number) {
    if (end_ && number >= end_->first_line) return {};
    for (size_t i = 0; i < windows_.size(); ++i) {
        if (windows_[i].last_use == 0 || !windows_[i].holds(number)) continue;
        current_ = i;
        windows_[i].last_use = ++uses_;
        return {};
    }
    auto after =
        std::upper_bound(marks_.begin(), marks_.end(), number,
                         [](uint64_t line, const Mark& mark) { return line < mark.first_line; });
    auto stretch = static_cast<size_t>(after - marks_.begin()) - 1;
    while (true) {
        if (auto loaded = load(stretch); !loaded) return loaded;
        if (windows_[current_].holds(number) || ++stretch >= marks_.size()) return {};
    }
}

/// Reads complete lines from an offset on. Returns whether the end of the file was reached.
core::Result<bool> LineWindows::read_stretch(uint64_t offset, std::string& text) const {
    text.clear();
    while (true) {
        const size_t wanted = text.size() + size_;
        bool at_end = false;
        while (text.size() < wanted && !at_end) {
            const size_t before = text.size();
            text.resize(wanted);
            const auto count = file_->read(text.data() + before, wanted - before, offset + before);
            text.resize(before + count.value_or(0));
            if (!count)
                return tl::unexpected(
                    refusal(ErrorCode::io, "cannot be read: the file system reports an error"));
            at_end = *count == 0;
        }
        if (at_end) return true;
        const size_t whole = whole_lines(text);
        if (whole == 0 && text.size() <= longest_line) continue;
        if (whole > 0) text.resize(whole);
        return false;
    }
}

/// Checks that a chunk can belong to an NC program.
core::Result<void> LineWindows::check(const Window& window) const {
    const std::string_view text = window.text;
    for (size_t i = 0; i < window.starts.size(); ++i) {
        const size_t end = i + 1 < window.starts.size() ? window.starts[i + 1] : text.size();
        if (end - window.starts[i] <= longest_line) continue;
        const uint64_t line = window.first_line + i;
        if (window.line(line).size() > longest_line)
            return tl::unexpected(refusal(
                ErrorCode::syntax,
                fmt::format("has more than {1} characters in line {0}; split it into blocks", line,
                            longest_line),
                line));
    }
    if (const size_t nul = text.find('\0'); nul != std::string_view::npos) {
        const auto after = std::upper_bound(window.starts.begin(), window.starts.end(), nul);
        return tl::unexpected(
            refusal(ErrorCode::syntax, nul_bytes_error(text),
                    window.first_line + static_cast<uint64_t>(after - window.starts.begin()) - 1));
    }
    // With the program as a whole, this depends on the control (gcode/exec/interpreter.cpp).
    if (const auto at = lone_return(text)) {
        const auto after = std::upper_bound(window.starts.begin(), window.starts.end(), *at);
        return tl::unexpected(
            refusal(ErrorCode::syntax,
                    "has a carriage return without a line feed, where a control may read on in the "
                    "same line; save it with the same end of line everywhere",
                    window.first_line + static_cast<uint64_t>(after - window.starts.begin()) - 1));
    }
    const size_t controls = count_stray_controls(text);
    if (looks_binary(controls, window.text.size()))
        return tl::unexpected(
            refusal(ErrorCode::syntax, "is a binary file, not an NC program", window.first_line));
    return {};
}

/// Stores where a chunk ends, or checks that it still ends at the stored position.
core::Result<void> LineWindows::note_end(const Window& window, uint64_t offset, bool is_last) {
    const Mark after{offset, window.first_line + window.starts.size()};
    if (after.first_line > std::numeric_limits<uint32_t>::max())
        return tl::unexpected(refusal(ErrorCode::syntax, "has too many lines"));
    const bool is_known = window.stretch + 1 < marks_.size() || end_;
    if (!is_known) {
        if (is_last && !has_block_)
            return tl::unexpected(
                refusal(ErrorCode::syntax, "has no blocks: there is nothing to run"));
        if (is_last)
            end_ = after;
        else
            marks_.push_back(after);
        return {};
    }
    const bool was_last = window.stretch + 1 == marks_.size();
    const Mark& known = was_last ? *end_ : marks_[window.stretch + 1];
    if (was_last == is_last && known.offset == after.offset && known.first_line == after.first_line)
        return {};
    return tl::unexpected(refusal(ErrorCode::io, "changed while it was being read"));
}

/// Reads a chunk into the least recently used window.
core::Result<void> LineWindows::load(size_t stretch) {
    Window& window =
        *std::min_element(windows_.begin(), windows_.end(),
                          [](const Window& a, const Window& b) { return a.last_use < b.last_use; });
    current_ = static_cast<size_t>(&window - windows_.data());
    window.last_use = 0;
    window.starts.clear();
    const Mark mark = marks_[stretch];
    FEELER_TRY(const bool is_last, read_stretch(mark.offset, window.text));
    const uint64_t end = mark.offset + window.text.size();
    if (mark.offset == 0 && window.text.starts_with(byte_order_mark))
        window.text.erase(0, byte_order_mark.size());
    window.stretch = stretch;
    window.first_line = mark.first_line;
    window.starts = starts_of_lines(window.text);
    auto good = check(window);
    has_block_ = has_block_ || (good && has_a_block(window.text));
    if (good) good = note_end(window, end, is_last);
    if (!good) {
        window.starts.clear();
        return good;
    }
    window.last_use = ++uses_;
    return {};
}

namespace {

using core::Error;

constexpr size_t chunk_size = 65536;
constexpr size_t longest_program = size_t(1) << 30;

/// Collects a text piece by piece. Fails as soon as the text cannot be an NC program.
class Collector {
public:
    explicit Collector(std::string file) { program_.file = std::move(file); }

    std::optional<Error> add(std::string_view text) {
        for (size_t at = 0; at < text.size(); at += chunk_size)
            if (auto error = add_piece(text.substr(at, chunk_size))) return error;
        return std::nullopt;
    }

    /// The bytes of the whole file.
    std::string_view text() const { return program_.text; }

    core::Result<Program> finish() &&;

private:
    std::optional<Error> add_piece(std::string_view piece);
    void strip_byte_order_mark();

    Error refusal(std::string_view what, size_t line) const {
        const std::string name = program_.file.empty() ? "the program" : program_.file;
        return {ErrorCode::syntax,
                {.line = static_cast<uint32_t>(line)},
                fmt::format("{} {}", name, what),
                program_.file};
    }

    Program program_;
    size_t line_length_ = 0; // of the last line, so far
    size_t controls_ = 0;
};

std::optional<Error> Collector::add_piece(std::string_view piece) {
    // A line that is too long spans at least one whole piece, so it is enough to look at the first
    // line end of each piece.
    static_assert(chunk_size <= longest_line);
    if (program_.text.size() + piece.size() > longest_program)
        return refusal("is longer than 1 GiB; split it into several programs", 0);
    const size_t nul = piece.find('\0');
    if (nul != std::string_view::npos) piece = piece.substr(0, nul);
    const size_t first_end = std::min(piece.find_first_of("\r\n"), piece.size());
    program_.text += piece.substr(0, first_end);
    if (line_length_ + first_end > longest_line) {
        const size_t line = starts_of_lines(program_.text).size();
        return refusal(fmt::format("has more than {1} characters in line {0}; split it into blocks",
                                   line, longest_line),
                       line);
    }
    program_.text += piece.substr(first_end);
    if (nul != std::string_view::npos)
        return refusal(nul_bytes_error(program_.text), starts_of_lines(program_.text + ' ').size());
    const size_t last_end = piece.find_last_of("\r\n");
    line_length_ = last_end == std::string_view::npos ? line_length_ + piece.size()
                                                      : piece.size() - last_end - 1;
    controls_ += count_stray_controls(piece);
    return std::nullopt;
}

void Collector::strip_byte_order_mark() {
    if (program_.text.starts_with(byte_order_mark)) program_.text.erase(0, byte_order_mark.size());
}

core::Result<Program> Collector::finish() && {
    strip_byte_order_mark();
    // A few stray control characters are damaged lines, which the lexer reports; many mean another
    // format.
    if (looks_binary(controls_, program_.text.size()))
        return tl::unexpected(refusal("is a binary file, not an NC program", 0));
    if (!has_a_block(program_.text))
        return tl::unexpected(refusal("has no blocks: there is nothing to run", 0));
    program_.line_starts = starts_of_lines(program_.text);
    return std::move(program_);
}

core::Error cannot_read(const std::string& path, std::string_view why) {
    return {ErrorCode::io, {}, fmt::format("cannot read {}: {}", path, why), path};
}

} // namespace

std::string_view Program::line(size_t number) const {
    if (windows) {
        const auto found = windows->line(number);
        return found && *found ? **found : std::string_view();
    }
    const size_t begin = line_starts[number - 1];
    const size_t end = number < line_starts.size() ? line_starts[number] : text.size();
    return without_line_end(std::string_view(text).substr(begin, end - begin));
}

core::Result<bool> Program::has_line(size_t number) const {
    if (!windows) return number >= 1 && number <= line_starts.size();
    FEELER_TRY(const auto found, windows->line(number));
    return found.has_value();
}

core::Result<std::optional<std::string_view>> Program::find_line(size_t number) const {
    if (windows) return windows->line(number);
    if (number < 1 || number > line_starts.size()) return std::nullopt;
    return line(number);
}

namespace {

/// Reads a file completely, unless it cannot be an NC program.
core::Result<Collector> collected(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        return tl::unexpected(
            cannot_read(path, "it is a directory; give the path of an NC program"));
    if (core::platform::is_device(path))
        return tl::unexpected(cannot_read(path, "it is a device; give the path of an NC program"));
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
        core::platform::open_file(path, "rb"), std::fclose);
    if (!file)
        return tl::unexpected(
            cannot_read(path, std::error_code(errno, std::generic_category()).message()));

    Collector collector(path);
    std::array<char, chunk_size> chunk;
    while (const size_t count = std::fread(chunk.data(), 1, chunk.size(), file.get()))
        if (auto error = collector.add(std::string_view(chunk.data(), count)))
            return tl::unexpected(std::move(*error));
    if (std::ferror(file.get()) != 0)
        return tl::unexpected(cannot_read(path, "the file system reports an error"));
    return collector;
}

} // namespace

core::Result<Program> read_program(const std::string& path) {
    auto collector = collected(path);
    core::notify_file_access(
        {core::FileAccessKind::content,
         path,
         {},
         collector ? std::optional<std::string_view>(collector->text()) : std::nullopt});
    if (!collector) return tl::unexpected(std::move(collector).error());
    return std::move(*collector).finish();
}

core::Result<Program> open_program(const std::string& path, size_t window) {
    std::error_code failure;
    // A source that cannot be read twice, such as a pipe, is held in memory.
    const bool is_file = std::filesystem::is_regular_file(path, failure);
    if (!is_file || std::filesystem::file_size(path, failure) <= 4 * window || failure)
        return read_program(path);
    Program program;
    program.file = path;
    FEELER_TRY(program.windows, LineWindows::open(path, window));
    FEELER_TRY(const bool has_lines, program.has_line(1));
    (void)has_lines;
    return program;
}

core::Result<Program> program_from_text(std::string_view text, std::string file) {
    Collector collector(std::move(file));
    if (auto error = collector.add(text)) return tl::unexpected(std::move(*error));
    return std::move(collector).finish();
}

} // namespace gcode
