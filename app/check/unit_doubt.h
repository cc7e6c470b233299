#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/sim/finding.h"

namespace core {
struct Setup;
}
namespace gcode {
enum class LengthUnit : uint8_t;
struct Program;
} // namespace gcode

namespace app {

struct FeedFacts;
struct OffsetUse;
using OffsetUses = std::map<size_t, OffsetUse>;

/// A reason to believe that a program is in one unit of length.
struct UnitClue {
    gcode::LengthUnit unit{};
    int weight = 0;     // 1: usual in that unit, 2: hardly ever seen in the other
    std::string reason; // "tools are given in inches (line 3)"
};

/// The clues in the comments of a program: units that they name, and sizes of tools.
std::vector<UnitClue> unit_clues_of_comments(const gcode::Program& program);

/// The clues in its feeds, which were run in `unit`: feed per revolution, feeds, travel, and travel
/// compared with a stated stock. `stock` is empty if it is not stated.
std::vector<UnitClue> unit_clues_of_feeds(const FeedFacts& facts, gcode::LengthUnit unit,
                                          const std::optional<core::Aabb>& stock);

/// The clue in where the feeds are, which were run in `unit`: they miss the stated stock, or are
/// small for it and for the tool, and would fit it in the other unit. `diameter`: of the largest
/// tool that feeds, mm.
std::optional<UnitClue> unit_clue_of_place(const OffsetUses& uses, gcode::LengthUnit unit,
                                           const core::Aabb& stock, double diameter);

/// The codes that choose the unit of a program.
struct UnitCodes {
    std::string_view mm = "G21", inch = "G20";
};

/// The finding `units-doubtful`: the clues for the other unit outweigh those for the unit of the
/// feeds. It takes more if the program states its unit. In a program that states none, a single
/// clue is a warning. `uses`: where the feeds are.
std::optional<core::Finding> units_doubtful(const gcode::Program& program, const FeedFacts& facts,
                                            const core::Setup& setup,
                                            const std::optional<core::Aabb>& stock, bool unit_said,
                                            const UnitCodes& codes = {},
                                            const OffsetUses& uses = {});

/// The finding `units-jump`: the feeds span about 25.4 times the stock or, if the program states no
/// unit, 1/25.4 of it.
std::optional<core::Finding> unit_mismatch(const FeedFacts& facts, const core::Setup& setup,
                                           const core::Aabb& stock, bool unit_said);

} // namespace app
