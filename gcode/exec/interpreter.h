#pragma once

#include <atomic>
#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "gcode/exec/frame.h"
#include "gcode/exec/rules.h"
#include "gcode/language/canonical.h"
#include "gcode/language/parameters.h"
#include "gcode/language/tables.h"
#include "gcode/text/shared.h"

namespace gcode {

enum class ControlQuestion : uint8_t;
struct Contour;
class Digest;
struct Environment;
struct LoopDetector;
struct SplineState;

/// Whether and how a program ended.
enum class ProgramStatus : uint8_t { running, program_end, main_return, tape_mark, text_end };

/// What a language stores between two blocks in addition to the modes.
class LanguageState {
public:
    virtual ~LanguageState() = default;
    virtual std::shared_ptr<LanguageState> copy() const = 0;
    virtual bool equals(const LanguageState& other) const = 0; // of the same language
    virtual void add_to(Digest& digest) const = 0;
};

/// The state of one language. Requires a function `add(Digest&, const T&)`.
template <typename T>
class StateOf final : public LanguageState {
public:
    T value;

    std::shared_ptr<LanguageState> copy() const override {
        return std::make_shared<StateOf>(*this);
    }
    bool equals(const LanguageState& other) const override {
        return value == static_cast<const StateOf&>(other).value;
    }
    void add_to(Digest& digest) const override { add(digest, value); }
};

/// The language state of a program. Copies share it until one of them is written to. Empty for
/// languages without state.
class SharedLanguageState {
public:
    SharedLanguageState() = default;
    explicit SharedLanguageState(std::shared_ptr<LanguageState> state) : state_(std::move(state)) {}

    const LanguageState* get() const { return state_.get(); }

    /// The state as it is now; later writes do not change it.
    std::shared_ptr<const LanguageState> now() const { return state_; }

    /// T must be the state type of the active language.
    template <typename T>
    const T& as() const {
        return static_cast<const StateOf<T>&>(*state_).value;
    }
    template <typename T>
    T& write() {
        if (state_.use_count() > 1)
            state_ = state_->copy();
        else
            std::atomic_thread_fence(std::memory_order_acquire); // as in Shared
        return static_cast<StateOf<T>&>(*state_).value;
    }

    bool operator==(const SharedLanguageState& other) const {
        return state_ == other.state_ || (state_ && other.state_ && state_->equals(*other.state_));
    }

private:
    std::shared_ptr<LanguageState> state_;
};

/// Identifies a premise within a run: a property of the control, or a condition that depends on a
/// value that only the machine knows.
struct PremiseId {
    std::optional<ControlQuestion> question; // empty: a condition
    ProgramLine line{};                      // of the condition
    uint32_t occurrence = 0; // how often it was evaluated before; of a question: the switch

    auto operator<=>(const PremiseId&) const = default;
};

/// One way to read a premise.
struct Reading {
    std::string when;   // a clause: "parameter 5006#6 (TOS) is 0"
    std::string effect; // what the control then does; may be empty
};

/// A premise that the set-up leaves open and that matters to a block.
struct OpenPremise {
    PremiseId id;
    uint32_t line = 0;             // of the block
    std::string reason;            // "The set-up does not state parameter 5006#6 (TOS)"
    std::string cure;              // a sentence: how to state it
    std::vector<Reading> readings; // one if the others are not followed
    size_t taken = 0;              // index of the reading that the run follows
    bool is_chosen = false;        // that reading was chosen beforehand
    bool outcome = false;          // of a condition
    uint64_t state_digest = 0;     // of the interpreter, at a condition
};

/// What the conditions of a run have settled about values that are not known, by their identities.
struct Facts {
    std::map<std::string, PossibleValues> possible; // of what was compared with a known value
    std::map<std::string, bool> answers;            // of other conditions

    bool operator==(const Facts&) const = default;

