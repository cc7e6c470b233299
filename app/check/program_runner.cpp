#include "app/check/program_runner.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/block_events.h"
#include "app/check/block_runner.h"
#include "app/check/conclusion.h"
#include "app/check/other_readings.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "core/base/rule_table.h"
#include "gcode/exec/restart.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {

/// Runs the blocks of a length mismatch with the control using the tool's true length. A finding
/// that also occurs in this run is not caused by the wrong length.
///
/// Cost: that of the check itself, for these blocks.
class CorrectedRun {
public:
    /// Starts before the first block of the mismatch. Library, environment and set-up must outlive
    /// it; the library is that of the run.
    CorrectedRun(gcode::ProgramLibrary& library, const gcode::Environment& environment,
                 const core::Setup& setup, bool speed_by_hand, const RunState& before,
                 const LengthMismatch& mismatch);

    /// Runs the block that the program has just run under `setup`. Does nothing once the corrected
    /// program has taken another branch or the set-up was replaced.
    void follow(const gcode::BlockCommands& real, const core::Setup& setup);

    /// Returns the mismatch with the findings of this run.
    LengthMismatch end();

private:
    void apply_length();
    /// Gives G43 without H, at which the mismatch begins, the length of the tool.
    void give_number(const gcode::BlockCommands& block);

    const core::Setup& setup_;
    bool speed_by_hand_;
    LengthMismatch mismatch_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState control_;
    gcode::Lowering lowering_;
    core::SimulatorState machine_;
    OffsetUses offsets_;
    bool is_lost_ = false;
    std::optional<core::BlockIndex> last_; // last block that was run
    std::vector<core::Finding> found_;
};

CorrectedRun::CorrectedRun(gcode::ProgramLibrary& library, const gcode::Environment& environment,
                           const core::Setup& setup, bool speed_by_hand, const RunState& before,
                           const LengthMismatch& mismatch)
    : setup_(setup),
      speed_by_hand_(speed_by_hand),
      mismatch_(mismatch),
      interpreter_(library, environment),
      control_(before.control),
      lowering_(before.lowering),
      machine_(before.machine),
      offsets_(before.offsets) {
    if (!mismatch.number) return;
    gcode::LengthOffset& entry = control_.tables.write().lengths[*mismatch.number];
    entry.length = mismatch.length;
    entry.wear = 0.0;
}

void CorrectedRun::apply_length() {
    const gcode::Offsets& offsets = control_.modal.offsets;
    if (offsets.tool[2] == mismatch_.length) return;
    gcode::Offsets corrected = offsets;
    corrected.tool[2] = lowering_.offsets.tool[2] = mismatch_.length;
    gcode::change_offsets(control_.modal, corrected);
}

void CorrectedRun::give_number(const gcode::BlockCommands& block) {
    if (mismatch_.number || block.block != mismatch_.first || !machine_.tool) return;
    const bool sets_none =
        std::ranges::any_of(block.commands, [](const gcode::CanonicalCommand& command) {
            const auto* length = std::get_if<gcode::UseToolLengthOffset>(&command);
            return length && !length->number;
        });
    if (!sets_none) return;
    const core::OffsetNumber number{core::value_of(*machine_.tool)};
    gcode::LengthOffset& entry = control_.tables.write().lengths[number];
    entry.length = mismatch_.length;
    entry.wear = 0.0;
    control_.modal.length_number = number;
}

void CorrectedRun::follow(const gcode::BlockCommands& real, const core::Setup& setup) {
    is_lost_ = is_lost_ || &setup != &setup_;
    if (is_lost_) return;
    apply_length();
    give_number(real);
    const auto next = interpreter_.next(control_);
    is_lost_ = !next || !*next || (*next)->block != real.block || (*next)->line != real.line
               || (*next)->file != real.file;
    if (is_lost_) return;
    const gcode::BlockCommands& block = **next;
    const std::vector<core::Event> events = events_of(setup_, block, lowering_, speed_by_hand_);
    const core::BlockEvents of_block{block.block,     block.is_cycle,   events,
                                     block.goes_home, block.in_machine, real.path};
    core::BlockResult result = core::run_block(setup_, of_block, machine_);
    is_lost_ = !result.checked;
    if (is_lost_) return;
    for (core::Finding& finding : result.findings) found_.push_back(std::move(finding));
    track_offsets(offsets_, setup_, lowering_.offsets, of_block, machine_);
    last_ = block.block;
}

