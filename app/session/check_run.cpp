#include "app/session/check_run.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "app/session/allowed_rules.h"
#include "app/session/block_delete.h"
#include "app/session/digest.h"
#include "app/session/inferred_setup.h"
#include "app/session/m_codes.h"
#include "app/session/offset_watch.h"
#include "app/session/part_check.h"
#include "app/session/timing_notes.h"
#include "app/session/units_watch.h"
#include "core/sim/block_clock.h"
#include "core/sim/finding_text.h"
#include "gcode/error_rules.h"
#include "gcode/lowering.h"
#include "gcode/restart.h"

namespace app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

core::Error named(core::Error error, const std::string& file) {
    if (error.file.empty()) error.file = file;
    return error;
}

/// The dialect that was stated, else what the program looks like.
core::Result<gcode::DialectId> choose_dialect(const SetupFile& setup, const gcode::Program& program,
                                              CheckRun& run) {
    gcode::DialectId chosen{};
    if (setup.dialect) {
        chosen = *setup.dialect;
    } else {
        const gcode::Recognition seen = gcode::recognise(program);
        chosen = seen.dialect;
        run.assumptions.push_back(
            fmt::format("dialect {}, because {}", gcode::dialect(chosen).name, seen.reason));
    }
    if (gcode::dialect(chosen).supported) return chosen;
    return core::fail(core::ErrorCode::unsupported,
                      fmt::format("the dialect {} is not supported by this version",
                                  gcode::dialect(chosen).name));
}

/// What every check of this version takes for granted.
void add_standing_assumptions(const core::Setup& setup, CheckRun& run) {
    run.assumptions.push_back(
        fmt::format("arcs are cut and checked as chords within {:.4f} mm of them",
                    core::chord_error(setup.mesh_size)));
    for (const std::string& note : timing_notes(setup.machine)) run.assumptions.push_back(note);
    run.assumptions.push_back(fmt::format(
        "a clearance that keeps its allowance to within {:g} mm keeps it", core::resolution));
    if (setup.stock.tolerance == 0.0)
        run.assumptions.push_back("the raw stock is exactly as large as the set-up says");
    run.assumptions.push_back(setup.machine.rapid == core::RapidStyle::straight
                                  ? "rapids run straight"
                                  : "rapids run as dog-legs, each axis at its own speed");
}

/// Whoever asks for much room wants to know about bodies that are farther away, too.
void look_beyond_allowances(core::Setup& setup) {
    double largest = setup.allowance.value_or(0.0);
    for (const core::AllowanceRule& rule : setup.allowances)
        largest = std::max(largest, rule.distance);
    setup.search_limit = std::max(setup.search_limit, largest + 1.0);
}

void take_tool_at_start(core::Setup& setup, CheckRun& run, bool program_calls_tools) {
    if (program_calls_tools || setup.tool_at_start || setup.tools.size() != 1) return;
    setup.tool_at_start = setup.tools.begin()->first;
    run.assumptions.push_back(fmt::format("the program calls no tool: tool {} is in the spindle",
                                          core::value_of(*setup.tool_at_start)));
}

/// Whether any block up to the end or the first error changes the tool.
bool calls_tools(const gcode::Program& program, const gcode::Environment& environment) {
    gcode::ProgramLibrary library(program, gcode::dialect(environment.dialect),
                                  environment.search_path);
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    while (true) {
        const auto block = interpreter.next(state);
        if (!block || !*block) return false;
        for (const gcode::CanonicalCommand& command : (*block)->commands)
            if (std::holds_alternative<gcode::ChangeTool>(command)) return true;
    }
}

core::Finding remark(const core::Setup& setup, const gcode::Warning& warning) {
    core::Finding finding;
    finding.rule = warning.rule;
    finding.severity = core::default_severity(finding.rule).value_or(core::Severity::warning);
    if (warning.severity == gcode::Severity::note) finding.severity = core::Severity::note;
    if (const auto set = setup.rules.find(finding.rule); set != setup.rules.end())
        finding.severity = set->second;
    finding.message = warning.message;
    finding.cure = warning.cure;
    return finding;
}

/// T0 empties the spindle, unless a tool has that number.
void take_tool_zero(core::Event& event) {
    auto* change = std::get_if<core::ToolChange>(&event);
    if (change && !change->tool) change->tool = core::ToolNumber{0};
}

