#pragma once

#include "app/batch/program_result.h"

namespace app {

/// What became of a program of a batch, from harmless to worst.
enum class Outcome : uint8_t {
    clear,
    undecided,
    errors, // all distances are kept, and something else is wrong
    violation,
    collision,
    stopped,
    not_run, // not a single block
    unchecked
};

constexpr std::array<Outcome, 8> all_outcomes = {
    Outcome::clear,     Outcome::undecided, Outcome::errors,  Outcome::violation,
    Outcome::collision, Outcome::stopped,   Outcome::not_run, Outcome::unchecked};

/// In small letters, as "not run".
const char* name_of(Outcome outcome);

/// That of a program that was checked, if not to its end.
Outcome outcome_of(const ProgramResult& result);

} // namespace app
