#include "app/batch/block_text.h"

#include <cctype>

namespace app {

std::string without_number(std::string_view block) {
    std::string text;
    for (const char letter : block)
        if (!std::isspace(static_cast<unsigned char>(letter)))
            text += static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const size_t skip = text.starts_with('/') ? 1 : 0;
    // N120, :120, and the bare number in front of a line of Klartext.
    size_t end = skip;
    if (end < text.size() && (text[end] == 'N' || text[end] == ':')) ++end;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
    const bool is_number = end > skip && std::isdigit(static_cast<unsigned char>(text[end - 1]));
    return is_number ? text.substr(0, skip) + text.substr(end) : text;
}

std::string numberless(std::string_view block) {
    return without_number(block.substr(0, block.find(';')));
}

} // namespace app
