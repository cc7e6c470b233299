#include "gcode/linuxcnc_parameters.h"
#include "gcode/program_parameters.h"

namespace gcode {

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number) {
    if (dialect(environment.dialect).state_parameters == StateParameters::linuxcnc)
        return linuxcnc_parameter(state, environment, number);
    return std::nullopt;
}

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      std::string_view name) {
    if (dialect(environment.dialect).state_parameters == StateParameters::linuxcnc)
        return linuxcnc_parameter(state, name);
    return std::nullopt;
}

core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where) {
    if (dialect(environment.dialect).state_parameters == StateParameters::linuxcnc)
        return set_linuxcnc_parameter(state, environment, number, value, where);
    return false;
}

} // namespace gcode