/// The fixtures that are moved before a block.
std::vector<core::Event> fixture_events(const core::Setup& setup, const gcode::BlockResult& block) {
    std::vector<core::Event> events;
    for (const core::FixtureMove& move : setup.fixture_moves) {
        const bool here = move.line && block.file.empty() && block.line == *move.line;
        if (!here && !(move.code && has_m_code(block.text, *move.code))) continue;
        events.emplace_back(core::FixtureChange{move.from, false});
        if (move.to) events.emplace_back(core::FixtureChange{*move.to, true});
    }
    return events;
}

void take_any_speed(core::Event& event) {
    auto* spindle = std::get_if<core::SpindleChange>(&event);
    if (spindle && spindle->speed == 0.0) spindle->speed = 1.0;
}

/// A run while it goes on.
struct Runner {
    const gcode::Program& program;
    const gcode::Environment& environment;
    CheckRun& run;
    const std::function<bool(const CheckProgress&)>& after_block;
    bool speed_by_hand = false;
    bool stock_is_stated = true; // false: it was made from the program's own cuts
    gcode::ProgramLibrary library{program, gcode::dialect(environment.dialect),
                                  environment.search_path};
    gcode::Interpreter interpreter{library, environment};
    gcode::InterpreterState place = gcode::initial_state(environment);
    gcode::Lowering lowering = gcode::initial_lowering(environment);
    core::BlockClock clock = core::start_clock(run.setup.machine);
    uint32_t last_line = 0; // of the main program
    OffsetWatch offsets = {};
    UnitsWatch units = {};

    /// Begins in the middle of the program, as a control does that was just switched on.
    core::Result<void> start_at(const std::string& line) {
        const gcode::Dialect& dialect = gcode::dialect(environment.dialect);
        FEELER_TRY(const uint32_t number, gcode::line_meant(program, dialect, line));
        FEELER_TRY(const gcode::Restart restart,
                   gcode::restart_at(library, environment, number, run.setup.tool_at_start));
        place = restart.state;
        lowering = gcode::initial_lowering(place);
        run.assumptions.push_back(fmt::format("the program is started at line {}, on a control "
                                              "that was just switched on",
                                              number));
        if (restart.missing.empty()) return {};
        core::Finding finding;
        finding.rule = "restart-in-the-middle";
        finding.severity = core::severity_of(run.setup, finding.rule);
        finding.block = core::BlockIndex{0};
        finding.message =
            fmt::format("Started here, the program cuts without what the lines before have said: "
                        "{}.",
                        fmt::join(restart.missing, ", "));
        finding.cure = "Enter that by hand first, or start at the tool change before.";
        if (finding.severity != core::Severity::off) run.findings.push_back(finding);
        return {};
    }

    /// A control stops with an alarm where this error is: a block of its own, and a finding if a
    /// rule has a name for it.
    void stop(core::Error error) {
        run.stopped = named(std::move(error), program.file);
        const std::string rule(gcode::rule_of(*run.stopped));
        const core::Severity severity = core::severity_of(run.setup, rule);
        if (rule.empty() || severity == core::Severity::off) return;
        const bool in_main = run.stopped->file == program.file;
        const auto text = program.find_line(run.stopped->where.line);
        const core::BlockIndex block{static_cast<uint32_t>(run.blocks.size())};
        run.blocks.push_back({block,
                              run.stopped->where.line,
                              in_main && text && *text ? std::string(**text) : std::string(),
                              in_main ? std::string() : run.stopped->file,
                              {},
                              {}});
        core::Finding finding;
        finding.rule = rule;
        finding.severity = severity;
        finding.block = block;
        finding.message = run.stopped->message + ". The control stops here with an alarm.";
        finding.cure = rule == "no-feed" ? "Say F in this block, in the unit of the feed mode."
                                         : "Look at the end, the centre and the plane of this arc.";
        run.findings.push_back(finding);
    }

    /// The simulator of this version has no axes beyond X, Y and Z.
    std::optional<core::Error> refusal(const gcode::BlockResult& block) const {
        if (lowering.moved_tilted)
            return core::Error{core::ErrorCode::unsupported,
                               {.line = block.line, .column = 1},
                               "this block moves in a tilted plane or with a tool that is turned, "
                               "and the machine of the set-up has no rotary axes that could: add "
                               "them as [[axis]]",
                               std::string(block.file)};
        if (!lowering.other_axis) return std::nullopt;
        return core::Error{core::ErrorCode::unsupported,
                           {.line = block.line, .column = 1},
                           fmt::format("this block moves axis {}, which the machine of the set-up "
                                       "does not have: add an [[axis]] of that name to its machine",
                                       gcode::axis_letters[*lowering.other_axis]),
                           std::string(block.file)};
    }

