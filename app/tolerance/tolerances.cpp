#include "app/tolerance/tolerances.h"

#include <algorithm>
#include <atomic>
#include <list>
#include <map>
#include <numeric>
#include <thread>

#include <fmt/format.h>

#include "app/base/stopwatch.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/dog_legs.h"
#include "app/check/prepared_check.h"
#include "app/tolerance/enclosure.h"
#include "app/tolerance/limit_search.h"
#include "app/tolerance/recorded_motions.h"
#include "core/base/rule_table.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

constexpr const char* another_course =
    "the program reads this value, or takes another course when it changes";

/// A reading of the program under a deviation.
struct Case {
    const RecordedMotions* recorded = {}; // without the deviation
    const RecordedMotions* motions = {};  // of the simulations
    Shifts shifts;                        // as the bodies see them
    Shifts travels;                       // of the axes
};

/// A deviation with everything that its search needs.
struct Task {
    Tolerance result;
    core::Setup base; // of the simulations
    std::vector<Case> cases;
    size_t runs = 0;
    bool is_done = false;
};

/// The work of tasks that are done one after another or at the same time.
///
/// A task counts as too much if its work and that of all tasks before it exceed the limit, so that
/// does not depend on which thread is faster. It can end as soon as what they have done so far
/// does: their work only grows. So no more than the limit is done, but for the intervals between
/// reports.
class Workload {
public:
    Workload(size_t tasks, size_t most) : done_(tasks), most_(most) {}

    void add(size_t task, size_t work) { done_[task] += work; }
    size_t done_by(size_t task) const { return done_[task]; }
    bool is_exceeded(size_t task) const {
        return std::accumulate(done_.begin(), done_.begin() + std::ptrdiff_t(task) + 1, size_t{0})
               > most_;
    }

private:
    std::vector<std::atomic<size_t>> done_;
    size_t most_;
};

/// A check that can be read once and deviated often.
class ToleranceStudy {
public:
    /// `readings`: the recordings of all readings of the program.
    ToleranceStudy(const PreparedCheck& check, std::vector<RecordedMotions> readings)
        : check_(check), readings_(std::move(readings)) {}

    /// All quantities that can deviate, with the reason where nothing can be said of one.
    std::vector<Task> tasks();

    /// `may_go_on`: see Enclosure.
    void search(Task& task, const std::function<bool(size_t)>& may_go_on) const;

    /// Whether the control still takes the same course at both limits; sets `unknown` if not.
    void confirm_course(Task& task) const;

private:
    void add_places(std::vector<Task>& tasks);
    void add_tools(std::vector<Task>& tasks);
    void add(std::vector<Task>& tasks, const Deviation& deviation);
    /// Compares with the program under a deviation. Empty: the control takes another course.
    std::optional<Shifts> shifts_under(const RecordedMotions& recorded, const Deviation& deviation,
                                       double by) const;
    /// Compares with the program under deviations of 1 mm either way.
    std::optional<Shifts> shifts_of(const RecordedMotions& recorded,
                                    const Deviation& deviation) const;
    Case case_of(const RecordedMotions& recorded, const Task& task, Shifts travels);
    void search_side(Task& task, const Case& one, const Enclosure& enclosure, bool more) const;
    void narrow_by_travel(const Case& one, double sign, ToleranceLimit& limit) const;
    bool is_followed(const Task& task, const Case& one, double by) const;
    void keep_only(core::Setup& setup, const std::string& fixture) const;
    const RecordedMotions* without_others(const RecordedMotions& recorded,
                                          const std::string& fixture, const core::Setup& setup);

    const PreparedCheck& check_;
    std::vector<RecordedMotions> readings_;
    // By the fixture that stays.
    std::map<std::pair<const RecordedMotions*, std::string>, RecordedMotions> without_others_;
};

std::optional<Shifts> ToleranceStudy::shifts_under(const RecordedMotions& recorded,
                                                   const Deviation& deviation, double by) const {
    core::Setup setup;
    gcode::Environment environment = check_.file.environment;
    Deviation of_control = deviation;
    if (deviation.quantity == Quantity::stick_out) of_control.quantity = Quantity::tool_length;
    if (!deviate({setup, environment}, of_control, by)) return std::nullopt;
    const auto other = record_motions(check_, environment, recorded.choices);
    return other ? shifts_between(recorded, *other, by) : std::nullopt;
}

