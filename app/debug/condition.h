#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/debug/inspected_value.h"
#include "core/base/ids.h"
#include "core/sim/verdict.h"

namespace core {
struct Finding;
} // namespace core

namespace app {

struct CheckRun;

/// The facts of a block that conditions use. They come from a record or, in the window, which has
/// no record, from a row of its list.
struct BlockFacts {
    size_t block = 0;
    uint32_t line = 0;
    size_t depth = 0; // of subprogram calls
    std::string text, file;
    core::BlockMotion motion = core::BlockMotion::none;
    std::optional<core::ToolNumber> tool;
    std::optional<core::Verdict> verdict; // empty: not checked yet
    // mm; infinite beyond the search limit, empty if unknown
    std::optional<double> clearance, upper, allowance, margin;
    double removed = 0.0, duration = 0.0, time = 0.0;
    std::vector<std::string> bodies;            // of the block's pairs; only if wanted
    std::vector<const core::Finding*> findings; // about the block; only if wanted
};

/// Which of the facts to collect that take time.
struct RequiredFacts {
    bool bodies = false;
    bool findings = false;
};

/// The facts of a block of the record.
///
/// Cost: reads all findings of the record if they are wanted, because they are not sorted while the
///       record grows.
BlockFacts facts_of(const CheckRun& record, size_t block, const RequiredFacts& wanted);

/// A condition on a block, for breakpoints, filters and `until`: `clearance < 1 and rapid`.
///
/// Comparisons (< <= > >= = == != <>, or LT LE GT GE EQ NE as on controls, also chains such as
/// 0 < z < 5), `and` `or` `not` (&& || !), brackets () or [], + - * /, numbers.
///   numbers of the block: clearance (its lower bound) upper allowance margin removed duration time
///       block line depth tool
///   words of the block, for = and !=: motion verdict file rule (of any of its findings)
///   true or false: rapid feed arc cycle none; clear violation collision undecided; near (clearance
///       between the allowance and twice the allowance); finding error warning note; T3 (its tool),
///       N210; a rule's name (near-miss); a body's name in quotes ("clamp-1"); ~ "G81": the line
///       contains this text
///   values of the control before the block: #100 #<_name> R5 Q5 x machine.x G54.x and all others
///       of value_of; words only with = and !=: plane = ZX
/// `feed` and T3 are numbers when they are compared. Lengths are in mm. Numbers are compared to
/// within 1e-6. Case is ignored.
/// An unknown clearance (no motion, or beyond the search limit) is larger than any number.
class Condition {
public:
    /// Errors: syntax with the column; an unknown name, with the nearest known one.
    static core::Result<Condition> read(std::string_view text);

    const std::string& text() const { return text_; }

    /// Whether the condition uses values of the control, besides facts of the record.
    bool uses_control() const { return !uses_control_.empty(); }
    /// The first value of the control that the condition uses; empty if none.
    const std::string& control_value() const { return uses_control_; }
    /// The facts that the condition needs.
    const RequiredFacts& wanted() const { return wanted_; }

    /// A block of the record and the state of the control before it (needed only if uses_control).
    /// Without an environment, a default one for the dialect is used.
    struct Subject {
        const CheckRun& record;
        size_t block = 0;
        const gcode::InterpreterState* control = nullptr;
        const gcode::Environment* environment = nullptr;
    };
    /// Whether a block meets the condition. A comparison with an unknown value of the control is
    /// false.
    ///
    /// Cost: reads all findings of the record if the condition is about findings.
    bool holds(const Subject& subject) const;
    /// Whether a block with these facts meets the condition; values of the control are unknown.
    bool holds(const BlockFacts& facts) const;

    struct Node;
    struct Asked;

private:
    std::string text_;
    std::shared_ptr<const Node> root_;
    std::string uses_control_;
    RequiredFacts wanted_;
};

/// The value of an expression in the language of conditions for a block: a number, a word, "true"
/// or "false".
///
/// Errors: as Condition::read, and those of value_of for values of the control.
core::Result<InspectedValue> evaluate(std::string_view text, const Condition::Subject& subject);

/// Whether evaluate needs the control for an expression. False for an invalid one.
bool uses_control(std::string_view text);

/// All names of the language that begin with a text, for completion: facts of blocks, rules and
/// values of the control.
std::vector<std::string> condition_names_beginning(const std::string& text);

/// Stops a walk before each block that meets all criteria that are set.
struct Breakpoint {
    int id = 0;                   // from 1; never used twice in a session
    std::optional<uint32_t> line; // of `file`, or of the main program
    std::string file;             // of a subprogram, as CheckedBlock::file; empty: main program
    std::optional<core::ToolNumber> tool; // blocks that change to this tool
    std::string rule;                     // blocks with a finding of this rule; "finding": any
    std::optional<Condition> condition;
    bool enabled = true;
    bool temporary = false; // removed after its first stop
    size_t ignore = 0;      // number of hits still to be ignored
    size_t hits = 0;
};

/// The breakpoint in words: "line 23 if clearance < 1".
std::string text_of(const Breakpoint& breakpoint);

/// Why a walk through a program stopped.
enum class StopReason : uint8_t {
    step,        // the requested number of blocks was run
    breakpoint,  // `id`
    found,       // reached the block that was searched for
    watch,       // a watched value changed, `id`
    end,         // end of the program
    beginning,   // beginning of the program, when walking back
    error,       // the control would stop here with an alarm; see the record
    interrupted, // by is_interrupted
};

struct Stop {
    StopReason reason = StopReason::step;
    int id = 0;               // of the breakpoint or watch
    std::string message = {}; // for a watch: old and new value
};

} // namespace app
