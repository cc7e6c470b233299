#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;

/// Adds under G91, replaces under G90.
void write(const Execution& execution, double value, double& place) {
    const bool adds = execution.dialect.offset_writes_follow_g91
                      && execution.modal().distance == DistanceMode::incremental;
    place = (adds ? place : 0.0) + value;
}

} // namespace

core::Result<void> write_fanuc_entry(Execution& execution, int kind) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const Word* number = execution.statement.word('P');
    const Word* value = execution.statement.word('R');
    if (!number || !value)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("G10 L{} needs {}", kind,
                                      number ? "an R word, the value" : "a P word, the number"),
                          entry.word->span);
    FEELER_TRY(const int index, whole_number(*number, 1, 999));
    const bool is_active = execution.modal().length_sign != 0.0
                           && execution.modal().length_number == OffsetNumber(index);
    Tables& tables = execution.state.tables.write();
    const bool known = tables.lengths.count(OffsetNumber(index)) != 0;
    const double length = known ? 0.0 : length_under(tables, index).value_or(0.0);
    LengthOffset& offset = tables.lengths[OffsetNumber(index)];
    if (!known) offset.length = length;
    const double written_value = length_of(execution, *value);
    const double radii = execution.dialect.diameters_in_tool_entries ? 1.0 : 2.0;
    switch (kind) {
    case 10:
        write(execution, written_value, offset.length);
        break;
    case 11:
        write(execution, written_value, offset.wear);
        break;
    case 12:
        write(execution, radii * written_value, offset.diameter);
        break;
    default:
        write(execution, 0.5 * radii * written_value, offset.radius_wear);
        break;
    }
    if (is_active && kind <= 11)
        execution.warn(value->span,
                       fmt::format("H{} is in use: the new length is taken from the next G43 or H "
                                   "on, which a parameter of the control may change",
                                   index));
    return {};
}

core::Result<void> write_external_offset(Execution& execution) {
    AxisValues& external = execution.state.tables.write().external;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            write(execution, axis_value(execution, axis, *word), external[axis]);
    return {};
}

void pass_over_data(Execution& execution, const Word& kind) {
    execution.warn(kind.span,
                   fmt::format("G10 {}: tool lives and parameters of the control are not kept "
                               "here; what stands up to G11 changes nothing",
                               written(kind)));
}

} // namespace gcode
