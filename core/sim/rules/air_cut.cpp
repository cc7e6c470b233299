#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/sim/rules/rules.h"

namespace core {
namespace {

/// Length of the shortest series that is reported, mm: approach and retract of a cut are shorter.
double least_way(double diameter) { return std::max(50.0, 5.0 * diameter); }

} // namespace

void add_air(AirSeries& series, BlockIndex block, double way) {
    if (!series.begin) series.begin = block;
    series.blocks += series.last != block;
    series.last = block;
    series.way += way;
}

std::optional<Finding> end_air(AirSeries& series, double diameter) {
    const AirSeries ended = std::exchange(series, {});
    if (!ended.begin || ended.way < least_way(diameter)) return std::nullopt;
    Finding finding;
    finding.rule = rule_id("air-cut");
    finding.block = ended.begin;
    finding.message = fmt::format("From here on, the tool feeds {:.0f} mm in {} through air, more "
                                  "than {:g} mm from the stock.",
                                  ended.way,
                                  ended.blocks == 1 ? std::string("one block")
                                                    : fmt::format("{} blocks", ended.blocks),
                                  air_gap);
    finding.cure = "Check that work offset, tool length and stock are those that the program was "
                   "made for; if so, a rapid would save time.";
    return finding;
}

} // namespace core
