#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session/condition.h"

namespace app {

/// Where a run through a program stops: before each block that all its parts are true of.
struct Breakpoint {
    int id = 0;                   // from 1; never used twice in a session
    std::optional<uint32_t> line; // of `file`, or of the main program
    std::string file;             // of a subprogram, as CheckedBlock::file; empty: main program
    std::optional<core::ToolNumber> tool; // blocks that change to it
    std::string rule;                     // blocks with a finding of that rule; "finding": any
    std::optional<Condition> condition;
    bool enabled = true;
    bool temporary = false; // goes when it has stopped a run
    size_t ignore = 0;      // so many times it lets a run pass
    size_t hits = 0;
};

/// As a person would say it: "line 23 if clearance < 1".
std::string text_of(const Breakpoint& breakpoint);

} // namespace app