    /// Whether two runs know the same about a value or a condition.
    bool agree_on(const std::string& identity, const Facts& other) const;
    /// Forgets what contains this part of an identity.
    void forget(std::string_view part);
};

/// A state in which a condition was passed before.
struct Passed {
    uint64_t state_digest = 0;
    uint32_t count = 0;   // of the passes in other states
    uint32_t returns = 0; // to this state
};

/// The open premises that a run has met, and those for which a reading was chosen beforehand.
struct Readings {
    std::vector<OpenPremise> met;
    std::map<PremiseId, size_t> chosen;
    Facts facts;
    std::set<std::string> repeated; // identities for which a fact has decided a condition
    std::set<std::string> reported; // values that are unknown, once each
    Shared<UnknownValues> unknown;  // values of the variables that all call levels share
    std::map<uint32_t, UnknownValue> arguments; // of the macro call of a block, by column
    std::map<ProgramLine, Passed> passed;       // conditions that facts have decided

    bool operator==(const Readings& other) const { return met.size() == other.met.size(); }
};

/// Whether a program has written lengths with a decimal point, without one, or both.
struct DecimalPoints {
    bool present = false, missing = false, said = false;
    bool counts_steps = false; // the control reads lengths without a point as least increments

    bool operator==(const DecimalPoints&) const = default;
};

/// A tool that the program calls by a name.
struct NamedTool {
    std::string name;
    core::ToolNumber number;
};

/// The state between two blocks. A plain value: copy it to step back. Copies share large members
/// until one of them changes.
struct InterpreterState {
    InterpreterState();

    ModalState modal;
    ProgramLine next; // the line to be read next
    uint32_t next_block = 0;
    bool tape_open = false; // after a %
    bool said_unit = false; // the note about assumed units was issued
    bool said_home = false; // the warning about an assumed home was issued
    bool said_time = false; // the warning about an unknown time was issued
    DecimalPoints points;
    ProgramStatus ending = ProgramStatus::running;
    bool after_end = false; // the last block was M2 or M30, on a control that runs on
    std::vector<Frame> frames = std::vector<Frame>(1); // the first is the main program
    std::vector<ModalMacro> modal_macros;              // G66, in the order programmed
    LocalParameters said{}; // Fanuc: the last values of words, by argument number
    Shared<Parameters> parameters;
    Shared<Tables> tables;
    Shared<Contour> contour; // blocks held back by cutter radius compensation
    Shared<SplineState> spline;
    SharedLanguageState language;
    bool is_iso_mode = false; // Siemens: ISO mode since G291
    Shared<LoopDetector> loops;
    std::vector<uint64_t>
        passes; // digests at the ends of passes of a main program that ends in M99
    std::vector<NamedTool> named_tools; // called by names that the set-up lacks
    RuleState rules;
    Shared<Readings> readings; // only `unknown` is restored when a block fails
};

/// Whether blocks are waiting for later ones, because of cutter radius compensation or a corner.
bool has_pending_blocks(const InterpreterState& state);

/// A hash of everything that determines how a program continues: all but the block count and the
/// search for endless loops.
uint64_t digest_of(const InterpreterState& state);

/// The state before the first block.
InterpreterState initial_state(const Environment& environment);

/// Executes programs block by block. It has no program state of its own.
class Interpreter {
public:
    /// The library and the environment must outlive it.
    Interpreter(ProgramLibrary& library, const Environment& environment);
    ~Interpreter();

    /// Executes the next block that does something. The result is valid until the next call; null
    /// when the program has ended (see `state.ending`).
    ///
    /// Errors: those of parse_line and of the codes, with file, line, column and word; endless
    ///         loops, where they can be recognised. Then `state` is as before the faulty block.
    /// Source: NISTIR 6556 (RS274/NGC v3), 3.8, order of execution.
    core::Result<const BlockCommands*> next(InterpreterState& state);

private:
    struct Scratch;
    std::unique_ptr<Scratch> scratch_;
};

/// How often a main program that M99 starts again is followed.
inline constexpr size_t most_passes = 8;

/// A warning about the end of the program: no M2 or M30, or M99.
std::optional<Warning> end_warning(const Environment& environment, const InterpreterState& state);

} // namespace gcode