LengthMismatch CorrectedRun::end() {
    const auto tool = machine_.tool ? setup_.tools.find(*machine_.tool) : setup_.tools.end();
    if (tool != setup_.tools.end())
        if (auto air = core::end_air(machine_.rules.air, tool->second.description.diameter))
            found_.push_back(*std::move(air));
    const core::Aabb& stock = machine_.stock.outer_box;
    for (core::Finding& finding : implausible_offsets(offsets_, setup_, stock))
        found_.push_back(std::move(finding));
    if (auto nothing = nothing_cut(offsets_, setup_, stock, true))
        found_.push_back(*std::move(nothing));
    mismatch_.corrected_to = last_;
    mismatch_.remaining = std::move(found_);
    return std::move(mismatch_);
}

namespace {

/// Whether a motion depends on a value that only the machine knows.
bool is_unknown_value(const core::Finding& finding) {
    return finding.rule == core::rule_id("unknown-value")
           && finding.severity == core::Severity::error;
}

/// Drops the pairs that no report shows. Keeps the deciding pair, else the nearest, and all pairs
/// that are not clear. Findings of the block are already in the run.
void drop_unreported(core::BlockResult& result) {
    const auto nearer = [](const core::PairClearance& a, const core::PairClearance& b) {
        return a.lower < b.lower;
    };
    size_t shown = result.deciding.value_or(0);
    if (!result.deciding)
        shown =
            static_cast<size_t>(std::min_element(result.pairs.begin(), result.pairs.end(), nearer)
                                - result.pairs.begin());
    std::vector<core::PairClearance> remaining_pairs;
    for (size_t i = 0; i < result.pairs.size(); ++i) {
        if (i != shown && result.pairs[i].verdict == core::Verdict::clear) continue;
        if (result.deciding == i) result.deciding = remaining_pairs.size();
        remaining_pairs.push_back(result.pairs[i]);
    }
    remaining_pairs.shrink_to_fit();
    result.pairs = std::move(remaining_pairs);
    result.findings.clear();
    result.findings.shrink_to_fit();
}

} // namespace

ProgramRunner::ProgramRunner(PreparedCheck& check)
    : check_(check),
      input_(check.run),
      record_(check.run),
      runner_(std::make_unique<BlockRunner>(check)),
      readings_(std::make_unique<OtherReadings>(check)),
      state_(std::make_unique<RunState>(
          start_of_program(check.file.environment, input_.setup, std::move(*check.machine)))) {
    runner_->follows_dog_legs = readings_->has_open_rapids();
    runner_->before_block = [this](const gcode::BlockCommands& block, const RunState& before) {
        follow_correction(block, before);
    };
    runner_->after_reading = [this](const RunState& before, const gcode::InterpreterState& after) {
        readings_->note(before, after, record_.blocks.size());
    };
}

ProgramRunner::~ProgramRunner() = default;

void ProgramRunner::use_threads(unsigned threads, size_t first) {
    runner_->use_threads(threads, first);
    readings_->threads = threads;
}

void ProgramRunner::work_alone() { runner_->work_alone(); }

size_t ProgramRunner::foreseen_blocks() const { return runner_->foreseen_blocks(); }

void ProgramRunner::use_judge(BlockJudge judge) {
    runner_->judge = std::move(judge);
    runner_->before_block = {};
}

RunState& ProgramRunner::mutable_state() {
    runner_->work_alone();
    return *state_;
}

const core::SimulatorState& ProgramRunner::machine() const { return state_->machine; }

std::optional<NextBlock> ProgramRunner::next_block() {
    return first_block(
        [this](const BlockVisit& visit) {
            runner_->visit_ahead(state_->control, state_->lowering, visit);
        },
        check_.file.has_axes);
}

void ProgramRunner::use(const core::Setup& setup) { runner_->use(setup); }

core::Result<void> ProgramRunner::start_at(const std::string& line) {
    const gcode::DialectId dialect = check_.file.environment.dialect;
    FEELER_TRY(const uint32_t number, gcode::line_meant(*check_.program, dialect, line));
    FEELER_TRY(const gcode::Restart restart,
               gcode::restart_at(*check_.library, check_.file.environment, number,
                                 input_.setup.tool_at_start));
    state_->control = restart.state;
    is_partial_ = true;
    state_->lowering = gcode::initial_lowering(state_->control);
    record_.later_assumptions.push_back(fmt::format(
        "the program starts at line {}, with the control in its power-on state", number));
    make_moves_before(number);
    if (restart.missing.empty()) return {};
    core::Finding finding;
    finding.rule = core::rule_id("restart-in-the-middle");
    finding.severity = core::severity_of(input_.setup, finding.rule);
    finding.block = core::BlockIndex{0};
    finding.message =
        fmt::format("Started here, the program cuts without settings of earlier lines: {}.",
                    fmt::join(restart.missing, ", "));
    finding.cure = "Enter them by hand first, or start at the previous tool change.";
    if (finding.severity != core::Severity::off) record_.findings.push_back(finding);
    return {};
}

