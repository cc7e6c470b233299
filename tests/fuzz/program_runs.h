#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "gcode/language/dialect.h"

namespace test_support {

/// Runs a program within small limits and asserts what holds for every program, however broken: an
/// error leaves the state as before the block and gives a line of the program, each command has its
/// position, no coordinate is infinite or NaN, and a copy of a state behaves like the state itself.
///
/// Errors: ends the process with a message if one of these does not hold.
void run_any_program(std::string_view text, gcode::DialectId dialect, bool block_delete);

/// The same for arbitrary bytes: the first selects the dialect, the rest is the text.
void run_any_bytes(std::span<const uint8_t> bytes);

/// The same for a program in which each part is selected by a byte.
void run_chosen_program(std::span<const uint8_t> choices);

} // namespace test_support
