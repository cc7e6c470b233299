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

/// A program in which each byte selects a part: valid and invalid codes, fitting and unfitting
/// words, loops, calls, expressions, values at the ends of their ranges.
///
/// Result: the same bytes give the same program; it ends with the bytes.
ChosenProgram chosen_program(std::span<const uint8_t> choices);

} // namespace test_support