void ProgramRunner::make_moves_before(uint32_t line) {
    for (size_t i = 0; i < input_.setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = input_.setup.fixture_moves[i];
        bool made = move.line && *move.line < line;
        for (uint32_t before = 1; move.code && !made && before < line; ++before) {
            const auto text = check_.program->find_line(before);
            made = text && *text && has_m_code(**text, *move.code);
        }
        if (!made) continue;
        state_->moves_made.insert(i);
        state_->machine.mounted_fixtures[move.from] = false;
        if (move.to) state_->machine.mounted_fixtures[*move.to] = true;
        record_.later_assumptions.push_back(
            fmt::format("{} has been moved, as stated in lines before the start",
                        input_.setup.fixtures[move.from].name));
    }
}

void ProgramRunner::add_last_block(const core::Error& error, core::Finding finding) {
    const core::BlockIndex block{static_cast<uint32_t>(record_.blocks.size())};
    const bool in_main = error.file == check_.program->file;
    const auto text = check_.program->find_line(error.where.line);
    record_.blocks.push_back({block,
                              error.where.line,
                              in_main && text && *text ? std::string(**text) : std::string(),
                              in_main ? std::string() : error.file,
                              {},
                              {}});
    finding.block = block;
    record_.findings.push_back(std::move(finding));
}

void ProgramRunner::stop(core::Error error) {
    if (!check_.file.not_judged.empty()
        && !gcode::has_lathe_codes(check_.file.environment.dialect)) {
        // What a mill's control makes of the block is irrelevant: the motions are not judged.
        core::Finding finding;
        finding.rule = core::rule_id("undecided");
        finding.severity = core::Severity::error;
        finding.message = "The program was read up to this block, which is written for a lathe.";
        finding.cure = "Check the program on the lathe's own control.";
        record_.verdict = std::max(record_.verdict, core::Verdict::undecided);
        add_last_block(error, std::move(finding));
        return;
    }
    if (auto finding = alarm_finding(runner_->setup(), error))
        add_last_block(error, *std::move(finding));
    record_.stopped = std::move(error);
}

void ProgramRunner::follow_correction(const gcode::BlockCommands& block, const RunState& before) {
    const LengthTracker& lengths = before.lengths;
    const bool is_first = lengths.is_open && lengths.mismatches.back().first == block.block;
    if (!lengths.is_open || is_first) end_correction();
    if (is_first)
        correction_ = std::make_unique<CorrectedRun>(*check_.library, check_.file.environment,
                                                     runner_->setup(), check_.file.speed_by_hand,
                                                     before, lengths.mismatches.back());
    if (correction_) correction_->follow(block, runner_->setup());
}

void ProgramRunner::end_correction() {
    if (!correction_) return;
    corrections_.push_back(correction_->end());
    correction_.reset();
}

std::vector<LengthMismatch> ProgramRunner::length_mismatches() const {
    std::vector<LengthMismatch> mismatches = state_->lengths.mismatches;
    for (LengthMismatch& mismatch : mismatches)
        for (const LengthMismatch& correction : corrections_) {
            if (correction.first != mismatch.first) continue;
            mismatch.corrected_to = correction.corrected_to;
            mismatch.remaining = correction.remaining;
        }
    return mismatches;
}

void ProgramRunner::enter(const std::vector<core::BlockTime>& timed) {
    for (const core::BlockTime& time : timed) {
        if (core::value_of(time.block) < first_to_time_) continue;
        record_.blocks.settle_time(core::value_of(time.block), time);
        if (on_timed) on_timed(time);
    }
}

namespace {

/// The first block in which the program uses a value that only the machine knows. From there on,
/// feeds may be elsewhere.
std::optional<core::BlockIndex> first_unknown_value(const CheckRecord& record) {
    std::optional<core::BlockIndex> first;
    for (const core::Finding& finding : record.findings)
        if (finding.rule == core::rule_id("unknown-value") && finding.block
            && (!first || *finding.block < *first))
            first = finding.block;
    return first;
}

} // namespace

void ProgramRunner::compare_with_stock() {
    const core::Setup& setup = runner_->setup();
    const core::Aabb& stock = state_->machine.stock.outer_box;
    const auto first = first_unknown_value(record_);
    std::vector<core::Finding> offsets = implausible_offsets(state_->offsets, setup, stock);
    std::erase_if(offsets, [&](const core::Finding& finding) {
        return first && finding.block && *finding.block >= *first;
    });
    const bool ran_whole = !record_.stopped && !is_partial_;
    if (ran_whole && !first)
        if (auto nothing = nothing_cut(state_->offsets, setup, stock, !offsets.empty()))
            record_.findings.push_back(*std::move(nothing));
    for (core::Finding& finding : offsets) record_.findings.push_back(std::move(finding));
}

