#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"

namespace app {

struct PreparedCheck;

/// The most numbers or lengths that are kept of one tool: a program can make any number of them.
constexpr size_t most_kept_values = 12;

/// What a program does with one tool. Of each set, the first most_kept_values are kept.
struct ToolUse {
    std::optional<core::ToolNumber> tool; // empty: no tool is known to be in the spindle
    std::set<core::OffsetNumber> lengths; // H numbers in effect while it feeds
    std::set<int> radii;                  // D numbers of its radius compensation
    std::set<double> control_lengths;     // lengths that the control adds with it, mm
    bool feeds_without_length = false;    // in at least one block
    bool length_is_assumed = false;       // nobody states one of the lengths
    // While the spindle turns: rev/min, or as programmed with a constant surface speed. Empty: it
    // never does.
    std::optional<double> least_speed, most_speed;
    bool has_surface_speed = false;
};

/// A work offset in whose coordinates a program moves.
struct ZeroUse {
    core::Vec3 origin = core::Vec3(0.0); // X, Y, Z at its first move, machine coordinates
    std::optional<uint32_t> set_in;      // line of the main program that has set another origin
    std::optional<uint32_t> shifted_in;  // first line with a move under G52, G92 or a frame
};

/// What a program uses of its set-up.
struct ProgramUse {
    std::vector<ToolUse> tools;        // that move, in the order of their first moves
    std::map<size_t, ZeroUse> offsets; // by index, 0 is G54
};

/// Reads the program once more, to its end or to its first error. `is_stopped` is polled; true
/// ends it.
/// Cost: that of reading the program without a check.
ProgramUse program_use(const PreparedCheck& check, const std::function<bool()>& is_stopped = {});

} // namespace app
