#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

core::Error refusal(const Word& word, core::ErrorCode code, std::string_view why) {
    return {code, word.span, fmt::format("{}: {}", written(word), why)};
}

} // namespace

core::Result<void> place_by_angle(const Execution& execution, Position& target) {
    const Word* angle = execution.statement.angle;
    if (!angle) return {};
    using core::ErrorCode;
    const ModalState& modal = execution.modal();
    if (modal.cycle || (modal.motion != tenths(0) && modal.motion != tenths(1)))
        return tl::unexpected(
            refusal(*angle, ErrorCode::syntax, "an angle gives the direction of a G0 or G1"));
    const PlaneAxes axes = axes_of(modal.plane);
    const bool first = execution.statement.word(axis_letters[axes.first]) != nullptr;
    const bool second = execution.statement.word(axis_letters[axes.second]) != nullptr;
    const std::string both =
        fmt::format("{} or {}", axis_letters[axes.first], axis_letters[axes.second]);
    if (first && second)
        return tl::unexpected(refusal(*angle, ErrorCode::syntax,
                                      fmt::format("beside an angle stands {}, not both", both)));
    if (!first && !second)
        return tl::unexpected(
            refusal(*angle, ErrorCode::unsupported,
                    fmt::format("a line to where it crosses the next one is not supported yet: "
                                "write {} as well",
                                both)));
    const size_t given = first ? axes.first : axes.second;
    const size_t other = first ? axes.second : axes.first;
    if (!modal.position[given] || !modal.position[other])
        return tl::unexpected(refusal(*angle, ErrorCode::missing_value,
                                      "where the line begins is unknown: move there first"));
    const double radians = angle->value * std::numbers::pi / 180.0;
    const double along = first ? std::cos(radians) : std::sin(radians);
    const double across = first ? std::sin(radians) : std::cos(radians);
    const double way = *target[given] - *modal.position[given];
    if (std::abs(along) < 1e-9)
        return tl::unexpected(refusal(*angle, ErrorCode::invalid_value,
                                      fmt::format("in this direction {} does not change: write {}",
                                                  axis_letters[given], axis_letters[other])));
    target[other] = *modal.position[other] + way * across / along;
    return {};
}

} // namespace gcode
