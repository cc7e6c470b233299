#include "app/session/m_codes.h"

#include <cctype>
#include <cstdlib>
#include <string>

namespace app {

bool has_m_code(std::string_view block, int code) {
    int depth = 0;
    for (size_t i = 0; i < block.size(); ++i) {
        const char c = block[i];
        if (c == ';' && depth == 0) return false;
        if (c == '(') ++depth;
        if (c == ')' && depth > 0) --depth;
        if (depth > 0 || (c != 'M' && c != 'm')) continue;
        size_t at = i + 1;
        while (at < block.size() && block[at] == ' ') ++at;
        std::string digits;
        while (at < block.size() && std::isdigit(static_cast<unsigned char>(block[at])))
            digits += block[at++];
        if (!digits.empty() && digits.size() < 6 && std::atoi(digits.c_str()) == code) return true;
    }
    return false;
}

} // namespace app