void ProgramRunner::report_missing_moves() {
    for (size_t i = 0; i < input_.setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = input_.setup.fixture_moves[i];
        if (state_->moves_made.contains(i)) continue;
        core::Finding finding;
        finding.rule = core::rule_id("fixture-move");
        finding.severity = core::severity_of(input_.setup, finding.rule);
        // A set-up with a code may serve programs without it, but a line refers to this program.
        if (!move.line) finding.severity = std::min(finding.severity, core::Severity::note);
        if (finding.severity == core::Severity::off) continue;
        finding.message =
            fmt::format("{} is never moved: the program {}.", input_.setup.fixtures[move.from].name,
                        move.line ? fmt::format("executes no block of line {}", *move.line)
                                  : fmt::format("has no M{}", *move.code));
        finding.cure = move.line ? "In the set-up, name a line that is executed, or an M code."
                                 : "Add the M code that stops the program for the move.";
        record_.findings.push_back(std::move(finding));
    }
}

bool ProgramRunner::advance() {
    auto step = runner_->step(*state_);
    if (!step || !*step) {
        if (!step) stop(std::move(step).error());
        end();
        return false;
    }
    readings_->note_dog_legs(**step);
    CheckedBlock& checked = (**step).checked;
    record_.verdict = std::max(record_.verdict, checked.result.verdict);
    record_.removed += checked.result.removed;
    for (core::Finding& finding : (**step).findings) {
        if (is_unknown_value(finding))
            record_.verdict = std::max(record_.verdict, core::Verdict::undecided);
        record_.findings.push_back(std::move(finding));
    }
    if (runner_->setup().detail != core::Detail::every_pair) drop_unreported(checked.result);
    if (checked.file.empty()) last_line_ = checked.line;
    record_.blocks.push_back(checked);
    enter((**step).timed);
    return true;
}

CheckProgress ProgramRunner::progress() const {
    return {record_.blocks.size(),
            static_cast<double>(last_line_) / static_cast<double>(check_.program->line_count()),
            record_.findings.size()};
}

void ProgramRunner::keep_readings() { readings_->may_go_back = true; }

void ProgramRunner::go_back(const RunState& state, size_t blocks, size_t findings) {
    assert(!state.lengths.is_open);
    runner_->work_alone();
    *state_ = state;
    first_to_time_ = blocks;
    correction_.reset();
    std::erase_if(corrections_,
                  [&](const LengthMismatch& done) { return core::value_of(done.first) >= blocks; });
    record_.blocks.truncate(blocks);
    record_.findings.resize(findings);
    record_.stopped.reset();
    readings_->forget_from(blocks);
    record_.readings.clear();
    record_.verdict = core::Verdict::clear;
    record_.removed = 0.0;
    last_line_ = 0;
    for (const CheckedBlock& block : record_.blocks.without_texts()) {
        record_.verdict = std::max(record_.verdict, block.result.verdict);
        record_.removed += block.result.removed;
        if (block.file.empty()) last_line_ = block.line;
    }
    if (std::any_of(record_.findings.begin(), record_.findings.end(), is_unknown_value))
        record_.verdict = std::max(record_.verdict, core::Verdict::undecided);
}

void ProgramRunner::end() {
    const gcode::Environment& environment = check_.file.environment;
    if (!record_.stopped)
        if (const auto warning = gcode::end_warning(environment, state_->control))
            record_.findings.push_back(finding_of(runner_->setup(), *warning));
    end_correction();
    for (core::Finding& finding : core::end_of_run(runner_->setup(), state_->machine))
        record_.findings.push_back(std::move(finding));
    if (check_.stock_is_stated) compare_with_stock();
    for (core::Finding& finding : implausible_findings(check_, record_, *state_, runner_->setup()))
        record_.findings.push_back(std::move(finding));
    if (!record_.stopped) report_missing_moves();
    std::vector<core::BlockTime> timed;
    core::stop_clock(state_->clock, timed);
    enter(timed);
    check_.run.cycle_time = state_->clock.time;
}

void ProgramRunner::stop_here() {
    runner_->work_alone();
    const CheckedBlock last = record_.blocks.back();
    record_.stopped = core::in_file(
        {core::ErrorCode::io,
         {.line = last.line, .column = 1},
         "the check was stopped after this block; the rest of the program is not checked",
         last.file},
        check_.program->file);
    end();
}

void ProgramRunner::run_to_end() {
    while (advance())
        if (after_block && !after_block(progress())) return stop_here();
}

void ProgramRunner::conclude(bool needs_surface) {
    runner_->work_alone();
    readings_->follow(record_, state_->control,
                      [this] { return !after_block || after_block(progress()); });
    app::conclude(check_, state_->machine, length_mismatches(), needs_surface);
}

} // namespace app
