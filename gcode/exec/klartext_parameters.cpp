#include "gcode/exec/klartext_parameters.h"

namespace gcode {
namespace {

constexpr int tool_radius = 108, tool_axis = 109, coolant = 111, unit_of_program = 113;
constexpr int tool_length = 114;

} // namespace

Knowledge knowledge_of_preassigned(int number) {
    if (number == coolant || number == unit_of_program) return Knowledge::known;
    const bool is_plane_angle = number >= 120 && number <= 122; // of PLANE and cycle 19
    if (number == tool_radius || number == tool_axis || number == tool_length || is_plane_angle)
        return Knowledge::unknown_until_set;
    return Knowledge::unknown;
}

std::optional<Value> q_parameter(const InterpreterState& state, int number) {
    if (number == coolant) return state.modal.mist || state.modal.flood ? 1.0 : 0.0;
    if (number == unit_of_program) return state.modal.unit == LengthUnit::inch ? 1.0 : 0.0;
    return std::nullopt;
}

} // namespace gcode
