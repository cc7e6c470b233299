#include "gcode/source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

namespace gcode {
namespace {

using core::Error;
using core::ErrorCode;

constexpr size_t chunk_size = 65536;
constexpr size_t longest_program = size_t(1) << 30;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Tape readers left XON, XOFF and friends; DOS left its end-of-file mark.
bool is_harmless_control(char c) {
    return (c >= '\t' && c <= '\r') || (c >= 0x11 && c <= 0x14) || c == 0x1A;
}

bool is_control(char c) {
    return (static_cast<unsigned char>(c) < 0x20 && !is_harmless_control(c)) || c == 0x7F;
}

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
    controls_ += is_control(c);
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

std::vector<size_t> starts_of_lines(std::string_view text) {
    std::vector<size_t> starts;
    size_t at = 0;
    while (at < text.size()) {
        starts.push_back(at);
        at = std::min(text.find_first_of("\r\n", at), text.size());
        if (text.substr(at).starts_with("\r\n")) ++at;
        ++at;
    }
    return starts;
}

/// Whether anything stands outside of comments, tape marks and blanks.
bool has_a_block(std::string_view text) {
    char comment = '\0';
    for (const char c : text) {
        if (is_line_end(c))
            comment = '\0';
        else if (comment == '(' && c == ')')
            comment = '\0';
        else if (comment == '\0' && (c == '(' || c == ';' || c == '%'))
            comment = c;
        else if (comment == '\0' && static_cast<unsigned char>(c) > ' ')
            return true;
    }
    return false;
}

core::Result<Program> Collector::finish() && {
    strip_byte_order_mark();
    // A stray control character is a damaged line, which the lexer names; many are another format.
    if (controls_ * 10 > program_.text.size())
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
    const size_t begin = line_starts[number - 1];
    const std::string_view rest = std::string_view(text).substr(begin);
    return rest.substr(0, rest.find_first_of("\r\n"));
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

core::Result<Program> program_from_text(std::string_view text, std::string file) {
    Collector collector(std::move(file));
    if (auto error = collector.add(text)) return tl::unexpected(std::move(*error));
    return std::move(collector).finish();
}

} // namespace gcode
