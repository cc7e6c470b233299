#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {

struct BlockStep;
struct PreparedCheck;

/// The most readings that a check follows besides the one it assumes.
inline constexpr size_t most_readings = 64;

/// Identifies a finding in the program, independently of the block count: rule, file, line, bodies.
using FindingKey = std::tuple<std::string, std::string, uint32_t, std::string, std::string>;

/// Follows the other readings of the premises that a program meets. A reading is run from the block
/// where the premise matters to the end of the program, or to a condition that another reading
/// reached in the same state.
class OtherReadings {
public:
    explicit OtherReadings(const PreparedCheck& check) : check_(check) {}

    /// Whether the program may be run again from the middle after its end, as a debugger does. Then
    /// the states before the premises are kept.
    bool may_go_back = false;

    unsigned threads = 1; // that each run may use

    /// Notes the premises of the block that the control has just read. `before` is the state before
    /// it, and `blocks` the number of blocks run so far. Returns whether another reading has been
    /// here in the same state.
    bool note(const RunState& before, const gcode::InterpreterState& after, size_t blocks);

    /// Whether rapids may be dog-legs, because nothing states what they are.
    bool has_open_rapids() const;

    /// Notes a block of the assumed reading whose rapids are worse as dog-legs.
    void note_dog_legs(const BlockStep& step);

    /// Forgets the premises met from a block on.
    void forget_from(size_t blocks);

    /// Runs all readings and adds the results to the record, whose verdict becomes the worst of
    /// all. Premises for which one reading has an error become findings.
    ///
    /// `last`: the control after the last block of the assumed reading. `goes_on`: polled from time
    /// to time; false: stop.
    void follow(CheckRecord& record, const gcode::InterpreterState& last,
                const std::function<bool()>& goes_on);

private:
    using Crossing = std::pair<gcode::PremiseId, uint64_t>; // a condition and the state at it

    /// A premise of which only the assumed reading is followed.
    struct Assumed {
        size_t block;
        std::string clause;
    };

    /// What is wrong in a run and in those that it branches off from.
    struct Outcome {
        std::set<FindingKey> errors;
        core::Verdict verdict = core::Verdict::clear;
    };

    /// A run that is still to be made.
    struct Fork {
        RunState state; // before the block
        ReadingResult result;
        // Of the run that it branches off from, whose findings are not its own. Null: the reading
        // that the check assumes.
        std::shared_ptr<const Outcome> parent;
        std::optional<Crossing> goes_past = {}; // it was stopped there, and goes on
    };

    /// A run that was stopped where another one had been in the same state, but knows
    /// other facts. It goes on if one of them decides a condition later.
    struct StoppedRun {
        Fork fork;
        std::vector<gcode::Facts> others;
    };

    /// A block whose rapids are worse as dog-legs.
    struct BentBlock {
        core::BlockIndex block{};
        uint32_t line = 0;
        std::string file;
        core::Verdict verdict = core::Verdict::clear;
        std::vector<core::Finding> errors;
    };

    void assume(const gcode::OpenPremise& premise, size_t blocks);
    /// The reading in which rapids are dog-legs, in another reading or, without one, the assumed
    /// one.
    ReadingResult bent_reading(const std::vector<BentBlock>& blocks, const ReadingResult* in) const;
    ReadingResult run(Fork fork, const CheckRecord& record, const std::function<bool()>& goes_on,
                      std::set<FindingKey>& new_errors);
    bool is_known(const Crossing& crossing, const RunState& before);
    void add_fork(Fork fork);
    void resume_runs();

    const PreparedCheck& check_;
    std::vector<Fork> forks_;
    const Fork* running_ = nullptr;    // null: the reading that the check assumes
    std::shared_ptr<Outcome> outcome_; // of the running one
    std::map<Crossing, std::vector<gcode::Facts>> visited_;
    std::vector<StoppedRun> stopped_;
    std::set<std::string> repeated_; // identities for which facts have decided a condition
    std::vector<Assumed> assumed_;
    std::vector<BentBlock> bent_;                     // of the reading that the check assumes
    std::vector<ReadingResult> bent_readings_;        // of the others
    core::Verdict worst_bent_ = core::Verdict::clear; // likewise
    bool has_too_many_ = false;
    std::optional<size_t> too_many_from_; // block of the assumed reading where it was noticed
};

} // namespace app
