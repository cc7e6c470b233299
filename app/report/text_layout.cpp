#include "app/report/text_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "app/setup/utf8_text.h"

namespace app {

namespace {

/// Bytes of the control character that stands at a place: of the first 32, of DEL, and of those
/// beyond it, which are two bytes in UTF-8. 0: there is none.
size_t control_at(std::string_view text, size_t at) {
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(at) < ' ' || byte(at) == 0x7F) return 1;
    const bool is_pair = byte(at) == 0xC2 && at + 1 < text.size();
    return is_pair && byte(at + 1) >= 0x80 && byte(at + 1) < 0xA0 ? 2 : 0;
}

/// The same with a blank in place of each control character but those that are to stay.
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

std::string trimmed(std::string_view text) {
    const std::string result = without_controls(text, "");
    const size_t first = result.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return result.substr(first, result.find_last_not_of(' ') - first + 1);
}

std::string clipped(const std::string& text, size_t width) {
    if (text.size() <= width) return text;
    // Never within a character of UTF-8, which has at most 3 bytes behind its first.
    const auto goes_on = [&](size_t at) {
        return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
    };
    size_t end = width - 3;
    for (int i = 0; i < 3 && end > 0 && goes_on(end); ++i) --end;
    return text.substr(0, end) + "...";
}

std::string wrapped(const std::string& text, size_t indent, size_t hang) {
    constexpr size_t width = 80;
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
    constexpr size_t most = 12; // ranges: more of them tell nothing
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

/// Whether a spreadsheet takes a cell for a formula, or looks for one behind its first character.
/// The last four are = + - @ at full width, which some count as the same.
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

std::string duration_text(double seconds) {
    const auto whole = static_cast<long long>(std::llround(seconds));
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string verdict_text(core::Verdict verdict) {
    switch (verdict) {
    case core::Verdict::clear:
        return "CLEAR";
    case core::Verdict::undecided:
        return "UNDECIDED, not proven clear";
    case core::Verdict::violation:
        return "VIOLATION, an allowance is not kept";
    default:
        return "COLLISION";
    }
}

} // namespace app
