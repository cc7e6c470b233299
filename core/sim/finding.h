#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/base/ids.h"
#include "core/base/rule.h"
#include "core/base/vec.h"

namespace core {

struct Setup;

/// How deep two bodies overlap in a block.
///
/// The depth at a moment is the length of the shortest translation of the tool side after which the
/// two bodies no longer overlap; what counts as contact counts as no overlap. The depth of a block
/// is that of its deepest moment: least <= depth <= most.
struct Overlap {
    double least = 0.0;         // mm
    std::optional<double> most; // mm; empty if no translation that separates them was found
    Vec3 way_out = Vec3(0.0);   // unit vector in the frame of the stock: moved by `most` along it,
                                // the bodies no longer overlap at the deepest moment

    bool operator==(const Overlap&) const = default;
};

/// How far an axis goes beyond one of its limits.
struct OverTravel {
    size_t axis = 0;
    bool is_upper = false; // which limit
    double to = 0.0;       // machine coordinates, mm or degrees
    double beyond = 0.0;   // mm or degrees

    bool operator==(const OverTravel&) const = default;
};

/// A fact about a block that a person should know.
struct Finding {
    std::string rule; // stable id, such as `near-miss`
    Severity severity = Severity::warning;
    std::optional<BlockIndex> block;     // empty: the program as a whole
    std::string message;                 // one or two sentences, in a machinist's words
    std::string cure;                    // what removes it; may be empty
    std::array<std::string, 2> pair{};   // the two bodies concerned; empty if there are none
    double shortfall = 0.0;              // minimum clearance minus clearance, mm
    std::optional<Overlap> overlap = {}; // of the pair, if it collides and the depth was measured
    std::optional<OverTravel> over_travel = {}; // of the axis, if it is about a limit

    bool operator==(const Finding&) const = default;
};

/// Whether a finding has a larger shortfall or, with equal ones, a deeper overlap.
bool is_worse(const Finding& finding, const Finding& than);

/// "1.000 mm": how far an axis goes beyond its limit; "201.000": where it goes.
std::string beyond_text(const OverTravel& over_travel);
std::string target_text(const OverTravel& over_travel);

/// A direction in the frame of the stock by its main axes: "X+ Z+".
std::string direction_text(const Vec3& direction);

/// How deep an overlap is, without the unit: "2.00", "1.96 to 2.01", "up to 0.01", "at least 3.19".
/// Lower bounds are rounded down and upper bounds up; bounds that differ by at most one unit of the
/// last digit are one number, the lower bound.
std::string depth_text(const Overlap& overlap, int digits = 2);

/// The last number of depth_text: the depth at most, else at least.
std::string depth_number(const Overlap& overlap, int digits = 2);

/// "The overlap is 3.199 to 3.201 mm deep; the shortest way out is towards X+."
std::string overlap_text(const Overlap& overlap);

/// Severities from the set-up, by rule name. They override the defaults.
using RuleSeverities = std::map<std::string, Severity>;

/// Severity of a rule in this set-up.
Severity severity_of(const Setup& setup, const std::string& rule);

/// Sets the severity of a finding to that of its rule in this set-up. A note stays a note unless
/// the set-up names its rule.
void settle_severity(const Setup& setup, Finding& finding);

} // namespace core
