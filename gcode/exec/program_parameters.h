#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/expression.h"

namespace gcode {

enum class Knowledge : uint8_t;

/// The parameters as seen by expressions: those of the program and the system variables.
class ProgramParameters : public ParameterReader {
public:
    ProgramParameters(InterpreterState& state, const Environment& environment);

    core::Result<Value> numbered(double number, core::SourceSpan where) const override;
    core::Result<Value> named(std::string_view name, core::SourceSpan where) const override;
    bool exists(std::string_view name) const override;
    std::string identity() const override { return identity_; }

    /// Errors: invalid_value when there is no such parameter, or it is read-only.
    core::Result<void> set_numbered(double number, Value value, core::SourceSpan where);
    core::Result<void> set_named(std::string_view name, Value value, core::SourceSpan where);

    /// The stored value of a number, ignoring system variables; empty if there is none.
    Value stored_value(double number) const;

    /// Restores a parameter of the call level, or removes it. Does nothing to those that all levels
    /// share: `Parameters::take_back_changes` restores them.
    void restore_local(double number, Value value);
    void restore_local(std::string_view name, Value value);

    /// The unpredictable variables that were read since the last forget_reads(), as written. Always
    /// empty unless the environment reports premises.
    const std::vector<std::string>& unpredictable_reads() const { return unpredictable_; }
    /// Whether one of them can change between two reads, as an input can.
    bool reads_vary() const { return reads_vary_; }
    void forget_reads() const;
    /// What an expression stands for that was just evaluated; empty if its value is known.
    std::optional<UnknownValue> unknown_value(const ExpressionPool& pool, Expression expression,
                                              uint32_t line) const;
    /// Records whether the value of a variable, which was just set, is unpredictable.
    void mark_numbered(double number, std::optional<UnknownValue> value);
    void mark_named(std::string_view name, std::optional<UnknownValue> value);
    /// Records that a variable was just set to a value that only the machine knows.
    void mark_unknown(double number);
    /// Records that the machine gave a variable a value that is not known.
    void renew(int number);
    /// The same for one that is shared by all call levels, by its name as written.
    void renew(const std::string& name);
    /// The unknown values among the arguments of a call, by the names of the local variables.
    void keep_argument(UnknownValues& arguments, size_t number, UnknownValue value) const;
    void keep_argument(UnknownValues& arguments, std::string name, UnknownValue value) const;

    InterpreterState& state() const { return state_; }
    const Environment& environment() const { return environment_; }

private:
    void note_read(int number, bool is_local) const;
    /// Passes on the value of a system variable that an expression reads.
    Value told(Value system_value) const;
    void note_read(std::string_view name) const;
    Knowledge knowledge_of_locals() const;
    std::string shown_name(int number) const;
    std::string shown_name(std::string_view name) const;
    bool has_identity(int number) const;
    void note_unpredictable(std::string name, std::string identity) const;
    void note_unknown(const UnknownValue& value) const;
    std::string fresh_identity(const UnknownValues& others) const;
    void keep(UnknownValues& values, std::string name, std::optional<UnknownValue> value);
    void keep_shared(std::string name, std::optional<UnknownValue> value);

    Frame& locals();
    const Frame& locals() const;
    bool is_global(std::string_view name) const;
    bool may_be_left(std::string_view name) const;
    tl::unexpected<core::Error> undeclared(std::string_view name, core::SourceSpan where) const;
    const NamedValues& named_values(std::string_view name) const;

    InterpreterState& state_;
    const Environment& environment_;
    const Dialect& dialect_;
    mutable std::vector<std::string> unpredictable_;
    mutable bool reads_vary_ = false;
    mutable std::string identity_; // of the value that was read last
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

/// Whether setting this parameter moves an offset or a reference position.
bool sets_the_machine(const Environment& environment, int number);

/// Copies the parameters of the environment to the state before the first block.
void load_parameters(InterpreterState& state, const Environment& environment);

/// Converts a value to the type of a variable.
double converted_to(VariableType type, double value);

} // namespace gcode
