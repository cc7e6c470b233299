#pragma once

#include <cstdint>

namespace core {

/// What is known of a pair of bodies over a block, from harmless to worst.
enum class Verdict : uint8_t { clear, undecided, violation, collision };

const char* name_of(Verdict verdict);

/// Lengths nearer together than this are the same length, mm: an allowance that is kept to within
/// it counts as kept. It stands far above rounding and far below anything a machine can hold.
constexpr double resolution = 1e-6;

} // namespace core
