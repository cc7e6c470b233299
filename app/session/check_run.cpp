#include "app/session/check_run.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "app/session/allowed_rules.h"
#include "app/session/block_delete.h"
#include "app/session/digest.h"
#include "app/session/inferred_setup.h"
#include "app/session/part_check.h"
#include "app/session/program_runner.h"
#include "app/session/timing_notes.h"

namespace app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
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
    const bool is_lost = std::any_of(run.findings.begin(), run.findings.end(),
                                     [](const auto& f) { return f.rule == "first-move"; });
    finding.cure =
        !is_lost ? "Mend first what the other findings name."
                 : "Say where the axes stand at the first block: `start` under [program] in the "
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
    // Nobody shall take a program for clear of which a part was not checked.
    if (run.stopped) run.verdict = std::max(run.verdict, core::Verdict::undecided);
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
    ProgramRunner runner(*program, file.environment, run);
    runner.after_block = job.after_block;
    runner.speed_by_hand = file.speed_by_hand;
    runner.stock_is_stated = stock_is_stated;
    runner.offsets_stated = file.offsets_set;
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
    gather_consequences(run, runner.length_doubts());
    return run;
}

} // namespace app