std::optional<Shifts> ToleranceStudy::shifts_of(const RecordedMotions& recorded,
                                                const Deviation& deviation) const {
    auto more = shifts_under(recorded, deviation, 1.0);
    const auto less = more ? shifts_under(recorded, deviation, -1.0) : std::nullopt;
    return less && same_shifts(*more, *less) ? std::move(more) : std::nullopt;
}

/// Leaves only one fixture, and no stock: nothing else depends on its place.
void ToleranceStudy::keep_only(core::Setup& setup, const std::string& name) const {
    for (core::Fixture& fixture : setup.fixtures)
        fixture.is_there = fixture.is_there && fixture.name == name && !fixture.is_machine;
    constexpr double far = 1e5;
    setup.stock = core::Solid{core::SolidBox{{core::Vec3(far), core::Vec3(far + 1.0)}}};
    setup.earlier_cuts = nullptr;
    setup.mesh_size = 0.5;
}

const RecordedMotions* ToleranceStudy::without_others(const RecordedMotions& recorded,
                                                      const std::string& name,
                                                      const core::Setup& setup) {
    const auto [known, fresh] = without_others_.emplace(std::pair(&recorded, name), recorded);
    if (!fresh) return &known->second;
    for (core::Event& event : known->second.events) {
        const auto* change = std::get_if<core::FixtureChange>(&event);
        if (change && setup.fixtures[change->fixture].name != name) event = core::Dwell{};
    }
    return &known->second;
}

Case ToleranceStudy::case_of(const RecordedMotions& recorded, const Task& task, Shifts travels) {
    const Deviation& deviation = task.result.deviation;
    Case one{.recorded = &recorded, .motions = &recorded, .shifts = travels};
    if (deviation.quantity == Quantity::stick_out)
        // The tip is lower by as much as the tool is longer; the control raises it again.
        one.shifts = with_tool_shift(travels, recorded, check_.run.setup.tool_at_start,
                                     deviation.tool, -1.0);
    if (deviation.quantity == Quantity::fixture)
        one.motions = without_others(recorded, deviation.fixture, check_.run.setup);
    one.travels = std::move(travels);
    return one;
}

void ToleranceStudy::add(std::vector<Task>& tasks, const Deviation& deviation) {
    Task task{.result = {.deviation = deviation}, .base = check_.run.setup};
    task.base.part.reset();
    if (deviation.quantity == Quantity::fixture) keep_only(task.base, deviation.fixture);
    const bool in_control = deviation.quantity == Quantity::work_offset
                            || deviation.quantity == Quantity::tool_length
                            || deviation.quantity == Quantity::stick_out;
    bool has_effect = !in_control || deviation.quantity == Quantity::stick_out;
    for (const RecordedMotions& recorded : readings_) {
        auto travels = in_control ? shifts_of(recorded, deviation) : no_shifts(recorded);
        if (!travels) {
            task.result.unknown = another_course;
            break;
        }
        has_effect = has_effect || !travels->none();
        const auto is_same = [&](const Case& other) {
            return same_motions(*other.recorded, recorded) && same_shifts(other.travels, *travels);
        };
        if (std::none_of(task.cases.begin(), task.cases.end(), is_same))
            task.cases.push_back(case_of(recorded, task, *std::move(travels)));
    }
    if (has_effect || !task.result.unknown.empty()) tasks.push_back(std::move(task));
}

void ToleranceStudy::add_places(std::vector<Task>& tasks) {
    std::vector<size_t> offsets(gcode::plain_offset_count);
    std::iota(offsets.begin(), offsets.end(), size_t{0});
    for (const auto& [offset, origin] : check_.file.environment.extended_offsets)
        offsets.push_back(offset);
    for (const size_t offset : offsets)
        for (int axis = 0; axis < 3; ++axis)
            add(tasks, {.quantity = Quantity::work_offset, .axis = axis, .offset = offset});
    for (int axis = 0; axis < 3; ++axis) add(tasks, {.quantity = Quantity::stock, .axis = axis});
    std::vector<std::string> names;
    for (const core::Fixture& fixture : check_.run.setup.fixtures)
        if (!fixture.is_machine
            && std::find(names.begin(), names.end(), fixture.name) == names.end())
            names.push_back(fixture.name);
    for (const std::string& name : names)
        for (int axis = 0; axis < 3; ++axis)
            add(tasks, {.quantity = Quantity::fixture, .axis = axis, .fixture = name});
}

