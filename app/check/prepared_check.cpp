#include "app/check/prepared_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/sha256.h"
#include "app/base/stopwatch.h"
#include "app/check/check_job.h"
#include "app/check/tool_mismatch.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/inference/inferred_stock.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "core/base/file_reads.h"
#include "core/base/rule_table.h"
#include "core/motion/path.h"
#include "core/motion/timing.h"
#include "core/sim/clearance.h"
#include "core/sim/run/simulator.h"
#include "core/sim/verdict.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {
namespace {

/// The stated dialect, else the recognised one.
core::Result<gcode::DialectId> choose_dialect(const SetupFile& setup, const gcode::Program& program,
                                              CheckInput& run) {
    gcode::DialectId chosen{};
    if (setup.dialect) {
        chosen = *setup.dialect;
    } else {
        const gcode::Recognition seen = gcode::recognise(program);
        FEELER_TRY(chosen, gcode::supported(seen));
        run.assumptions.push_back(
            fmt::format("dialect {}, because {}", gcode::dialect(chosen).name, seen.reason));
    }
    return gcode::supported(chosen);
}

/// Adds the assumptions that every check makes.
void add_standing_assumptions(const core::Setup& setup, CheckInput& run) {
    run.assumptions.push_back(fmt::format("arcs are cut and checked as chords within {} mm of them",
                                          core::at_most(core::chord_error(setup.mesh_size), 4)));
    for (const std::string& note : timing_notes(setup.machine)) run.assumptions.push_back(note);
    run.assumptions.push_back(fmt::format(
        "clearances are compared with the minimum to within {:g} mm", core::resolution));
    if (setup.stock.tolerance <= setup.stock.deviation)
        run.assumptions.push_back("the raw stock has exactly the size in the set-up");
    if (setup.machine.rapid == core::RapidStyle::dogleg)
        run.assumptions.push_back("rapids run as dog-legs, each axis at its own speed");
    else if (gcode::dialect(run.dialect).machine_move_bends)
        run.assumptions.push_back("rapids run straight; those of G53, and of G28 and G30 from the "
                                  "intermediate point, run as dog-legs");
    else
        run.assumptions.push_back("rapids run straight");
}

/// What controls of a dialect do at corners, where the machine does not say.
///
/// Grbl follows the path; its junction deviation only limits the speed. Fanuc and Haas wait at the
/// end of each rapid until the machine is in position. Others may round corners between rapids as
/// those between feeds.
void settle_corner_tolerances(core::Machine& machine, gcode::DialectId dialect) {
    using gcode::DialectId;
    if (dialect == DialectId::grbl && !machine.corner_tolerance) machine.corner_tolerance = 0.0;
    if (machine.rapid_corner_tolerance) return;
    const bool stops = dialect == DialectId::fanuc || dialect == DialectId::haas;
    machine.rapid_corner_tolerance = stops ? std::optional(0.0) : machine.corner_tolerance;
}

core::Error stopped_before(const CheckJob& job) {
    return {core::ErrorCode::io, {}, "the check was stopped before its first block", job.program};
}

/// Memory of a check in addition to the model of its stock, bytes. Measured with programs of 1,000
/// to 400,000 blocks, including their text, results and findings. Loops execute a line several
/// times and need more.
double memory_besides_model(const gcode::Program& program) {
    constexpr double of_any = 16e6, of_line = 600.0;
    return of_any + of_line * static_cast<double>(program.line_starts.size());
}

/// Whether any block up to the end or to the first error changes the tool.
bool calls_tools(const PreparedCheck& check) {
    gcode::Interpreter interpreter(*check.library, check.file.environment);
    gcode::InterpreterState state = gcode::initial_state(check.file.environment);
    while (true) {
        const auto block = interpreter.next(state);
        if (!block || !*block) return false;
        for (const gcode::CanonicalCommand& command : (*block)->commands)
            if (std::holds_alternative<gcode::ChangeTool>(command)) return true;
    }
}

void take_tool_at_start(PreparedCheck& check) {
    core::Setup& setup = check.run.setup;
    if (setup.tool_at_start || setup.tools.size() != 1 || calls_tools(check)) return;
    setup.tool_at_start = setup.tools.begin()->first;
    check.run.assumptions.push_back(
        fmt::format("the program changes no tool: tool {} is in the spindle",
                    core::value_of(*setup.tool_at_start)));
}

/// Reads a program, with the digest of the same bytes: a pipe can be read only once.
core::Result<gcode::Program> read_once(const std::string& path, std::string& sha256) {
    const core::FileAccessObserver listening([&](const core::FileAccess& access) {
        if (access.question == core::FileAccessKind::content && access.answer)
            sha256 = sha256_of(*access.answer);
    });
    return gcode::read_program(path);
}

core::Result<SetupFile> read_setup_of(const CheckJob& job) {
    const bool is_bare =
        job.setup_text ? job.setup.empty() && states_nothing(*job.setup_text) : job.setup.empty();
    if (is_bare) return bare_setup(job.settings);
    return job.setup_text ? read_setup_text(*job.setup_text, setup_path(job), job.settings)
                          : read_setup(job.setup, job.settings);
}

} // namespace

PreparedCheck::PreparedCheck() = default;
PreparedCheck::PreparedCheck(PreparedCheck&&) noexcept = default;
PreparedCheck& PreparedCheck::operator=(PreparedCheck&&) noexcept = default;
PreparedCheck::~PreparedCheck() = default;

