#include "app/session/program_runner.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/session/m_codes.h"
#include "core/sim/finding_text.h"
#include "gcode/error_rules.h"
#include "gcode/restart.h"

namespace app {
namespace {

/// Drops the pairs that no report tells of: a block keeps the one that decides or else is nearest,
/// and those that do not keep their allowance. Findings are in the run already.
void keep_what_tells(core::BlockResult& result) {
    const auto nearer = [](const core::PairClearance& a, const core::PairClearance& b) {
        return a.lower < b.lower;
    };
    size_t told = result.deciding.value_or(0);
    if (!result.deciding)
        told =
            static_cast<size_t>(std::min_element(result.pairs.begin(), result.pairs.end(), nearer)
                                - result.pairs.begin());
    std::vector<core::PairClearance> kept;
    for (size_t i = 0; i < result.pairs.size(); ++i) {
        if (i != told && result.pairs[i].verdict == core::Verdict::clear) continue;
        if (result.deciding == i) result.deciding = kept.size();
        kept.push_back(result.pairs[i]);
    }
    kept.shrink_to_fit();
    result.pairs = std::move(kept);
    result.findings.clear();
    result.findings.shrink_to_fit();
}

/// What follows from what a control stops at with an alarm; empty for what no rule has a name for.
std::optional<core::Finding> alarm(const core::Setup& setup, const core::Error& error) {
    core::Finding finding;
    finding.rule = gcode::rule_of(error);
    if (finding.rule.empty()) return std::nullopt;
    finding.severity = core::severity_of(setup, finding.rule);
    if (finding.severity == core::Severity::off) return std::nullopt;
    finding.message = error.message + ". The control stops here with an alarm.";
    finding.cure = finding.rule == "no-feed" ? "Say F in this block, in the unit of the feed mode."
                                             : "Look at the end, the centre and the plane of this "
                                               "arc.";
    return finding;
}

} // namespace

ProgramRunner::ProgramRunner(PreparedCheck& check)
    : check_(check),
      run_(check.run),
      runner_(check),
      place_(start_of_program(check.file.environment, run_.setup, std::move(check.machine))) {
    runner_.before_block = [this](const gcode::BlockResult& block, const ProgramPlace& before) {
        follow_cure(block, before);
    };
}

void ProgramRunner::let_judge(decltype(BlockRunner::judge) judge) {
    runner_.judge = std::move(judge);
    runner_.before_block = {};
}

core::Result<void> ProgramRunner::start_at(const std::string& line) {
    const gcode::Dialect& dialect = gcode::dialect(check_.file.environment.dialect);
    FEELER_TRY(const uint32_t number, gcode::line_meant(*check_.program, dialect, line));
    FEELER_TRY(const gcode::Restart restart,
               gcode::restart_at(*check_.library, check_.file.environment, number,
                                 run_.setup.tool_at_start));
    place_.control = restart.state;
    place_.lowering = gcode::initial_lowering(place_.control);
    run_.assumptions.push_back(fmt::format("the program is started at line {}, on a control "
                                           "that was just switched on",
                                           number));
    make_moves_before(number);
    if (restart.missing.empty()) return {};
    core::Finding finding;
    finding.rule = "restart-in-the-middle";
    finding.severity = core::severity_of(run_.setup, finding.rule);
    finding.block = core::BlockIndex{0};
    finding.message =
        fmt::format("Started here, the program cuts without what the lines before have said: "
                    "{}.",
                    fmt::join(restart.missing, ", "));
    finding.cure = "Enter that by hand first, or start at the tool change before.";
    if (finding.severity != core::Severity::off) run_.findings.push_back(finding);
    return {};
}

void ProgramRunner::make_moves_before(uint32_t line) {
    for (size_t i = 0; i < run_.setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = run_.setup.fixture_moves[i];
        bool made = move.line && *move.line < line;
        for (uint32_t before = 1; move.code && !made && before < line; ++before) {
            const auto text = check_.program->find_line(before);
            made = text && *text && has_m_code(**text, *move.code);
        }
        if (!made) continue;
        place_.moves_made.insert(i);
        place_.machine.fixtures_there[move.from] = false;
        if (move.to) place_.machine.fixtures_there[*move.to] = true;
        run_.assumptions.push_back(
            fmt::format("{} has been moved, as the lines before the start say",
                        run_.setup.fixtures[move.from].name));
    }
}

void ProgramRunner::stop(core::Error error) {
    const core::BlockIndex block{static_cast<uint32_t>(run_.blocks.size())};
    if (auto finding = alarm(runner_.setup(), error)) {
        const bool in_main = error.file == check_.program->file;
        const auto text = check_.program->find_line(error.where.line);
        run_.blocks.push_back({block,
                               error.where.line,
                               in_main && text && *text ? std::string(**text) : std::string(),
                               in_main ? std::string() : error.file,
                               {},
                               {}});
        finding->block = block;
        run_.findings.push_back(*std::move(finding));
    }
    run_.stopped = std::move(error);
}

void ProgramRunner::follow_cure(const gcode::BlockResult& block, const ProgramPlace& before) {
    const LengthWatch& lengths = before.lengths;
    const bool is_first = lengths.is_open && lengths.doubts.back().first == block.block;
    if (!lengths.is_open || is_first) end_cure();
    if (is_first) {
        followed_ = lengths.doubts.back();
        cured_ =
            std::make_unique<CuredRun>(*check_.library, check_.file.environment, runner_.setup(),
                                       check_.file.speed_by_hand, before, lengths.doubts.back());
    }
    if (cured_) cured_->follow(block, runner_.setup());
}

void ProgramRunner::end_cure() {
    if (!cured_) return;
    cured_->end(followed_);
    cures_.push_back(std::move(followed_));
    cured_.reset();
}

std::vector<LengthDoubt> ProgramRunner::length_doubts() const {
    std::vector<LengthDoubt> doubts = place_.lengths.doubts;
    for (LengthDoubt& doubt : doubts)
        for (const LengthDoubt& cure : cures_) {
            if (cure.first != doubt.first) continue;
            doubt.cured_to = cure.cured_to;
            doubt.left = cure.left;
        }
    return doubts;
}

void ProgramRunner::enter(const std::vector<core::BlockTime>& timed) {
    for (const core::BlockTime& time : timed) {
        if (core::value_of(time.block) < first_to_time_) continue;
        core::settle_time(run_.blocks[core::value_of(time.block)].result, time);
        if (on_timed) on_timed(time);
    }
}

void ProgramRunner::hold_against_stock() {
    for (core::Finding& finding : implausible_offsets(place_.offsets, runner_.setup()))
        run_.findings.push_back(std::move(finding));
    if (auto jump =
            units_off_the_stock(place_.units, runner_.setup(), place_.machine.stock.outer_box,
                                place_.control.modal.unit_said))
        run_.findings.push_back(*std::move(jump));
}

void ProgramRunner::tell_of_moves_not_made() {
    for (size_t i = 0; i < run_.setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = run_.setup.fixture_moves[i];
        if (place_.moves_made.contains(i)) continue;
        core::Finding finding;
        finding.rule = "fixture-move";
        finding.severity = core::severity_of(run_.setup, finding.rule);
        // One set-up may serve programs with and without a code; a line is meant for this one.
        if (!move.line) finding.severity = std::min(finding.severity, core::Severity::note);
        if (finding.severity == core::Severity::off) continue;
        finding.message =
            fmt::format("{} is never moved: the program {}.", run_.setup.fixtures[move.from].name,
                        move.line ? fmt::format("carries out no block of line {}", *move.line)
                                  : fmt::format("has no M{}", *move.code));
        finding.cure = move.line ? "Let the set-up name a line with a block that runs, or an "
                                   "M code."
                                 : "Write the M code that stops the program for the move.";
        run_.findings.push_back(std::move(finding));
    }
}

bool ProgramRunner::advance() {
    auto step = runner_.step(place_);
    if (!step || !*step) {
        if (!step) stop(std::move(step).error());
        end();
        return false;
    }
    CheckedBlock& checked = (**step).checked;
    run_.verdict = std::max(run_.verdict, checked.result.verdict);
    run_.removed += checked.result.removed;
    for (core::Finding& finding : (**step).findings) run_.findings.push_back(std::move(finding));
    if (runner_.setup().detail != core::Detail::every_pair) keep_what_tells(checked.result);
    if (checked.file.empty()) last_line_ = checked.line;
    run_.blocks.push_back(std::move(checked));
    enter((**step).timed);
    return true;
}

CheckProgress ProgramRunner::progress() const {
    return {run_.blocks.size(),
            static_cast<double>(last_line_) / static_cast<double>(check_.program->line_count()),
            run_.findings.size()};
}

void ProgramRunner::go_back(const RunPlace& place, size_t blocks, size_t findings) {
    assert(!place.lengths.is_open);
    place_ = place;
    first_to_time_ = blocks;
    cured_.reset();
    std::erase_if(cures_,
                  [&](const LengthDoubt& cure) { return core::value_of(cure.first) >= blocks; });
    run_.blocks.resize(blocks);
    run_.findings.resize(findings);
    run_.stopped.reset();
    run_.verdict = core::Verdict::clear;
    run_.removed = 0.0;
    last_line_ = 0;
    for (const CheckedBlock& block : run_.blocks) {
        run_.verdict = std::max(run_.verdict, block.result.verdict);
        run_.removed += block.result.removed;
        if (block.file.empty()) last_line_ = block.line;
    }
}

void ProgramRunner::end() {
    const gcode::Environment& environment = check_.file.environment;
    if (!run_.stopped)
        if (const auto warning = gcode::ending_warning(environment, place_.control))
            run_.findings.push_back(remark(runner_.setup(), *warning));
    end_cure();
    for (core::Finding& finding : core::end_of_run(runner_.setup(), place_.machine))
        run_.findings.push_back(std::move(finding));
    if (check_.stock_is_stated) hold_against_stock();
    if (!run_.stopped) tell_of_moves_not_made();
    std::vector<core::BlockTime> timed;
    core::stop_clock(place_.clock, timed);
    enter(timed);
    run_.cycle_time = place_.clock.time;
}

void ProgramRunner::stop_here() {
    const CheckedBlock& last = run_.blocks.back();
    run_.stopped = named({core::ErrorCode::io,
                          {.line = last.line, .column = 1},
                          "the check was stopped after this block: the rest of the program is "
                          "not checked",
                          last.file},
                         check_.program->file);
    end();
}

void ProgramRunner::to_the_end() {
    while (advance())
        if (after_block && !after_block(progress())) return stop_here();
}

} // namespace app