    /// Runs a block, or says why it cannot be.
    std::optional<core::Error> block(const gcode::BlockResult& block, core::SimulatorState& state) {
        std::vector<core::Event> events = fixture_events(run.setup, block);
        for (core::Event& event : gcode::lower(block, lowering)) events.push_back(event);
        for (core::Event& event : events) {
            if (run.setup.tools.contains(core::ToolNumber{0})) take_tool_zero(event);
            if (speed_by_hand) take_any_speed(event);
        }
        if (auto refused = refusal(block)) return refused;
        CheckedBlock checked{
            block.block, block.line, std::string(block.text), std::string(block.file),
            block.calls, {}};
        const core::BlockEvents of_block{block.block, block.is_cycle, events};
        checked.result = core::run_block(run.setup, of_block, state);
        for (const gcode::Warning& warning : block.warnings) {
            core::Finding finding = remark(run.setup, warning);
            finding.block = block.block;
            if (finding.severity != core::Severity::off) run.findings.push_back(finding);
        }
        for (const core::Finding& finding : checked.result.findings)
            run.findings.push_back(finding);
        watch_offsets(offsets, run.setup, place, of_block, state);
        watch_units(units, of_block);
        run.verdict = std::max(run.verdict, checked.result.verdict);
        run.removed += checked.result.removed;
        run.blocks.push_back(std::move(checked));
        std::vector<core::BlockTime> timed;
        core::add_block(clock, of_block, timed);
        enter(timed);
        return std::nullopt;
    }

    /// The times of blocks whose place in time has become known.
    void enter(const std::vector<core::BlockTime>& timed) {
        for (const core::BlockTime& time : timed)
            core::settle_time(run.blocks[core::value_of(time.block)].result, time);
    }

    /// What the program as a whole does, against the size and the place of the stock.
    void hold_against_stock(const core::SimulatorState& state) {
        for (core::Finding& finding : implausible_offsets(offsets, run.setup))
            run.findings.push_back(std::move(finding));
        if (auto jump =
                units_off_the_stock(units, run.setup, state.stock.outer_box, place.modal.unit_said))
            run.findings.push_back(*std::move(jump));
    }

    void to_the_end(core::SimulatorState& state) {
        run_blocks(state);
        for (core::Finding& finding : core::end_of_run(run.setup, state))
            run.findings.push_back(std::move(finding));
        if (stock_is_stated) hold_against_stock(state);
        std::vector<core::BlockTime> timed;
        core::stop_clock(clock, timed);
        enter(timed);
        run.cycle_time = clock.time;
    }

    CheckProgress progress(const gcode::BlockResult& block) {
        if (block.file.empty()) last_line = block.line;
        return {run.blocks.size(),
                static_cast<double>(last_line) / static_cast<double>(program.line_count()),
                run.findings.size()};
    }

    void run_blocks(core::SimulatorState& state) {
        while (true) {
            const auto next = interpreter.next(place);
            if (!next) return stop(next.error());
            if (!*next) break;
            if (const auto refused = block(**next, state)) {
                run.stopped = named(*refused, program.file);
                return;
            }
            if (after_block && !after_block(progress(**next))) {
                run.stopped = named({core::ErrorCode::io,
                                     {.line = (*next)->line, .column = 1},
                                     "the check was stopped after this block: the rest of the "
                                     "program is not checked",
                                     std::string((*next)->file)},
                                    program.file);
                return;
            }
        }
        if (const auto warning = gcode::ending_warning(environment, place))
            run.findings.push_back(remark(run.setup, *warning));
    }
};

/// A program of which no motion could be judged has not been checked.
void look_for_judged_motions(CheckRun& run) {
    const CheckedBlock* first = nullptr;
    for (const CheckedBlock& block : run.blocks) {
        if (block.result.motion == core::BlockMotion::none) continue;
        if (block.result.checked) return;
        if (!first) first = &block;
    }
    if (!first) return;
    core::Finding finding;
    finding.rule = "undecided";
    finding.severity = core::Severity::error;
    finding.block = first->block;
    finding.message = "No motion of the program could be judged.";
    finding.cure = "Say where the axes stand at the first block: `start` under [program] in the "
                   "set-up, or the machine's home.";
    run.findings.push_back(finding);
}