core::Result<PreparedCheck> read_check(const CheckJob& job) {
    const Stopwatch reading;
    PreparedCheck check;
    CheckRun& run = check.run;
    run.program_file = job.program;
    auto program = read_once(job.program, run.sha256);
    if (!program) return tl::unexpected(core::in_file(program.error(), job.program));
    check.program = std::make_unique<const gcode::Program>(*std::move(program));
    FEELER_TRY(check.file, read_setup_of(job));
    SetupFile& file = check.file;
    if (job.setup_was_found)
        run.assumptions.push_back(
            fmt::format("the set-up is {}, because it is next to the program", job.setup));
    const auto dialect = choose_dialect(file, *check.program, run);
    if (!dialect) return tl::unexpected(core::in_file(dialect.error(), job.program));
    run.dialect = file.environment.dialect = *dialect;
    // What an earlier program stored is not where the machine is assumed to start.
    if (gcode::dialect(*dialect).stores_homes) {
        if (file.infers_home || file.assumed.contains("start")) file.environment.home.reset();
        if (file.infers_second_home) file.environment.second_home.reset();
    }
    auto notes = apply(file.control, file.environment, file.setup.machine);
    if (!notes) return tl::unexpected(core::in_file(notes.error(), job.setup));
    for (std::string& note : *notes) run.assumptions.push_back(std::move(note));
    file.environment.limits.is_stopped = job.is_stopped;
    check.stock_is_stated = !file.needs_stock && !file.is_inferred
                            && !file.assumed.contains("stock")
                            && !stands_for_no_stock(file.setup.stock);
    check.tool_mismatches = tool_mismatches(*check.program, file);
    if (const auto whole = complete_setup(file, *check.program); !whole)
        return tl::unexpected(
            core::in_file(whole.error(), file.is_inferred ? job.program : setup_path(job)));
    check.stock_is_stated = check.stock_is_stated || is_stock_of_program(file);
    run.assumptions.insert(run.assumptions.begin(), file.assumptions.begin(),
                           file.assumptions.end());
    run.coverage = coverage_of(file);
    run.setup = std::move(file.setup);
    settle_corner_tolerances(run.setup.machine, *dialect);
    if (job.allowance) run.setup.allowance = job.allowance;
    run.setup.detail = job.detail;
    for (const auto& [rule, severity] : job.rules) run.setup.rules[rule] = severity;
    if (job.mesh_size) run.setup.mesh_size = *job.mesh_size;
    if (job.memory_limit) run.setup.memory_limit = *job.memory_limit;
    run.setup.search_limit = core::search_limit_of(run.setup);
    check.library = std::make_shared<gcode::ProgramLibrary>(
        *check.program, gcode::dialect(file.environment.dialect), file.environment.search_path);
    take_tool_at_start(check);
    // is_stopped may have cut the survey short. From here on the run polls it.
    if (job.is_stopped && job.is_stopped()) return tl::unexpected(stopped_before(job));
    file.environment.limits.is_stopped = {};
    // Also where the rule is off: a reading that collides is reported all the same.
    file.environment.control.reports_premises = true;
    const auto is_limited = [](const core::MachineAxis& axis) { return axis.min || axis.max; };
    const auto& axes = run.setup.machine.axes;
    // A program that starts in the middle has the modes of the lines before; a rule compares them.
    file.environment.control.follows_start =
        job.start_line.empty()
        && (check.stock_is_stated || !run.setup.fixtures.empty()
            || std::any_of(axes.begin(), axes.end(), is_limited));
    add_standing_assumptions(run.setup, run);
    run.times.read = reading.seconds();
    return check;
}

core::Result<void> place_check(const CheckJob& job, PreparedCheck& check) {
    const Stopwatch modelling;
    CheckRun& run = check.run;
    run.memory = core::memory_estimate(core::bounds(run.setup.stock), run.setup.mesh_size);
    const bool may_begin = !job.before_model || run.memory > run.setup.memory_limit
                           || job.before_model(run.memory + memory_besides_model(*check.program));
    if (!may_begin) return tl::unexpected(stopped_before(job));
    auto state = core::start_of_run(run.setup, check.file.environment.start);
    if (!state) return tl::unexpected(core::in_file(state.error(), job.setup));
    check.machine = std::make_unique<core::SimulatorState>(*std::move(state));
    core::SpindleChange& spindle = check.machine->spindle;
    spindle.direction = run.setup.spindle_at_start;
    if (spindle.direction != core::SpindleDirection::stopped) spindle.speed = 1.0;
    run.times.model = modelling.seconds();
    return {};
}

core::Result<PreparedCheck> prepare_check(const CheckJob& job) {
    FEELER_TRY(PreparedCheck check, read_check(job));
    if (const auto placed = place_check(job, check); !placed) return tl::unexpected(placed.error());
    return check;
}

std::vector<std::string> timing_notes(const core::Machine& machine) {
    std::string known, unknown;
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!machine.axes[i].present) continue;
        std::string& names = machine.axes[i].acceleration ? known : unknown;
        names += (names.empty() ? "" : ", ") + std::string(1, core::axis_letters[i]);
    }
    if (known.empty()) return {"feeds and rapids run at full speed: accelerations are ignored"};
    std::vector<std::string> notes;
    if (!unknown.empty())
        notes.push_back(fmt::format(
            "axes without a stated acceleration reach full speed at once: {}", unknown));
    notes.push_back(fmt::format("for times, corners are rounded within {} mm unless the program "
                                "states it (G61, G61.1, G64 P)",
                                core::default_blend_tolerance));
    notes.push_back("tool and spindle changes take no time beyond stopping the axes");
    return notes;
}

} // namespace app
