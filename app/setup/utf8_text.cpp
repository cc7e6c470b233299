#include "app/setup/utf8_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace app {
namespace {

struct Lead {
    size_t length = 0; // of the whole character; 0: nothing begins so
    uint32_t bits = 0;
    uint32_t least = 0; // what needs so many bytes
};

Lead lead_of(unsigned char byte) {
    if (byte < 0x80) return {1, byte, 0};
    if (byte >> 5 == 0x06) return {2, byte & 0x1fU, 0x80};
    if (byte >> 4 == 0x0e) return {3, byte & 0x0fU, 0x800};
    if (byte >> 3 == 0x1e) return {4, byte & 0x07U, 0x10000};
    return {};
}

/// How many bytes the character takes that a text begins with; 0: it begins with none.
size_t character_length(std::string_view text) {
    const Lead lead = lead_of(static_cast<unsigned char>(text[0]));
    if (lead.length == 0 || lead.length > text.size()) return 0;
    uint32_t code = lead.bits;
    for (size_t i = 1; i < lead.length; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte >> 6 != 0x02) return 0;
        code = code << 6 | (byte & 0x3fU);
    }
    const bool is_surrogate = code >= 0xd800 && code < 0xe000;
    return code < lead.least || code > 0x10ffff || is_surrogate ? 0 : lead.length;
}

} // namespace

size_t characters_in(std::string_view text) {
    size_t count = 0;
    for (; !text.empty(); ++count) text.remove_prefix(std::max<size_t>(character_length(text), 1));
    return count;
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

} // namespace app