/// The tools that move, in the order of their use, with the entries of their lengths.
std::vector<std::pair<core::ToolNumber, std::set<core::OffsetNumber>>>
tools_of(const std::vector<RecordedMotions>& readings, const core::Setup& setup) {
    std::vector<std::pair<core::ToolNumber, std::set<core::OffsetNumber>>> used;
    for (const RecordedMotions& recorded : readings) {
        std::optional<core::ToolNumber> now = setup.tool_at_start;
        for (const core::Event& event : recorded.events) {
            if (const auto* change = std::get_if<core::ToolChange>(&event)) now = change->tool;
            const auto is_now = [&](const auto& one) { return one.first == *now; };
            if (now && std::holds_alternative<core::Motion>(event) && setup.tools.contains(*now)
                && std::none_of(used.begin(), used.end(), is_now))
                used.push_back({*now, {}});
        }
        for (auto& [tool, numbers] : used)
            numbers.merge(length_numbers(recorded, setup.tool_at_start, tool));
    }
    for (auto& [tool, numbers] : used)
        if (numbers.empty()) numbers = {core::OffsetNumber{core::value_of(tool)}};
    return used;
}

void ToleranceStudy::add_tools(std::vector<Task>& tasks) {
    const core::Setup& setup = check_.run.setup;
    const core::Machine& machine = setup.machine;
    const bool is_upright = !core::is_turned_by_axes(machine, machine.spindle)
                            && machine.axes[2].direction == core::Vec3(0, 0, 1);
    for (const auto& [number, numbers] : tools_of(readings_, setup)) {
        const core::ToolAssembly& tool = setup.tools.at(number);
        Deviation deviation{.tool = number, .numbers = numbers};
        deviation.quantity = Quantity::tool_length;
        add(tasks, deviation);
        deviation.quantity = Quantity::stick_out;
        if (is_upright && !tool.description.holder.empty()) add(tasks, deviation);
        deviation.quantity = Quantity::tool_diameter;
        if (grows_with_diameter(tool)) add(tasks, deviation);
    }
}

std::vector<Task> ToleranceStudy::tasks() {
    std::vector<Task> tasks;
    add_places(tasks);
    add_tools(tasks);
    return tasks;
}

/// Positions of an axis on a motion that are displaced alike.
struct AxisStretch {
    double least, most; // without the deviation
    double by;          // displacement per mm
};

/// Stretches that reach as far as the axis does, under any deviation.
std::vector<AxisStretch> stretches(const core::Motion& motion, const core::AxisRange& range,
                                   const core::AxisValues& from, const core::AxisValues& to,
                                   size_t axis) {
    const double least = range.min[axis], most = range.max[axis];
    if (motion.tip && core::is_rotary(axis)) return {};
    if (motion.tip) {
        // While the control follows the tip and the work turns, the displacement turns as well.
        double greatest = 0.0;
        for (const core::AxisValues* end : {&from, &to}) {
            double sum = 0.0;
            for (size_t i = 0; i < core::axis_count; ++i) sum += std::abs((*end)[i]);
            greatest = std::max(greatest, sum);
        }
        return {{least, most, greatest}, {least, most, -greatest}};
    }
    if (from[axis] == to[axis]) return {{least, most, from[axis]}};
    // An axis whose ends are displaced differently does not swing beyond them.
    return {{*motion.from[axis], *motion.from[axis], from[axis]},
            {*motion.to[axis], *motion.to[axis], to[axis]}};
}

