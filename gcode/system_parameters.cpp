#include "gcode/fanuc_parameters.h"
#include "gcode/linuxcnc_parameters.h"
#include "gcode/program_parameters.h"
#include "gcode/siemens.h"

namespace gcode {
namespace {

bool is_siemens(const Environment& environment) {
    return dialect(environment.dialect).system_parameters == SystemParameters::siemens;
}

bool is_fanuc(const Environment& environment) {
    return dialect(environment.dialect).system_parameters >= SystemParameters::fanuc;
}

} // namespace

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number) {
    if (is_siemens(environment)) return std::nullopt;
    if (is_fanuc(environment)) return fanuc_parameter(state, environment, number);
    return linuxcnc_parameter(state, environment, number);
}

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      std::string_view name) {
    if (is_siemens(environment)) return siemens_variable(state, name);
    if (is_fanuc(environment)) return std::nullopt;
    return linuxcnc_parameter(state, environment, name);
}

core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where) {
    if (is_siemens(environment)) return false;
    if (is_fanuc(environment)) return set_fanuc_parameter(state, environment, number, value, where);
    return set_linuxcnc_parameter(state, environment, number, value, where);
}

} // namespace gcode
