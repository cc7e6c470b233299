#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

struct Block;
struct ControlParameter;
class ProgramParameters;

/// The answer to a question about the control: as stated, else as chosen for this run, else the
/// usual one. The premise is recorded if nothing is stated and it is met for the first time. 0 if
/// this control has no such parameter.
double number_for(InterpreterState& state, const Environment& environment, ControlQuestion question,
                  uint32_t line);

/// The same for a question that is answered by yes or no.
bool answer_to(InterpreterState& state, const Environment& environment, ControlQuestion question,
               uint32_t line);

/// The answer that this run goes by: as stated, else as chosen, else the usual one. Nothing is
/// recorded.
double current_number(const InterpreterState& state, const Environment& environment,
                      ControlQuestion question);

/// The unit of the first length of a program that states none: that of the control, which may be
/// an open premise.
LengthUnit first_unit(InterpreterState& state, const Environment& environment, uint32_t line);

/// Whether the control starts a program with the modes that an earlier one has left: as stated, or,
/// where no parameter chooses the first modes, because nothing is stated.
bool keeps_modes(const Environment& environment);

/// As keeps_modes, where it is not stated, either.
bool may_keep_modes(const Environment& environment);

/// Whether the modes of an earlier program are active at the start. Where it is not stated, this
/// meets the premise.
bool starts_with_left_modes(InterpreterState& state, const Environment& environment, uint32_t line);

/// Whether another work offset than G54 may be active at the start: the modes may be those of an
/// earlier program, and the set-up states several offsets.
bool may_start_elsewhere(const Environment& environment);

/// The index of the work offset that is active where the program has selected none. An open premise
/// whose readings are the offsets that the set-up states.
size_t first_work_offset(InterpreterState& state, const Environment& environment, uint32_t line);

/// Whether blocks with `/`, which is switch 1, or with `/2` to `/9` are skipped.
bool deletes_blocks(InterpreterState& state, const Environment& environment, int number,
                    uint32_t line);

/// A parameter that nothing states, as a premise with its readings; none is taken yet.
OpenPremise premise_of(const ControlParameter& parameter, const Environment& environment);

/// Whether a question is open: neither stated nor met before.
bool is_open(const InterpreterState& state, const Environment& environment,
             ControlQuestion question);

/// The outcome of the condition of a block. If it depends on a value that only the machine knows,
/// the premise is recorded, and the outcome may be another than the computed one. `parameters` have
/// just evaluated the condition. What the outcome says about unknown values decides later
/// conditions.
bool outcome_of(const ProgramParameters& parameters, const Block& block, Expression condition,
                const Arithmetic& arithmetic, bool computed);

/// The outcome of a condition on something that only the machine knows and no variable holds.
/// `what` names it: "an input".
bool outcome_of_input(InterpreterState& state, const Environment& environment, const Block& block,
                      const std::string& what, bool computed);

/// Warns once of each unpredictable value that a block uses as `what`, such as "X": the path
/// depends on it.
void report_unknown(const ProgramParameters& parameters, BlockCommands& result,
                    core::SourceSpan where, std::string_view what);

/// The end of a message about a number that cannot be used: names the variables that only the
/// machine knows and the number depends on. `parameters` have just evaluated it.
std::string cause_of_number(const ProgramParameters& parameters);

/// What a check can know of a variable.
enum class Knowledge : uint8_t {
    known,
    unknown_until_set, // may hold what an earlier program left
    unknown_once_set,  // set by the machine, by probing or waiting
    unknown,           // an input or a clock
};

Knowledge knowledge_of(const Environment& environment, int number);

} // namespace gcode
