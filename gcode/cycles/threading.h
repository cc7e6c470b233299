#pragma once

#include <optional>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A place in the ZX plane of a lathe, mm; X is a radius.
struct TurningPoint {
    double x = 0.0, z = 0.0;

    bool operator==(const TurningPoint&) const = default;
};

/// The words of a G76 block; lengths in mm, on the radius: under G7 half of I, J and K.
struct ThreadingWords {
    std::optional<double> pitch; // P: mm along Z per revolution
    std::optional<double> i;     // from the drive line, where the tool is, to the crest
    std::optional<double> j;     // the depth of the first pass below the crest
    std::optional<double> k;     // the depth of the thread
    double degression = 1.0;     // R: 1 and less is equal depths, 2 is equal areas
    double compound_angle = 0.0; // Q: radians
    int spring_passes = 0;       // H: passes at full depth after the first such
    double taper_length = 0.0;   // E: along Z
    int tapered_ends = 0;        // L: 1 the entry, 2 the exit, 3 both

    bool operator==(const ThreadingWords&) const = default;
};

/// A straight move of the cycle, beside which Y stands still.
struct ThreadingMove {
    TurningPoint end;
    std::optional<double> pitch; // mm along the path per revolution; empty: a rapid

    bool operator==(const ThreadingMove&) const = default;
};

/// More passes than this, above the full depth or at it, are refused.
constexpr int greatest_thread_passes = 10'000;

/// The moves of G76: for each pass a rapid to its start, in to its depth, along the thread, out,
/// and at last a rapid to `end`.
///
/// `start` is where the tool is. `end` is the end as for a straight motion: its Z is that of the
/// thread, its X is used by the last rapid only. The caller adds to that one the end in Y.
///
/// Result: as LinuxCNC 2.9, also where it makes no sense: a taper may be longer than the thread, a
/// pitch zero or negative. L takes its two lowest bits, a taper length up to 0 is no taper, and
/// H-1 leaves out the pass at full depth.
/// Errors: P, I, J or K missing; I 0; J not positive; K not greater than J; H or L negative, except
/// H-1; a compound angle of a right angle; more than greatest_thread_passes.
core::Result<std::vector<ThreadingMove>> threading_moves(TurningPoint start, TurningPoint end,
                                                         const ThreadingWords& words);

} // namespace gcode
