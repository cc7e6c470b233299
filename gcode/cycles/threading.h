#pragma once

#include <optional>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A point in the ZX plane of a lathe, mm; X is a radius.
struct TurningPoint {
    double x = 0.0, z = 0.0;

    bool operator==(const TurningPoint&) const = default;
};

/// The words of a G76 block; lengths in mm, as radii: with G7 half of I, J and K.
struct ThreadingWords {
    std::optional<double> pitch; // P: mm along Z per revolution
    std::optional<double> i;     // from the drive line, at the tool's start, to the crest
    std::optional<double> j;     // the depth of the first pass below the crest
    std::optional<double> k;     // the depth of the thread
    double degression = 1.0;     // R: up to 1 for equal depths, 2 for equal areas
    double compound_angle = 0.0; // Q: radians
    int spring_passes = 0;       // H: additional passes at full depth
    double taper_length = 0.0;   // E: along Z
    int tapered_ends = 0;        // L: 1 entry, 2 exit, 3 both

    bool operator==(const ThreadingWords&) const = default;
};

/// A straight move of the cycle in X and Z.
struct ThreadingMove {
    TurningPoint end;
    std::optional<double> pitch; // mm along the path per revolution; empty: a rapid

    bool operator==(const ThreadingMove&) const = default;
};

/// Maximum number of passes, separately for those above full depth and at full depth.
constexpr int greatest_thread_passes = 10'000;

/// The moves of G76: for each pass a rapid to its start, in to its depth, along the thread and out;
/// finally a rapid to `end`.
/// `start` is the tool position. `end` is the end point as in a straight move: its Z is the end of
/// the thread, its X is used only by the last rapid. The caller adds Y to that rapid.
///
/// Result: as LinuxCNC 2.9, even where it makes no sense: a taper may be longer than the thread, a
///         pitch zero or negative. Only the two lowest bits of L are used, a taper length of 0 or
///         less means no taper, and H-1 omits the pass at full depth.
/// Errors: P, I, J or K missing; I 0; J not positive; K not greater than J; H or L negative, except
///         H-1; a compound angle of 90 degrees; more than greatest_thread_passes.
core::Result<std::vector<ThreadingMove>> threading_moves(TurningPoint start, TurningPoint end,
                                                         const ThreadingWords& words);

} // namespace gcode
