#include "app/setup/text_lines.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/file_reads.h"

namespace app {
namespace {

constexpr size_t largest_file = size_t(16) << 20; // bytes

core::Error io_error(const std::string& path, const std::string& why) {
    return {core::ErrorCode::io, {}, why, path};
}

} // namespace

core::Result<std::vector<std::string>> lines_of_file(const std::string& path) {
    if (const std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(io_error(path, why));
    std::optional<std::string> bytes = core::file_bytes(path, largest_file);
    if (!bytes) return tl::unexpected(io_error(path, "cannot be read"));
    if (bytes->size() > largest_file)
        return tl::unexpected(io_error(path, "is larger than 16 MiB: it is no such table"));
    std::istringstream stream(*std::move(bytes));
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) {
        if (line.ends_with('\r')) line.pop_back();
        lines.push_back(std::move(line));
    }
    return lines;
}

std::vector<std::string> words_of_line(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(std::move(word));
    return words;
}

std::optional<double> number_in(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    double number = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
        return std::nullopt;
    return number;
}

core::Error line_error(const std::string& path, size_t line, std::string message) {
    return {
        core::ErrorCode::syntax, {.line = static_cast<uint32_t>(line)}, std::move(message), path};
}

} // namespace app
