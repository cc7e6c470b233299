#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A letter and its value as written, in the units of the program.
struct Word {
    char letter = '\0'; // upper case
    double value = 0.0;
    core::SourceSpan span{};
    bool has_point = false; // X5. rather than X5

    bool operator==(const Word& other) const {
        return letter == other.letter && value == other.value && has_point == other.has_point;
    }
};

struct Comment {
    std::string_view text; // without its brackets or semicolon
    core::SourceSpan span;
};

/// One line of an NC program after parsing. Views refer to the program's text.
struct Block {
    uint32_t line = 0;
    std::string_view text;
    std::vector<Word> words{};
    std::vector<Comment> comments{};
    std::optional<int> block_delete{}; // `/` is 1, `/1` to `/9` their number
    bool tape_mark = false;            // a line that begins with %
};

} // namespace gcode
