#include <fmt/format.h>

#include "gcode/fanuc_parameters.h"
#include "gcode/program_parameters.h"

namespace gcode {
namespace {

bool is_fanuc(const Environment& environment) {
    return dialect(environment.dialect).system_parameters != SystemParameters::rs274;
}

} // namespace

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number) {
    if (is_fanuc(environment)) return fanuc_parameter(state, environment, number);
    const ModalState& modal = state.modal;
    if (number >= 5420 && number < 5429) {
        const auto axis = static_cast<size_t>(number - 5420);
        const double place = modal.position[axis].value_or(0.0);
        return is_rotary(axis) ? place : from_mm(place, modal.unit);
    }
    return std::nullopt;
}

std::optional<Value> system_parameter(const InterpreterState&, const Environment&,
                                      std::string_view) {
    return std::nullopt;
}

core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where) {
    if (is_fanuc(environment)) return set_fanuc_parameter(state, environment, number, value, where);
    if (number >= 5420 && number < 5429)
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("#{} is the control's own and cannot be set", number), where);
    return false;
}

} // namespace gcode
