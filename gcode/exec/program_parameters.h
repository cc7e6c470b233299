#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"
#include "gcode/language/expression.h"

namespace gcode {

/// The parameters as expressions of a program see them: its own ones and the system variables.
class ProgramParameters : public ParameterReader {
public:
    ProgramParameters(InterpreterState& state, const Environment& environment);

    core::Result<Value> numbered(double number, core::SourceSpan where) const override;
    core::Result<Value> named(std::string_view name, core::SourceSpan where) const override;
    bool exists(std::string_view name) const override;

    /// Errors: invalid_value when there is no such parameter, or the control keeps it itself.
    core::Result<void> set_numbered(double number, Value value, core::SourceSpan where);
    core::Result<void> set_named(std::string_view name, Value value, core::SourceSpan where);

    /// The stored value of a number, ignoring system variables; empty if there is none.
    Value kept(double number) const;

    /// Restores the stored value of a parameter, or removes it. Offsets and modes that follow a
    /// system variable are not touched.
    void restore_numbered(double number, Value kept);
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

/// The parameters in which a control shows and takes its state; empty when a number or name is not
/// one of them.
std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number);
std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      std::string_view name);

/// Whether the number is one in which the control takes its state; the state follows then.
///
/// Errors: invalid_value when the control only shows it.
core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where);

/// Takes the parameters of the environment over into the state before the first block.
void load_parameters(InterpreterState& state, const Environment& environment);

/// A value as a variable of a type holds it.
double held_as(SiemensType type, double value);

} // namespace gcode
