#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "gcode/language/dialect.h"

namespace test_support {

struct ChosenProgram {
    std::string text;
    gcode::DialectId dialect;
    bool block_delete;
};

/// A program of which every byte chooses a part: codes that exist beside codes that do not, words
/// that fit and words that do not, loops, calls, expressions, values at the ends of their ranges.
///
/// Result: the same bytes, the same program; it ends where the bytes do.
ChosenProgram chosen_program(std::span<const uint8_t> choices);

} // namespace test_support
