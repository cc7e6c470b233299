#pragma once

#include <cstdint>
#include <span>

namespace test_support {

/// Reads bytes as a file of a control or of a CAM system; the first byte selects the kind, '0' to
/// '7'. Asserts what holds for every file, however broken: an error has a message and a file, and
/// what is read is finite and in order.
///
/// Errors: ends the process with a message if one of these does not hold.
void run_any_import(std::span<const uint8_t> bytes);

} // namespace test_support