/// Narrows a limit to the deviation at which an axis reaches its end.
void ToleranceStudy::narrow_by_travel(const Case& one, double sign, ToleranceLimit& limit) const {
    const core::Setup& setup = check_.run.setup;
    const RecordedMotions& motions = *one.recorded;
    const auto narrow = [&](double by, size_t event, size_t axis) {
        if (by >= limit.by) return;
        const RecordedBlock& block = motions.blocks[motions.block_of[event]];
        limit = {.by = std::max(0.0, by),
                 .not_shown = std::max(0.0, by) + 1e-6,
                 .line = block.line,
                 .file = block.file,
                 .tool = {},
                 .pair = {std::string(1, core::axis_letters[axis]), "limit"}};
    };
    for (size_t event = 0; event < motions.events.size(); ++event) {
        const auto* motion = std::get_if<core::Motion>(&motions.events[event]);
        const Shifts::Ends ends = one.travels.of[event];
        if (!motion || (ends.from == 0 && ends.to == 0)) continue;
        bool known = true;
        for (size_t axis = 0; axis < core::axis_count; ++axis)
            known =
                known
                && (!setup.machine.axes[axis].present || (motion->from[axis] && motion->to[axis]));
        if (!known) continue;
        const core::AxisRange range =
            core::axis_range(*motion, setup.machine, core::chord_error(setup.mesh_size));
        const core::AxisValues &from = one.travels.kinds[ends.from],
                               &to = one.travels.kinds[ends.to];
        for (size_t axis = 0; axis < core::axis_count; ++axis) {
            const core::MachineAxis& limits = setup.machine.axes[axis];
            if (!limits.present) continue;
            for (const AxisStretch& part : stretches(*motion, range, from, to, axis)) {
                const double way = sign * part.by;
                if (limits.max && way > 0.0) narrow((*limits.max - part.most) / way, event, axis);
                if (limits.min && way < 0.0) narrow((part.least - *limits.min) / -way, event, axis);
            }
        }
    }
}

/// Whether the control still follows the same course under a deviation.
bool ToleranceStudy::is_followed(const Task& task, const Case& one, double by) const {
    if (one.travels.none() || by == 0.0) return true;
    const auto shifts = shifts_under(*one.recorded, task.result.deviation, by);
    return shifts && same_shifts(*shifts, one.travels);
}

/// How far a tool can be pushed into its holder: up to its flutes.
double length_of_shank(const core::ToolAssembly& tool) {
    return core::total_length(tool.description.shank);
}

/// Narrows the limit on one side to what is proven for one reading.
void ToleranceStudy::search_side(Task& task, const Case& one, const Enclosure& enclosure,
                                 bool more) const {
    const double sign = more ? 1.0 : -1.0;
    const Deviation& deviation = task.result.deviation;
    const bool is_diameter = deviation.quantity == Quantity::tool_diameter;
    ToleranceLimit& limit = more ? task.result.more : task.result.less;
    narrow_by_travel(one, sign, limit);
    // A diameter is searched link by link: the range from one proven value to the next.
    double base = 0.0;
    while (limit.by > base) {
        const auto shown = [&](double by) {
            const double to = sign * (base + by), from = sign * base;
            return enclosure.first_limit(
                is_diameter ? DeviationRange{std::min(from, to), std::max(from, to)}
                : more      ? DeviationRange{0.0, to}
                            : DeviationRange{to, 0.0});
        };
        const ProvenLimit proven = proven_limit(limit.by - base, shown);
        task.runs += proven.runs;
        if (!proven.limit) break;
        const bool goes_on = is_diameter && proven.by > 0.02 && task.runs < 60;
        base += proven.by;
        if (goes_on) continue;
        limit = {.by = base, .not_shown = base - proven.by + *proven.not_shown};
        const LimitingPair& by = *proven.limit;
        if (by.event < one.motions->events.size()) {
            const RecordedBlock& block = one.motions->blocks[one.motions->block_of[by.event]];
            limit.line = block.line;
            limit.file = block.file;
        }
        limit.tool = by.tool;
        limit.pair = by.pair;
        break;
    }
}

void ToleranceStudy::confirm_course(Task& task) const {
    for (const Case& one : task.cases)
        if (task.result.unknown.empty()
            && (!is_followed(task, one, task.result.more.by)
                || !is_followed(task, one, -task.result.less.by)))
            task.result.unknown = another_course;
}

void ToleranceStudy::search(Task& task, const std::function<bool(size_t)>& may_go_on) const {
    if (!task.result.unknown.empty()) return;
    const Deviation& deviation = task.result.deviation;
    const double widest =
        deviation.quantity == Quantity::tool_diameter ? widest_diameter_change : widest_deviation;
    task.result.less = task.result.more = {.by = widest, .is_open = true};
    if (deviation.quantity == Quantity::stick_out) {
        const double shank = length_of_shank(task.base.tools.at(deviation.tool));
        if (shank < widest)
            task.result.less = {.by = shank,
                                .not_shown = shank,
                                .tool = deviation.tool,
                                .pair = {"flutes", "holder"}};
    }
    std::list<Enclosure> enclosures;
    for (const Case& one : task.cases) {
        enclosures.emplace_back(check_, task.base, *one.motions, one.shifts, deviation, may_go_on);
        task.result.unknown = enclosures.back().obstacle();
        if (!task.result.unknown.empty()) return;
    }
    auto enclosure = enclosures.begin();
    for (const Case& one : task.cases) {
        for (const bool more : {false, true})
            if (may_go_on(0)) search_side(task, one, *enclosure, more);
        ++enclosure;
    }
}

