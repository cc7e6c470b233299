#include "app/session/tool_stretch.h"

#include <cmath>

#include <fmt/format.h>

#include "app/session/value_text.h"
#include "core/sim/tool_head.h"

namespace app {
namespace {

using core::ConeStep;

constexpr double least_step = 1e-9; // mm; what is shorter is rounding

double height(const std::vector<ConeStep>& steps) {
    double sum = 0.0;
    for (const ConeStep& step : steps) sum += step.length;
    return sum;
}

/// Takes the upper end of a shank away.
void shorten(std::vector<ConeStep>& shank, double by) {
    while (by > least_step) {
        ConeStep& top = shank.back();
        if (top.length <= by + least_step) {
            by -= top.length;
            shank.pop_back();
            continue;
        }
        const double left = (top.length - by) / top.length;
        top.upper_diameter = top.lower_diameter + left * (top.upper_diameter - top.lower_diameter);
        top.length -= by;
        by = 0.0;
    }
}

/// Lets more of a shank be seen; one that was not seen at all fills the stick-out.
core::Result<void> lengthen(core::ToolDescription& tool, double by) {
    std::vector<ConeStep>& shank = tool.shank;
    if (shank.empty()) {
        FEELER_TRY(const core::ToolHead head, core::tool_head(tool));
        tool.stick_out = head.length + by;
        return {};
    }
    const ConeStep top = shank.back();
    if (top.lower_diameter == top.upper_diameter)
        shank.back().length += by;
    else
        shank.push_back({top.upper_diameter, top.upper_diameter, by});
    return {};
}

void add(std::optional<double>& length, double by) {
    if (length) *length += by;
}

} // namespace

core::Result<core::ToolAssembly> stretched(const core::ToolAssembly& tool, double length) {
    const int number = core::value_of(tool.description.number);
    if (!std::isfinite(length) || !(length > 0.0))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("T{}: a length is a number above 0", number));
    const double by = length - tool.length;
    if (std::abs(by) <= least_step) return tool;
    core::ToolDescription description = tool.description;
    add(description.gauge_length, by);
    add(description.touched_off, by);
    const bool has_holder = !description.holder.empty();
    if (!has_holder && !description.stick_out && description.gauge_length)
        return core::assemble(description);
    const double shank = height(description.shank);
    if (-by > shank + least_step)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("T{} can be no shorter than {} mm: {} then", number,
                                      number_text(tool.length - shank),
                                      has_holder ? "the holder is at its flutes"
                                                 : "nothing but its flutes is left"));
    add(description.stick_out, by);
    if (by < 0.0)
        shorten(description.shank, -by);
    else if (auto done = lengthen(description, by); !done)
        return tl::unexpected(done.error());
    return core::assemble(description);
}

} // namespace app
