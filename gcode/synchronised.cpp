#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> feed_with_spindle(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    const Word* pitch = execution.statement.word('K');
    if (!pitch)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs K, its way for each turn of the spindle", written(mover)),
            mover.span);
    const bool back_again = modal.motion == tenths(33, 1);
    if (back_again && modal.spindle == core::SpindleDirection::stopped)
        return core::fail(ErrorCode::missing_value,
                          "G33.1 taps with a turning spindle, and it stands still: start it with "
                          "M3 or M4",
                          mover.span);
    FEELER_TRY(const Position end, target_of(execution));
    execution.emit(ThreadFeed{end, length_of(execution, *pitch), back_again});
    if (!back_again) modal.position = end;
    return {};
}

core::Result<void> probe(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    if (modal.feed_mode != FeedMode::per_minute)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: a probe feeds in mm a minute: say G94", written(mover)),
                          mover.span);
    FEELER_TRY(const Position end, target_of(execution));
    const std::optional<double> way = way_between(modal.position, end);
    FEELER_TRY(const double rate, feed_rate(execution, way));
    if (way && *way < 0.254)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: the probe starts too near to where it should end", written(mover)),
            mover.span);
    const int kind = *modal.motion % 10;
    execution.warn(mover.span,
                   fmt::format("{}: where the probe meets something is not known before; the whole "
                               "way is looked at, and the program goes on from its end",
                               written(mover)));
    execution.emit(StraightProbe{end, rate, kind == 2 || kind == 3, kind == 2 || kind == 4});
    modal.position = end;
    Parameters& parameters = execution.state.parameters.write();
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const double value = end[axis].value_or(0.0);
        parameters.set_numbered(static_cast<int>(5061 + axis),
                                is_rotary(axis) ? value : from_mm(value, modal.unit));
    }
    parameters.set_numbered(5070, 1.0);
    return {};
}

} // namespace gcode
