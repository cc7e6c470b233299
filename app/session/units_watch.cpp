#include "app/session/units_watch.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/sim/finding_text.h"

namespace app {
namespace {

constexpr double inch = 25.4;
constexpr double doubt = 2.0; // a part and its stock differ by less

/// Whether a ratio of sizes is that of the two units.
bool is_units_apart(double ratio) { return ratio > inch / doubt && ratio < inch * doubt; }

} // namespace

void watch_units(UnitsWatch& watch, const core::BlockEvents& block) {
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        if (!motion || motion->kind == core::MotionKind::rapid) continue;
        for (const core::AxisPosition& end : {motion->from, motion->to}) {
            if (!end[0] || !end[1] || !end[2]) continue;
            watch.box.extend(core::Vec3(*end[0], *end[1], *end[2]));
            if (!watch.first) watch.first = block.block;
        }
    }
}

std::optional<core::Finding> units_off_the_stock(const UnitsWatch& watch, const core::Setup& setup,
                                                 const core::Aabb& stock, bool unit_said) {
    if (!watch.first) return std::nullopt;
    const core::Vec3 path = watch.box.size(), size = stock.size();
    const double longest = std::max(path.x, path.y), widest = std::max(size.x, size.y);
    if (!(longest > 0.0 && widest > 0.0)) return std::nullopt;
    const bool large = is_units_apart(longest / widest);
    const bool small = !unit_said && is_units_apart(widest / longest);
    if (!large && !small) return std::nullopt;
    core::Finding finding;
    finding.rule = "units-jump";
    finding.severity = core::severity_of(setup, finding.rule);
    finding.block = watch.first;
    finding.message =
        fmt::format("The program feeds over {:.1f} mm, the stock is {:.1f} mm: about "
                    "25.4 times as {}, as if mm and inches were taken for each other.",
                    longest, widest, large ? "much" : "little");
    finding.cure = "Look at G20 and G21, and at the unit of the set-up.";
    if (finding.severity == core::Severity::off) return std::nullopt;
    return finding;
}

} // namespace app
