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

/// What conditions ask of a block, wherever it is known from: a record, or a row of a list.
struct BlockFacts {
    size_t block = 0;
    uint32_t line = 0;
    size_t depth = 0;            // of calls
    std::string_view text, file; // what they look at must stay
    core::BlockMotion motion = core::BlockMotion::none;
    std::optional<core::ToolNumber> tool;
    std::optional<core::Verdict> verdict; // empty: nobody has looked yet
    // mm; infinite beyond the search limit, empty where nobody knows
    std::optional<double> clearance, upper, allowance, margin;
    double removed = 0.0, duration = 0.0, time = 0.0;
    std::vector<std::string> bodies;            // of its pairs; only where they are wanted
    std::vector<const core::Finding*> findings; // about it; only where they are wanted
};

/// What of the facts takes time to gather, and is left out if nobody asks for it.
struct WantedFacts {
    bool bodies = false;
    bool findings = false;
};

/// Cost: reads all findings of the record if they are wanted. While a record grows, its findings
///       are in no order.
BlockFacts facts_of(const CheckRun& record, size_t block, const WantedFacts& wanted);

/// A question about a block, as breakpoints, filters and `until` ask it: `clearance < 1 and rapid`.
///
/// Comparisons (< <= > >= = == != <>, or LT LE GT GE EQ NE as controls write them, also in chains:
/// 0 < z < 5), `and` `or` `not` (&& || !), round or square brackets, + - * /, numbers.
///   numbers of the block: clearance (its lower bound) upper allowance margin removed duration time
///       block line depth tool
///   words of the block, for = and !=: motion verdict file rule (of any of its findings)
///   true or false: rapid feed arc cycle none; clear violation collision undecided; near (it keeps
///       its allowance, but not twice); finding error warning note; T3 (its tool), N210; a rule's
///       name (near-miss); a body's name in quotes
///       ("clamp-1") that the record tells of; ~ "G81": the line has this text
///   of the control before the block: #100 #<_name> R5 Q5 x machine.x G54.x and all that value_of
///       names; words only for = and !=: plane = ZX
/// `feed` and T3 are numbers where they are compared. Lengths are in mm. Numbers are equal to
/// within 1e-6. The case of letters does not matter.
/// A clearance that nobody knows (no motion, beyond the limit) is larger than any number.
class Condition {
public:
    /// Errors: syntax with the column, and for a name that nothing has the nearest that something
    ///         has.
    static core::Result<Condition> read(std::string_view text);

    const std::string& text() const { return text_; }

    /// Whether it asks about the control, not only about what the record tells of blocks.
    bool asks_control() const { return !asks_control_.empty(); }
    /// What it asks the control for first; empty if it does not.
    const std::string& control_value() const { return asks_control_; }
    /// The facts that it cannot be answered without.
    const WantedFacts& wanted() const { return wanted_; }

    /// What a question is asked about: a block of the record, and the control before it (needed
    /// only if asks_control). Without an environment, that of its dialect as delivered.
    struct Subject {
        const CheckRun& record;
        size_t block = 0;
        const gcode::InterpreterState* control = nullptr;
        const gcode::Environment* environment = nullptr;
    };
    /// Whether it is true of a block. What the control does not know makes a comparison false.
    ///
    /// Cost: reads all findings of the record where it asks about findings.
    bool holds(const Subject& subject) const;
    /// The same where only the facts of a block are at hand: of the control nothing is known.
    bool holds(const BlockFacts& facts) const;

    struct Node;
    struct Asked;

private:
    std::string text_;
    std::shared_ptr<const Node> root_;
    std::string asks_control_;
    WantedFacts wanted_;
};

/// The value of an expression in the language of conditions, of a block: a number, a word, "true"
/// or "false".
///
/// Errors: as Condition::read, and those of value_of for what only the control can tell.
core::Result<InspectedValue> evaluate(std::string_view text, const Condition::Subject& subject);

/// Whether evaluate needs the control for it. False for what cannot be read.
bool asks_control(std::string_view text);

/// All names of the language that begin so, for completion: those of blocks, rules and the control.
std::vector<std::string> condition_names_beginning(const std::string& text);

/// Where a run through a program stops: before each block that all its parts are true of.
struct Breakpoint {
    int id = 0;                   // from 1; never used twice in a session
    std::optional<uint32_t> line; // of `file`, or of the main program
    std::string file;             // of a subprogram, as CheckedBlock::file; empty: main program
    std::optional<core::ToolNumber> tool; // blocks that change to it
    std::string rule;                     // blocks with a finding of that rule; "finding": any
    std::optional<Condition> condition;
    bool enabled = true;
    bool temporary = false; // goes when it has stopped a run
    size_t ignore = 0;      // so many times it lets a run pass
    size_t hits = 0;
};

/// As a person would say it: "line 23 if clearance < 1".
std::string text_of(const Breakpoint& breakpoint);

} // namespace app
