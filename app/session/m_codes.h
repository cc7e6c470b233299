#pragma once

#include <string_view>

namespace app {

/// Whether a block has the word M with this number outside of its comments.
bool has_m_code(std::string_view block, int code);

} // namespace app