/// Nobody shall take a program for checked whose motions were not looked at.
void say_not_judged(CheckRun& run, const std::string& why) {
    const auto moves = [](const CheckedBlock& block) {
        return block.result.motion != core::BlockMotion::none;
    };
    if (why.empty() || std::none_of(run.blocks.begin(), run.blocks.end(), moves)) return;
    core::Finding finding;
    finding.rule = "undecided";
    finding.severity = core::Severity::error;
    finding.message = "The motions were not checked: " + why + ".";
    finding.cure = "Check the program on the lathe's own control.";
    run.verdict = std::max(run.verdict, core::Verdict::undecided);
    run.findings.push_back(finding);
}

/// Findings in the order of their blocks, those about the program as a whole at the end.
void put_in_order(std::vector<core::Finding>& findings) {
    std::stable_sort(findings.begin(), findings.end(), [](const auto& a, const auto& b) {
        if (!a.block || !b.block) return a.block.has_value() && !b.block;
        return core::value_of(*a.block) < core::value_of(*b.block);
    });
}

void conclude(CheckRun& run, const core::SimulatorState& state) {
    run.statistics = state.statistics;
    run.points = core::point_count(state.stock.lines);
    run.lines = core::line_count(state.stock.lines);
    for (const std::string& assumption : state.assumptions) run.assumptions.push_back(assumption);
    look_for_judged_motions(run);
    put_in_order(run.findings);
}

} // namespace

bool CheckRun::has_errors() const {
    return std::any_of(findings.begin(), findings.end(), [](const core::Finding& finding) {
        return finding.severity == core::Severity::error;
    });
}

double least_clearance(const core::Setup& setup, const core::BlockResult& result) {
    double lower = result.checked ? setup.search_limit : 0.0;
    for (const core::PairClearance& pair : result.pairs) lower = std::min(lower, pair.lower);
    return lower;
}

core::Result<CheckRun> run_check(const CheckJob& job) {
    const Clock::time_point begin = Clock::now();
    CheckRun run;
    run.program_file = job.program;
    const auto program = gcode::read_program(job.program);
    if (!program) return tl::unexpected(named(program.error(), job.program));
    run.sha256 = sha256_of_file(job.program);
    FEELER_TRY(SetupFile file,
               job.setup.empty() ? bare_setup(job.settings) : read_setup(job.setup, job.settings));
    const auto dialect = choose_dialect(file, *program, run);
    if (!dialect) return tl::unexpected(named(dialect.error(), job.program));
    run.dialect = file.environment.dialect = *dialect;
    const bool stock_is_stated = !file.needs_stock && !file.is_inferred;
    if (const auto whole = complete_setup(file, *program); !whole)
        return tl::unexpected(named(whole.error(), job.setup.empty() ? job.program : job.setup));
    run.assumptions.insert(run.assumptions.begin(), file.assumptions.begin(),
                           file.assumptions.end());
    run.setup = std::move(file.setup);
    if (job.allowance) run.setup.allowance = job.allowance;
    run.setup.detail = job.detail;
    if (job.mesh_size) run.setup.mesh_size = *job.mesh_size;
    if (job.memory_limit) run.setup.memory_limit = *job.memory_limit;
    look_beyond_allowances(run.setup);
    take_tool_at_start(run.setup, run, calls_tools(*program, file.environment));
    add_standing_assumptions(run.setup, run);
    run.times.read = seconds_since(begin);

    const Clock::time_point modelling = Clock::now();
    run.memory = core::memory_estimate(core::bounds(run.setup.stock), run.setup.mesh_size);
    if (job.before_model && run.memory <= run.setup.memory_limit) job.before_model(run.memory);
    auto state = core::start_of_run(run.setup, file.environment.start);
    if (!state) return tl::unexpected(named(state.error(), job.setup));
    state->spindle.direction = run.setup.spindle_at_start;
    if (state->spindle.direction != core::SpindleDirection::stopped) state->spindle.speed = 1.0;
    run.times.model = seconds_since(modelling);

    const Clock::time_point checking = Clock::now();
    Runner runner{*program,        file.environment,   run,
                  job.after_block, file.speed_by_hand, stock_is_stated};
    if (!job.start_line.empty())
        if (const auto begun = runner.start_at(job.start_line); !begun)
            return tl::unexpected(named(begun.error(), job.program));
    runner.to_the_end(*state);
    run.times.check = seconds_since(checking);
    conclude(run, *state);
    say_not_judged(run, file.not_judged);
    run.stock = std::move(state->stock);
    if (!run.stopped && (job.needs_surface || run.setup.part))
        run.surface = core::stock_mesh(*run.stock);
    check_part(run);
    look_at_both_switch_positions(run, *program, file.environment);
    apply_allowed_rules(run, file.allow_comments);
    return run;
}

} // namespace app
