#include "app/report/html_text.h"

#include <fmt/format.h>

#include "app/setup/utf8_text.h"

namespace app {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

} // namespace

std::string html_text(std::string_view text) {
    std::string safe;
    for (const char c : utf8_text(text)) {
        switch (c) {
        case '&':
            safe += "&amp;";
            break;
        case '<':
            safe += "&lt;";
            break;
        case '>':
            safe += "&gt;";
            break;
        case '"':
            safe += "&quot;";
            break;
        case '\'':
            safe += "&#39;";
            break;
        default:
            safe += is_control(c) ? ' ' : c;
        }
    }
    return safe;
}

std::string script_string(std::string_view text) {
    std::string safe = "\"";
    for (const char c : utf8_text(text)) {
        if (c == '"' || c == '\\')
            (safe += '\\') += c;
        else if (c == '<' || c == '>' || c == '&' || is_control(c))
            fmt::format_to(std::back_inserter(safe), "\\u{:04x}", static_cast<unsigned char>(c));
        else
            safe += c;
    }
    return safe += '"';
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        for (size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0U);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? letters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

} // namespace app
