#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace app {

/// A piece of a condition's text.
struct ConditionToken {
    enum class Kind : uint8_t { end, number, name, text, sign };

    Kind kind = Kind::end;
    std::string text = {};  // a name in small letters, a sign in its shortest form, a text as it is
    std::string whole = {}; // of a name: with what follows behind hyphens, as it was written
    double number = 0.0;
    uint32_t column = 0; // from 1
};

/// The pieces, the last of which is the end.
///
/// Errors: syntax, with the column.
core::Result<std::vector<ConditionToken>> tokens_of(std::string_view text);

} // namespace app