/// Why a quantity was not studied.
std::string limit_of(size_t most_work) {
    return fmt::format("the simulations reached their limit of {} tests",
                       most_work % 1'000'000 == 0 ? fmt::format("{} million", most_work / 1'000'000)
                                                  : std::to_string(most_work));
}

/// Searches all tasks on all processors, in their order.
void search_all(const ToleranceStudy& study, std::vector<Task>& tasks, Workload& workload,
                const std::function<bool(double)>& goes_on) {
    std::atomic<size_t> next = 0, done = 0;
    const auto is_stopped = [&] {
        return goes_on && !goes_on(double(done) / double(std::max<size_t>(tasks.size(), 1)));
    };
    const auto work = [&] {
        for (size_t i = next++; i < tasks.size() && !is_stopped(); i = next++, ++done) {
            study.search(tasks[i], [&, i](size_t more) {
                workload.add(i, more);
                return !workload.is_exceeded(i) && !is_stopped();
            });
            tasks[i].is_done = !is_stopped(); // else its simulations may have ended early
        }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

/// Why there are no tolerances; empty if there are.
std::string refusal_of(const CheckJob& job, const CheckRun& run) {
    if (run.stopped) return "the program was not checked to its end";
    if (!job.start_line.empty()) return "the check began in the middle of the program";
    if (job.engine != Engine::exact) return "the coprocessor judged the clearances";
    if (run.verdict != core::Verdict::clear)
        return "the verdict is not clear: there is nothing to keep";
    for (const core::Finding& finding : run.findings)
        if (finding.rule == "over-travel" || finding.rule == "tool-change-unsafe")
            return "an axis leaves its range, or a tool change is unsafe: there is nothing to keep";
    return {};
}

} // namespace

core::Result<Tolerances> tolerances_of(const CheckJob& job, const CheckRun& run,
                                       const std::function<bool(double)>& goes_on,
                                       size_t most_work) {
    const Stopwatch stopwatch;
    Tolerances tolerances{.refusal = refusal_of(job, run)};
    if (!tolerances.refusal.empty()) return tolerances;
    FEELER_TRY(PreparedCheck check, read_check(job));
    // The box of a dog-leg also holds the straight rapid.
    if (open_rapid_parameter(check.file.environment))
        check.run.setup.machine.rapid = core::RapidStyle::dogleg;
    auto readings = record_readings(check);
    if (!readings) {
        tolerances.refusal = readings.error().message;
        return tolerances;
    }
    if (!check.file.not_judged.empty())
        tolerances.refusal = "the motions were not checked: " + check.file.not_judged;
    for (const RecordedMotions& recorded : *readings)
        if (const RecordedBlock* block = uncertain_block(recorded))
            tolerances.refusal = fmt::format("the path in line {} is not known", block->line);
    if (!tolerances.refusal.empty()) return tolerances;
    ToleranceStudy study(check, *std::move(readings));
    std::vector<Task> tasks = study.tasks();
    Workload workload(tasks.size(), most_work);
    search_all(study, tasks, workload, goes_on);
    for (size_t i = 0; i < tasks.size(); ++i) {
        Task& task = tasks[i];
        if (!task.is_done) {
            tolerances.list.push_back(
                {.deviation = task.result.deviation, .not_studied = "the study was interrupted"});
            continue;
        }
        if (task.result.unknown.empty() && workload.is_exceeded(i)) {
            task.result = {.deviation = task.result.deviation, .not_studied = limit_of(most_work)};
        } else {
            study.confirm_course(task); // reads subprograms, so not on several threads
            tolerances.runs += task.runs;
            tolerances.work += workload.done_by(i);
        }
        tolerances.list.push_back(std::move(task.result));
    }
    tolerances.seconds = stopwatch.seconds();
    return tolerances;
}

} // namespace app
