#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/expression.h"

namespace gcode {

/// The parameters as seen by expressions: those of the program and the system variables.
class ProgramParameters : public ParameterReader {
public:
    ProgramParameters(InterpreterState& state, const Environment& environment);

    core::Result<Value> numbered(double number, core::SourceSpan where) const override;
    core::Result<Value> named(std::string_view name, core::SourceSpan where) const override;
    bool exists(std::string_view name) const override;

    /// Errors: invalid_value when there is no such parameter, or it is read-only.
    core::Result<void> set_numbered(double number, Value value, core::SourceSpan where);
    core::Result<void> set_named(std::string_view name, Value value, core::SourceSpan where);

    /// The stored value of a number, ignoring system variables; empty if there is none.
    Value stored_value(double number) const;

    /// Restores the stored value of a parameter, or removes it. Offsets and modes set through a
    /// system variable are not changed.
    void restore_numbered(double number, Value stored_value);
    void restore_named(std::string_view name, Value value);

private:
    Frame& locals();
    const Frame& locals() const;
    bool is_global(std::string_view name) const;
    tl::unexpected<core::Error> undeclared(std::string_view name, core::SourceSpan where) const;
    const NamedValues& named_values(std::string_view name) const;

    InterpreterState& state_;
    const Environment& environment_;
    const Dialect& dialect_;
};

/// The value of a system variable; empty when the number or name is not one.
std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number);
std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      std::string_view name);

/// Sets a system variable and the state it controls; returns whether the number is one.
///
/// Errors: invalid_value when the variable is read-only.
core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where);

/// Copies the parameters of the environment to the state before the first block.
void load_parameters(InterpreterState& state, const Environment& environment);

/// Converts a value to the type of a variable.
double converted_to(VariableType type, double value);

} // namespace gcode
