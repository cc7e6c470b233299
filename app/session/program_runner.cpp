#include "app/session/program_runner.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/session/block_events.h"
#include "app/session/m_codes.h"
#include "core/sim/finding_text.h"
#include "gcode/error_rules.h"
#include "gcode/restart.h"

namespace app {
namespace {

/// As a sentence: with a capital, but for names, and a full stop.
std::string as_sentence(std::string text) {
    const auto is_small = [&](size_t i) {
        return i < text.size()
               && (std::islower(static_cast<unsigned char>(text[i])) || text[i] == ' ');
    };
    if (is_small(0) && is_small(1))
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

core::Finding remark(const core::Setup& setup, const gcode::Warning& warning) {
    core::Finding finding;
    finding.rule = warning.rule;
    finding.severity = core::default_severity(finding.rule).value_or(core::Severity::warning);
    if (warning.severity == gcode::Severity::note) finding.severity = core::Severity::note;
    if (const auto set = setup.rules.find(finding.rule); set != setup.rules.end())
        finding.severity = set->second;
    finding.message = as_sentence(warning.message);
    finding.cure = warning.cure;
    return finding;
}

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

} // namespace

core::Error named(core::Error error, const std::string& file) {
    if (error.file.empty()) error.file = file;
    return error;
}

core::Result<void> ProgramRunner::start_at(const std::string& line) {
    const gcode::Dialect& dialect = gcode::dialect(environment_.dialect);
    FEELER_TRY(const uint32_t number, gcode::line_meant(program_, dialect, line));
    FEELER_TRY(const gcode::Restart restart,
               gcode::restart_at(library_, environment_, number, run_.setup.tool_at_start));
    place_ = restart.state;
    lowering_ = gcode::initial_lowering(place_);
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
            const auto text = program_.find_line(before);
            made = text && *text && has_m_code(**text, *move.code);
        }
        if (!made) continue;
        moves_made_.insert(i);
        run_.assumptions.push_back(
            fmt::format("{} has been moved, as the lines before the start say",
                        run_.setup.fixtures[move.from].name));
    }
}

void ProgramRunner::stop(core::Error error) {
    run_.stopped = named(std::move(error), program_.file);
    const std::string rule(gcode::rule_of(*run_.stopped));
    const core::Severity severity = core::severity_of(run_.setup, rule);
    if (rule.empty() || severity == core::Severity::off) return;
    const bool in_main = run_.stopped->file == program_.file;
    const auto text = program_.find_line(run_.stopped->where.line);
    const core::BlockIndex block{static_cast<uint32_t>(run_.blocks.size())};
    run_.blocks.push_back({block,
                           run_.stopped->where.line,
                           in_main && text && *text ? std::string(**text) : std::string(),
                           in_main ? std::string() : run_.stopped->file,
                           {},
                           {}});
    core::Finding finding;
    finding.rule = rule;
    finding.severity = severity;
    finding.block = block;
    finding.message = run_.stopped->message + ". The control stops here with an alarm.";
    finding.cure = rule == "no-feed" ? "Say F in this block, in the unit of the feed mode."
                                     : "Look at the end, the centre and the plane of this arc.";
    run_.findings.push_back(finding);
}

std::optional<core::Error> ProgramRunner::refusal(const gcode::BlockResult& block) const {
    if (lowering_.moved_tilted)
        return core::Error{core::ErrorCode::unsupported,
                           {.line = block.line, .column = 1},
                           "this block moves in a tilted plane or with a tool that is turned, "
                           "and the machine of the set-up has no rotary axes that could: add "
                           "them as [[axis]]",
                           std::string(block.file)};
    if (!lowering_.other_axis) return std::nullopt;
    return core::Error{core::ErrorCode::unsupported,
                       {.line = block.line, .column = 1},
                       fmt::format("this block moves axis {}, which the machine of the set-up "
                                   "does not have: add an [[axis]] of that name to its machine",
                                   gcode::axis_letters[*lowering_.other_axis]),
                       std::string(block.file)};
}

void ProgramRunner::remark_on(const gcode::BlockResult& block) {
    for (const gcode::Warning& warning : block.warnings) {
        // What the set-up states is stated, be it all zero.
        const auto active = static_cast<int>(place_.modal.offsets.active);
        if (warning.rule == "work-offset-unset" && offsets_stated.contains(active)) continue;
        core::Finding finding = remark(run_.setup, warning);
        finding.block = block.block;
        if (finding.severity != core::Severity::off) run_.findings.push_back(finding);
    }
}

