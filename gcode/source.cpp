#include "gcode/source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "gcode/program_text.h"

namespace gcode {
namespace {

using core::Error;
using core::ErrorCode;

constexpr size_t chunk_size = 65536;
constexpr size_t longest_program = size_t(1) << 30;

/// Collects a text piece by piece, and stops as soon as it cannot be an NC program.
class Collector {
public:
    explicit Collector(std::string file) { program_.file = std::move(file); }

    std::optional<Error> add(std::string_view text) {
        for (size_t at = 0; at < text.size(); at += chunk_size)
            if (auto error = add_piece(text.substr(at, chunk_size))) return error;
        return std::nullopt;
    }

    /// Of the whole file, byte for byte.
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
    size_t line_length_ = 0; // of the line at the end, so far
    size_t controls_ = 0;
};

std::optional<Error> Collector::add_piece(std::string_view piece) {
    // A line that is too long is longer than a piece, so that its end need not be looked for inside
    // of one.
    static_assert(chunk_size <= longest_line);
    if (program_.text.size() + piece.size() > longest_program)
        return refusal("is longer than 1 GiB; split it into several programs", 0);
    const size_t nul = piece.find('\0');
    if (nul != std::string_view::npos) piece = piece.substr(0, nul);
    const size_t first_end = std::min(piece.find_first_of("\r\n"), piece.size());
    program_.text += piece.substr(0, first_end);
    if (line_length_ + first_end > longest_line) {
        const size_t line = starts_of_lines(program_.text).size();
        return refusal(fmt::format("has a line {} of more than {} characters; break it into blocks",
                                   line, longest_line),
                       line);
    }
    program_.text += piece.substr(first_end);
    if (nul != std::string_view::npos)
        return refusal(what_has_nuls(program_.text), starts_of_lines(program_.text + ' ').size());
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
    // A stray control character is a damaged line, which the lexer names; many are another format.
    if (looks_binary(controls_, program_.text.size()))
        return tl::unexpected(refusal("is a binary file, not an NC program", 0));
    if (!has_a_block(program_.text))
        return tl::unexpected(refusal("has no blocks: there is nothing to run in it", 0));
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

/// All of a file, as far as it can be an NC program.
core::Result<Collector> collected(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        return tl::unexpected(cannot_read(path, "it is a directory; name an NC program in it"));
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        return tl::unexpected(
            cannot_read(path, std::error_code(errno, std::generic_category()).message()));

    Collector collector(path);
    std::array<char, chunk_size> chunk;
    while (stream) {
        stream.read(chunk.data(), chunk.size());
        const auto count = static_cast<size_t>(stream.gcount());
        if (auto error = collector.add(std::string_view(chunk.data(), count)))
            return tl::unexpected(std::move(*error));
    }
    if (stream.bad()) return tl::unexpected(cannot_read(path, "the file system reports an error"));
    return collector;
}

} // namespace

core::Result<Program> read_program(const std::string& path) {
    auto collector = collected(path);
    core::note_look(
        {core::FileQuestion::content,
         path,
         {},
         collector ? std::optional<std::string_view>(collector->text()) : std::nullopt});
    if (!collector) return tl::unexpected(std::move(collector).error());
    return std::move(*collector).finish();
}

core::Result<Program> open_program(const std::string& path, size_t window) {
    std::error_code failure;
    // What cannot be read twice, as a pipe, is held whole.
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
