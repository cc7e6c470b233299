#include "core/sim/finding.h"

#include <cmath>

#include <fmt/format.h>

#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {

const char* name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::clear:
        return "clear";
    case Verdict::undecided:
        return "undecided";
    case Verdict::violation:
        return "violation";
    default:
        return "collision";
    }
}

bool is_worse(const Finding& finding, const Finding& than) {
    if (finding.shortfall != than.shortfall) return finding.shortfall > than.shortfall;
    const auto depth = [](const Finding& each) {
        return each.overlap ? each.overlap->most.value_or(infinity) : 0.0;
    };
    return depth(finding) > depth(than);
}

std::string beyond_text(const OverTravel& over_travel) {
    return fmt::format("{} {}", at_most(over_travel.beyond),
                       is_rotary(over_travel.axis) ? "degrees" : "mm");
}

std::string target_text(const OverTravel& over_travel) {
    return over_travel.is_upper ? at_most(over_travel.to) : at_least(over_travel.to);
}

std::string direction_text(const Vec3& direction) {
    constexpr double significant = 0.3; // some 17 degrees
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(direction[axis]) >= significant)
            text += fmt::format("{}{}{}", text.empty() ? "" : " ", "XYZ"[axis],
                                direction[axis] > 0.0 ? '+' : '-');
    return text;
}

std::string depth_text(const Overlap& overlap, int digits) {
    if (!overlap.most) return "at least " + clearance_at_least(overlap.least, digits);
    return overlap.least < 0.01 ? "up to " + at_most(*overlap.most, digits)
                                : bounds_text(overlap.least, *overlap.most, " to ", digits);
}

std::string depth_number(const Overlap& overlap, int digits) {
    const std::string text = depth_text(overlap, digits);
    return text.substr(text.rfind(' ') + 1);
}

std::string overlap_text(const Overlap& overlap) {
    const std::string depth = depth_text(overlap);
    if (!overlap.most) return fmt::format("The overlap is {} mm deep.", depth);
    return fmt::format("The overlap is {} mm deep; the shortest way out is towards {}.", depth,
                       direction_text(overlap.way_out));
}

Severity severity_of(const Setup& setup, const std::string& rule) {
    const auto set = setup.rules.find(rule);
    return set != setup.rules.end() ? set->second
                                    : default_severity(rule).value_or(Severity::warning);
}

void settle_severity(const Setup& setup, Finding& finding) {
    if (finding.severity != Severity::note || setup.rules.count(finding.rule))
        finding.severity = severity_of(setup, finding.rule);
}

} // namespace core