std::optional<core::Error> ProgramRunner::block(const gcode::BlockResult& block,
                                                core::SimulatorState& state) {
    const gcode::Lowering lowering_before = lowering_;
    const std::vector<core::Event> events = events_of(run_.setup, block, lowering_, speed_by_hand);
    for (const size_t move : fixture_moves_of(run_.setup, block)) moves_made_.insert(move);
    if (auto refused = refusal(block)) return refused;
    CheckedBlock checked{block.block, block.line, std::string(block.text), std::string(block.file),
                         block.calls, {}};
    const core::BlockEvents of_block{block.block, block.is_cycle, events, block.goes_home};
    watch_length(lengths_, run_.setup, of_block, block.warnings, state);
    follow_cure(block, {before_, lowering_before, state, offsets_});
    checked.result = core::run_block(run_.setup, of_block, state);
    remark_on(block);
    for (const core::Finding& finding : checked.result.findings) run_.findings.push_back(finding);
    watch_offsets(offsets_, run_.setup, place_, of_block, state);
    watch_units(units_, of_block);
    run_.verdict = std::max(run_.verdict, checked.result.verdict);
    run_.removed += checked.result.removed;
    if (run_.setup.detail != core::Detail::every_pair) keep_what_tells(checked.result);
    run_.blocks.push_back(std::move(checked));
    std::vector<core::BlockTime> timed;
    core::add_block(clock_, of_block, timed);
    enter(timed);
    return std::nullopt;
}

void ProgramRunner::follow_cure(const gcode::BlockResult& block, const ProgramPlace& before) {
    const bool is_first = lengths_.is_open && lengths_.doubts.back().first == block.block;
    if (!lengths_.is_open || is_first) end_cure();
    if (is_first) {
        followed_ = lengths_.doubts.size() - 1;
        cured_ = std::make_unique<CuredRun>(program_, environment_, run_.setup, speed_by_hand,
                                            before, lengths_.doubts.back());
    }
    if (cured_) cured_->follow(block);
}

void ProgramRunner::end_cure() {
    if (!cured_) return;
    cured_->end(lengths_.doubts[followed_]);
    cured_.reset();
}

void ProgramRunner::enter(const std::vector<core::BlockTime>& timed) {
    for (const core::BlockTime& time : timed)
        core::settle_time(run_.blocks[core::value_of(time.block)].result, time);
}

void ProgramRunner::hold_against_stock(const core::SimulatorState& state) {
    for (core::Finding& finding : implausible_offsets(offsets_, run_.setup))
        run_.findings.push_back(std::move(finding));
    if (auto jump =
            units_off_the_stock(units_, run_.setup, state.stock.outer_box, place_.modal.unit_said))
        run_.findings.push_back(*std::move(jump));
}

void ProgramRunner::to_the_end(core::SimulatorState& state) {
    for (const size_t made : moves_made_) {
        const core::FixtureMove& move = run_.setup.fixture_moves[made];
        state.fixtures_there[move.from] = false;
        if (move.to) state.fixtures_there[*move.to] = true;
    }
    run_blocks(state);
    end_cure();
    for (core::Finding& finding : core::end_of_run(run_.setup, state))
        run_.findings.push_back(std::move(finding));
    if (stock_is_stated) hold_against_stock(state);
    if (!run_.stopped) tell_of_moves_not_made();
    std::vector<core::BlockTime> timed;
    core::stop_clock(clock_, timed);
    enter(timed);
    run_.cycle_time = clock_.time;
}

void ProgramRunner::tell_of_moves_not_made() {
    for (size_t i = 0; i < run_.setup.fixture_moves.size(); ++i) {
        const core::FixtureMove& move = run_.setup.fixture_moves[i];
        if (moves_made_.contains(i)) continue;
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

CheckProgress ProgramRunner::progress(const gcode::BlockResult& block) {
    if (block.file.empty()) last_line_ = block.line;
    return {run_.blocks.size(),
            static_cast<double>(last_line_) / static_cast<double>(program_.line_count()),
            run_.findings.size()};
}

void ProgramRunner::run_blocks(core::SimulatorState& state) {
    while (true) {
        before_ = place_;
        const auto next = interpreter_.next(place_);
        if (!next) return stop(next.error());
        if (!*next) break;
        if (const auto refused = block(**next, state)) {
            run_.stopped = named(*refused, program_.file);
            return;
        }
        if (after_block && !after_block(progress(**next))) {
            run_.stopped = named({core::ErrorCode::io,
                                  {.line = (*next)->line, .column = 1},
                                  "the check was stopped after this block: the rest of the "
                                  "program is not checked",
                                  std::string((*next)->file)},
                                 program_.file);
            return;
        }
    }
    if (const auto warning = gcode::ending_warning(environment_, place_))
        run_.findings.push_back(remark(run_.setup, *warning));
}

} // namespace app
