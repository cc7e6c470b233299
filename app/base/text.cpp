#include "app/base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "core/base/math.h"
#include "core/base/text.h"

namespace app {
namespace {

struct Lead {
    size_t length = 0; // bytes of the character; 0: not a lead byte
    uint32_t bits = 0;
    uint32_t least = 0; // smallest code point of this length
};

Lead lead_of(unsigned char byte) {
    if (byte < 0x80) return {1, byte, 0};
    if (byte >> 5 == 0x06) return {2, byte & 0x1fU, 0x80};
    if (byte >> 4 == 0x0e) return {3, byte & 0x0fU, 0x800};
    if (byte >> 3 == 0x1e) return {4, byte & 0x07U, 0x10000};
    return {};
}

/// The first character of a text, and its length in bytes; the length is 0 if it is invalid.
struct Character {
    size_t length = 0;
    uint32_t code = 0;
};

Character first_character(std::string_view text) {
    const Lead lead = lead_of(static_cast<unsigned char>(text[0]));
    if (lead.length == 0 || lead.length > text.size()) return {};
    uint32_t code = lead.bits;
    for (size_t i = 1; i < lead.length; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte >> 6 != 0x02) return {};
        code = code << 6 | (byte & 0x3fU);
    }
    const bool is_surrogate = code >= 0xd800 && code < 0xe000;
    if (code < lead.least || code > 0x10ffff || is_surrogate) return {};
    return {lead.length, code};
}

size_t character_length(std::string_view text) { return first_character(text).length; }

} // namespace

size_t characters_in(std::string_view text) {
    size_t count = 0;
    for (; !text.empty(); ++count) text.remove_prefix(std::max<size_t>(character_length(text), 1));
    return count;
}

std::u32string code_points(std::string_view text) {
    constexpr uint32_t above_all = 0x110000;
    std::u32string codes;
    while (!text.empty()) {
        const Character first = first_character(text);
        codes += static_cast<char32_t>(
            first.length > 0 ? first.code : above_all + static_cast<unsigned char>(text[0]));
        text.remove_prefix(std::max<size_t>(first.length, 1));
    }
    return codes;
}

std::string utf8_text(std::string_view text) {
    std::string whole;
    while (!text.empty()) {
        const size_t length = character_length(text);
        if (length > 0) {
            whole += text.substr(0, length);
        } else {
            const auto byte = static_cast<unsigned char>(text[0]);
            whole += static_cast<char>(0xc0 | byte >> 6);
            whole += static_cast<char>(0x80 | (byte & 0x3f));
        }
        text.remove_prefix(std::max<size_t>(length, 1));
    }
    return whole;
}

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
        return tl::unexpected(io_error(path, "is larger than 16 MiB, too large for a table"));
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

namespace {

/// Length in bytes of the control character at a position: one of the first 32, DEL, or one of
/// those after DEL, which take two bytes in UTF-8. 0 if there is none.
size_t control_at(std::string_view text, size_t at) {
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(at) < ' ' || byte(at) == 0x7F) return 1;
    const bool is_pair = byte(at) == 0xC2 && at + 1 < text.size();
    return is_pair && byte(at + 1) >= 0x80 && byte(at + 1) < 0xA0 ? 2 : 0;
}

/// The text with blanks in place of control characters, except those in `stay`.
std::string without_controls(std::string_view text, std::string_view stay) {
    std::string result;
    for (size_t i = 0; i < text.size();) {
        const size_t length = control_at(text, i);
        const bool is_control = length > 0 && stay.find(text[i]) == std::string_view::npos;
        result += is_control ? ' ' : text[i];
        i += is_control ? length : 1;
    }
    return result;
}

} // namespace

std::string printable(std::string_view text) { return without_controls(utf8_text(text), "\n"); }

std::string absolute_path(const std::string& path) {
    if (path.empty()) return path;
    std::error_code failure;
    const std::filesystem::path whole = std::filesystem::absolute(path, failure);
    return failure ? path : whole.lexically_normal().generic_string();
}

std::string trimmed(std::string_view text) {
    const std::string result = without_controls(text, "");
    const size_t first = result.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return result.substr(first, result.find_last_not_of(' ') - first + 1);
}

std::string clipped(const std::string& text, size_t width) {
    if (text.size() <= width) return text;
    // Not within a UTF-8 character, which has at most 3 bytes after its first.
    const auto goes_on = [&](size_t at) {
        return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
    };
    size_t end = width - 3;
    for (int i = 0; i < 3 && end > 0 && goes_on(end); ++i) --end;
    return text.substr(0, end) + "...";
}

std::string wrapped(const std::string& text, size_t indent, size_t hang, size_t width) {
    std::istringstream words(text);
    std::string result, line(indent, ' '), word;
    bool line_is_empty = true;
    while (words >> word) {
        if (!line_is_empty && line.size() + 1 + word.size() > width) {
            result += line + "\n";
            line = std::string(indent + hang, ' ');
            line_is_empty = true;
        }
        if (!line_is_empty) line += ' ';
        line += word;
        line_is_empty = false;
    }
    return result + line + "\n";
}

std::string line_ranges(std::vector<uint32_t> lines) {
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    constexpr size_t most = 12; // ranges: more would not help
    std::string text;
    size_t ranges = 0;
    for (size_t i = 0; i < lines.size();) {
        if (ranges++ == most) return text + fmt::format(" and others up to {}", lines.back());
        size_t last = i;
        while (last + 1 < lines.size() && lines[last + 1] == lines[last] + 1) ++last;
        if (!text.empty()) text += ", ";
        text +=
            last == i ? fmt::format("{}", lines[i]) : fmt::format("{}-{}", lines[i], lines[last]);
        i = last + 1;
    }
    return text;
}

namespace {

/// Whether a spreadsheet reads a cell as a formula, or looks for one after its first character. The
/// last four are full-width = + - @, which some programs treat alike.
bool is_formula(std::string_view cell) {
    constexpr std::array<std::string_view, 12> beginnings = {"=",
                                                             "+",
                                                             "-",
                                                             "@",
                                                             "\t",
                                                             "\r",
                                                             "\n",
                                                             std::string_view("\0", 1),
                                                             "\xEF\xBC\x9D",
                                                             "\xEF\xBC\x8B",
                                                             "\xEF\xBC\x8D",
                                                             "\xEF\xBC\xA0"};
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](std::string_view beginning) { return cell.starts_with(beginning); });
}

} // namespace

std::string csv_cell(const std::string& text) {
    const std::string cell = is_formula(text) ? "'" + text : text;
    if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
    std::string quoted = "\"";
    for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string counted(size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string counts_text(size_t errors, size_t warnings, size_t notes) {
    return counted(errors, "error") + ", " + counted(warnings, "warning") + ", "
           + counted(notes, "note");
}

std::string duration_text(double seconds) {
    constexpr double longest = 3.6e9; // a million hours
    if (!std::isfinite(seconds)) return "unknown";
    if (seconds >= longest) return "more than 1,000,000 h";
    const int64_t whole = core::round_to_integer(seconds);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string verdict_text(core::Verdict verdict) {
    const std::string name = core::upper_case(core::name_of(verdict));
    if (verdict == core::Verdict::undecided) return name + ", not proven clear";
    if (verdict == core::Verdict::violation) return name + ", below a minimum clearance";
    return name;
}

} // namespace app
