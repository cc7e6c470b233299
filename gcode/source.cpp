#include "gcode/source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

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

    std::optional<Error> add(std::string_view piece) {
        for (const char c : piece)
            if (auto error = add(c)) return error;
        return std::nullopt;
    }

    core::Result<Program> finish() &&;

private:
    std::optional<Error> add(char c);
    void strip_byte_order_mark();

    Error refusal(std::string_view what, uint32_t line) const {
        const std::string name = program_.file.empty() ? "the program" : program_.file;
        return {ErrorCode::syntax, {.line = line}, fmt::format("{} {}", name, what), program_.file};
    }

    Program program_;
    uint32_t line_ = 1;
    size_t line_length_ = 0;
    size_t controls_ = 0;
};

std::optional<Error> Collector::add(char c) {
    if (c == '\0') return refusal("holds NUL bytes: it is a binary file, not an NC program", line_);
    controls_ += is_stray_control(c);
    if (is_line_end(c)) {
        const bool after_return = c == '\n' && program_.text.ends_with('\r');
        line_ += !after_return;
        line_length_ = 0;
    } else if (++line_length_ > longest_line) {
        return refusal(fmt::format("has a line {} of more than {} characters; break it into blocks",
                                   line_, longest_line),
                       line_);
    }
    if (program_.text.size() == longest_program)
        return refusal("is longer than 1 GiB; split it into several programs", line_);
    program_.text.push_back(c);
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

core::Result<Program> read_program(const std::string& path) {
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
    return std::move(collector).finish();
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
