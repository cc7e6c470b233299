#include "app/gate/line_check.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "app/check/block_events.h"
#include "app/guard/live_setup.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_length.h"
#include "app/setup/toml_edit.h"
#include "core/base/rule_table.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace app {
namespace {

constexpr std::string_view who = "the gate";
constexpr size_t offset_count = 6; // G54 to G59

core::Result<SetupFile> read_text(const std::string& text, const std::string& path) {
    ProgramSettings settings;
    settings.dialect = gcode::DialectId::grbl;
    return read_setup_text(text, path, settings);
}

/// The text of a set-up with the control's work offsets.
core::Result<std::string> with_offsets(std::string text, const GrblFacts& facts,
                                       gcode::LengthUnit unit) {
    for (size_t i = 0; i < offset_count; ++i) {
        const core::Vec3 zero = facts.offsets[i] + facts.axis_offset;
        const std::string value =
            fmt::format("{{ X = {}, Y = {}, Z = {} }}", exact_length(zero.x, unit),
                        exact_length(zero.y, unit), exact_length(zero.z, unit));
        FEELER_TRY(text, toml_with_value(text, {"offsets", gcode::name_of_offset(i)}, value));
    }
    return text;
}

gcode::AxisValues axis_values(const core::Vec3& v) { return {v.x, v.y, v.z}; }

core::AxisPosition position_at(const core::Vec3& v) {
    core::AxisPosition position;
    for (size_t i = 0; i < 3; ++i) position[i] = v[static_cast<int>(i)];
    return position;
}

bool is_among(double number, std::initializer_list<double> numbers) {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

/// Whether a line has only motions and modes whose effect is over when Grbl has taken it in.
bool is_plain(const std::string& text) {
    for (size_t i = 0; i < text.size(); ++i) {
        const char letter = text[i];
        if (std::isalpha(static_cast<unsigned char>(letter)) == 0) continue;
        if (letter != 'G') {
            if (std::string_view("NXYZIJKRFS").find(letter) == std::string_view::npos) return false;
            continue;
        }
        const double code = std::strtod(text.c_str() + i + 1, nullptr);
        if (!is_among(code, {0, 1, 2, 3, 17, 18, 19, 20, 21, 54, 55, 56, 57, 58, 59, 90, 91, 94}))
            return false;
    }
    return true;
}

/// Whether a line may set an offset: G10, G43.1, G49, G92 and G92.1.
bool sets_offsets(const std::string& text) {
    for (const std::string_view code : {"G10", "G43", "G49", "G92"})
        if (text.find(code) != std::string::npos) return true;
    return false;
}

/// An M code that Grbl refuses and that a check accepts, because many senders act on it.
std::optional<int> refused_machine_code(const std::string& text) {
    for (size_t at = text.find('M'); at != std::string::npos; at = text.find('M', at + 1)) {
        const double code = std::strtod(text.c_str() + at + 1, nullptr);
        if (!is_among(code, {0, 1, 2, 3, 4, 5, 7, 8, 9, 30})) return static_cast<int>(code);
    }
    return {};
}

/// A line whose text Grbl does not read as the check does, as far as that is known.
LineVerdict not_understood(std::string why, int error) {
    LineVerdict verdict;
    verdict.answer.reason = std::move(why);
    verdict.error = error;
    return verdict;
}

const core::Motion* motion_in(const core::Event& event) {
    return std::get_if<core::Motion>(&event);
}

bool moves(const core::Event& event) {
    const core::Motion* const motion = motion_in(event);
    return motion && (motion->arc || motion->from != motion->to);
}

/// Whether a motion is long enough for Grbl to plan it: at least a step of one axis.
bool is_planned(const core::Event& event, const core::Vec3& step) {
    const core::Motion* const motion = motion_in(event);
    for (size_t i = 0; motion && i < 3; ++i) {
        const double least = step[static_cast<int>(i)];
        if (least > 0.0 && std::abs(*motion->to[i] - *motion->from[i]) >= least) return true;
    }
    return false;
}

void lower_by(core::Event& event, double z) {
    auto* const motion = std::get_if<core::Motion>(&event);
    if (!motion) return;
    *motion->from[2] -= z;
    *motion->to[2] -= z;
    if (motion->arc) motion->arc->centre.z -= z;
}

std::string number(double value) { return fmt::format("{:.3f}", value); }

} // namespace

core::Result<LineCheck> LineCheck::open(const std::string& setup, std::optional<int> tool,
                                        double tolerance) {
    LineCheck check;
    check.path_ = setup;
    check.tolerance_ = tolerance;
    FEELER_TRY(SetupFile file, read_setup(setup, {})); // says what is wrong with the file
    std::ifstream in(setup, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    check.text_ = text.str();
    check.takes_offsets_ = file.infers_frame;
    if (file.dialect && *file.dialect != gcode::DialectId::grbl)
        return core::fail_file(setup, fmt::format("the gate is for Grbl, and the set-up is for {}",
                                                  gcode::dialect(*file.dialect).name));
    if (check.takes_offsets_) {
        FEELER_TRY(const std::string whole, with_offsets(check.text_, {}, file.length_unit));
        FEELER_TRY(file, read_text(whole, setup));
    }
    if (std::string why = why_incomplete(file, who); !why.empty())
        return core::fail_file(setup, std::move(why));
    if (file.setup.machine.has_rotary())
        return core::fail_file(setup, "Grbl has no rotary axes, and the set-up's machine has");
    const auto& tools = file.setup.tools;
    if (tool)
        check.tool_ = core::ToolNumber{*tool};
    else if (file.setup.tool_at_start)
        check.tool_ = file.setup.tool_at_start;
    else if (tools.size() == 1)
        check.tool_ = tools.begin()->first;
    else
        return core::fail_file(setup, "has several tools: say which one is in the spindle, by "
                                      "tool_at_start under [program] or --tool");
    if (!tools.contains(*check.tool_))
        return core::fail_file(
            setup, fmt::format("does not describe tool {}", core::value_of(*check.tool_)));
    check.file_ = std::move(file);
    return check;
}

/// Reads the set-up with the control's offsets, if it takes them.
core::Result<void> LineCheck::place(const GrblFacts& facts, const core::Vec3& position) {
    problem_.clear();
    if (!facts.active()) {
        problem_ = "The control does not say which work offset it uses.";
        return {};
    }
    if (!facts.stored_line.empty()) {
        problem_ = fmt::format("Grbl runs the stored line {} at each reset, and nobody checks it: "
                               "clear it ($N0= and $N1=) without the gate.",
                               facts.stored_line);
        return {};
    }
    bool is_elsewhere = !judge_;
    if (judge_ && takes_offsets_) {
        const gcode::AxisValues known = file_->environment.work_offset(*facts.active());
        const core::Vec3 zero = facts.zero();
        const auto differs = [&](int axis) {
            const double shift = axis == 2 ? shift_ : 0.0;
            return std::abs(zero[axis] - known[static_cast<size_t>(axis)] - shift) > tolerance_;
        };
        const bool is_beside = differs(0) || differs(1);
        const bool may_be_tool = cuts_before_tool_ && *cuts_before_tool_ == cuts();
        if (!is_beside && differs(2) && may_be_tool) {
            // The tip of the new tool was touched off: the bodies stay where they are.
            shift_ = zero.z - known[2];
        } else if (is_beside || differs(2)) {
            is_elsewhere = !has_cut_;
        }
    }
    if (is_elsewhere && takes_offsets_) {
        FEELER_TRY(const std::string text, with_offsets(text_, facts, file_->length_unit));
        FEELER_TRY(SetupFile file, read_text(text, path_));
        file_ = std::move(file);
        shift_ = 0.0;
    }
    core::Setup setup = file_->setup;
    core::MachineAxis& z = setup.machine.axes[2];
    if (z.min) *z.min -= shift_;
    if (z.max) *z.max -= shift_;
    setup.machine.rapid = core::RapidStyle::straight;
    const auto stands = [&](const core::MachineBody& body) {
        return body.link != setup.machine.spindle;
    };
    if (shift_ != 0.0
        && std::any_of(setup.machine.bodies.begin(), setup.machine.bodies.end(), stands))
        problem_ = "The tool was changed and touched off, so where the machine's own bodies are is "
                   "not known any more. Restart the gate.";
    gcode::Environment environment = file_->environment;
    environment.dialect = gcode::DialectId::grbl;
    if (auto notes = apply(file_->control, environment, setup.machine); !notes)
        return tl::unexpected(std::move(notes).error());
    environment_ = std::move(environment);
    judge_.emplace(setup);
    if (is_elsewhere) {
        made_.reset();
        has_cut_ = false;
    }
    if (made_) return {};
    FEELER_TRY(core::SimulatorState state,
               core::start_of_run(judge_->setup(), position_at(position)));
    state.is_assumed = {};
    state.tool = tool_;
    state.tool_known = true;
    made_ = std::move(state);
    return {};
}

/// Brings the model of the control to where the control is.
void LineCheck::take_modes(const GrblFacts& facts, const core::Vec3& position) {
    environment_.control.reports_premises = true;
    for (size_t i = 0; i < offset_count; ++i)
        environment_.work_offsets[i] = axis_values(facts.offsets[i]);
    environment_.home = axis_values(facts.home);
    environment_.second_home = axis_values(facts.second_home);
    environment_.start = position_at(position);
    environment_.startup_code.clear();
    std::optional<gcode::MotionCode> motion;
    core::SpindleChange spindle;
    bool has_feed = false;
    std::istringstream words(facts.modes);
    for (std::string word; words >> word;) {
        const double value = std::strtod(word.c_str() + 1, nullptr);
        if (word == "G0") motion = gcode::MotionCode::rapid;
        if (word == "G1") motion = gcode::MotionCode::straight;
        if (word == "G2") motion = gcode::MotionCode::arc_clockwise;
        if (word == "G3") motion = gcode::MotionCode::arc_counterclockwise;
        if (word[0] == 'G' && is_plain(word) && !is_among(value, {0, 1, 2, 3}))
            environment_.startup_code += word + ' ';
        if (word == "G93") environment_.startup_code += word + ' ';
        if (word == "M3") spindle.direction = core::SpindleDirection::clockwise;
        if (word == "M4") spindle.direction = core::SpindleDirection::counterclockwise;
        if (word[0] == 'S') spindle.speed = value;
        if (word[0] == 'F') has_feed = value > 0.0;
    }
    control_ = gcode::initial_state(environment_);
    gcode::ModalState& modal = control_.modal;
    modal.motion = motion;
    modal.motion_cancelled = !motion;
    if (has_feed) modal.feed = 1.0; // its value does not matter
    modal.spindle = spindle.direction;
    modal.speed = spindle.speed;
    for (size_t i = 0; i < 3; ++i) modal.offsets.axis[i] = facts.axis_offset[static_cast<int>(i)];
    modal.axis_offset_on = facts.axis_offset != core::Vec3(0.0);
    modal.offsets.tool[2] = facts.length_offset;
    modal.position = gcode::program_from_machine(modal.offsets, environment_.start);
    lowering_ = gcode::initial_lowering(control_);
    if (file_->speed_by_hand && spindle.direction != core::SpindleDirection::stopped)
        spindle.speed = std::max(spindle.speed, 1.0);
    // A spindle that is switched by hand.
    if (spindle.direction == core::SpindleDirection::stopped
        && file_->setup.spindle_at_start != core::SpindleDirection::stopped)
        spindle = {file_->setup.spindle_at_start, 1.0};
    step_ = facts.step;
    made_->spindle = spindle;
    if (facts.is_reset) called_.reset(); // otherwise Grbl itself forgets it with the next line
}

core::Result<void> LineCheck::synchronise(const GrblFacts& facts, const core::Vec3& position,
                                          uint64_t made_through) {
    if (judge_) follow(made_through, waiting_.size());
    // A part of the others may have been made.
    has_cut_ = has_cut_ || cuts() > 0;
    waiting_.clear();
    if (auto placed = place(facts, position); !placed) return placed;
    if (!made_) return {};
    take_modes(facts, position);
    put_at(*made_, position_at(position - core::Vec3(0.0, 0.0, shift_)));
    made_->tool = tool_;
    ahead_ = *made_;
    may_retreat_ = true;
    return {};
}

std::string LineCheck::objection() const {
    return ahead_ ? objection(lowering_.offsets) : problem_;
}

/// Why no motion may be made with these offsets; empty if there is no reason.
std::string LineCheck::objection(const gcode::Offsets& offsets) const {
    if (!problem_.empty()) return problem_;
    const std::string name = gcode::name_of_offset(offsets.active);
    if (!states_work_offset(*file_, offsets.active))
        return fmt::format("{} is in use, and the set-up does not state it.", name);
    const gcode::AxisValues stated = file_->environment.work_offset(offsets.active);
    for (size_t axis = 0; axis < 3; ++axis) {
        const double zero = offsets.work.origin[axis] + offsets.axis[axis].value_or(core::infinity);
        const double expected = stated[axis] + (axis == 2 ? shift_ : 0.0);
        if (std::abs(zero - expected) <= tolerance_) continue;
        return fmt::format("{}{} {} is {} on the control and {} {} (mm).{}", name,
                           offsets.axis[axis].value_or(0.0) != 0.0 ? " with G92" : "",
                           core::axis_letters[axis], number(zero), number(expected),
                           takes_offsets_ ? "since the stock was cut" : "in the set-up",
                           takes_offsets_ ? " If there is a new workpiece, send $FEELER=NEW." : "");
    }
    const core::ToolAssembly& tool = file_->setup.tools.at(*tool_);
    if (std::abs(offsets.tool[2] - tool.length) > tolerance_)
        return fmt::format(
            "The length of tool {} is {} on the control (G43.1) and {} in the set-up "
            "(mm). A tool that is touched off has touched_off = 0 there.",
            core::value_of(*tool_), number(offsets.tool[2]), number(tool.length));
    if (called_ && *called_ != *tool_)
        return fmt::format(
            "The program calls tool {0}, and tool {1} is in the spindle. Reset, change "
            "the tool, and send $FEELER=T{0}.",
            core::value_of(*called_), core::value_of(*tool_));
    return {};
}

/// Brings `ahead_` back to behind the lines that may be sent.
void LineCheck::rewind() {
    ahead_ = *made_;
    for (const Permitted& line : waiting_) judge_->follow(line.events, *ahead_);
}

LineVerdict LineCheck::judge_motions(LineVerdict verdict, std::vector<core::Event> events) {
    if (verdict.stops_at_contact) {
        verdict.answer.reason = judge_->problem_beyond_contact(events, *ahead_);
        if (!verdict.answer.reason.empty()) return verdict;
    }
    verdict.answer = judge_->judge(events, *ahead_);
    if (verdict.answer.may_move) {
        may_retreat_ = false;
        return verdict;
    }
    rewind();
    if (!may_retreat_) return verdict;
    const LiveAnswer retreat = judge_->judge_retreat(std::move(events), 0.0, *ahead_);
    if (retreat.may_move)
        verdict.answer = retreat;
    else
        rewind();
    return verdict;
}

LineVerdict LineCheck::judge(uint64_t number, const std::string& text, bool is_jog) {
    if (!ahead_) return not_understood(problem_, 9);
    if (const auto code = refused_machine_code(text))
        return not_understood(fmt::format("Grbl has no M{}.", *code), 20);
    // Grbl makes such a jog to machine zero.
    if (is_jog && text.find_first_of("XYZ") == std::string::npos)
        return not_understood("It has no axis.", 26);
    const std::string line = is_jog ? "G1G94" + text.substr(3) : text;
    auto program = gcode::program_from_text(line, "the line");
    if (!program) return not_understood(program.error().message, 20);
    gcode::ProgramLibrary library(*program, gcode::dialect(gcode::DialectId::grbl));
    gcode::Interpreter interpreter(library, environment_);
    gcode::InterpreterState control = control_;
    control.next = {};
    control.ending = gcode::ProgramStatus::running;
    control.after_end = false;
    const auto read = interpreter.next(control);
    if (!read) return not_understood(read.error().message, grbl_error_in(read.error().message));
    LineVerdict verdict;
    verdict.is_plain = is_plain(text);
    verdict.changes_offsets = sets_offsets(text);
    verdict.answer.may_move = true;
    if (!*read) { // it sets modes
        if (!is_jog) control_ = std::move(control);
        return verdict;
    }
    const gcode::BlockCommands& block = **read;
    for (const gcode::Warning& warning : block.warnings)
        if (warning.rule == core::rule_id("no-feed"))
            return not_understood("No F has been programmed yet.", 22);
    if (control.readings->met.size() > control_.readings->met.size())
        return not_understood(control.readings->met.back().reason + ".", 20);
    if (block.path != core::PathCertainty::known)
        return not_understood("Where this line moves is not known.", 20);

    gcode::Lowering lowering = lowering_;
    std::vector<core::Event> events =
        events_of(judge_->setup(), block, lowering, file_->speed_by_hand);
    std::erase_if(events,
                  [](const core::Event& event) { return motion_in(event) && !moves(event); });
    for (core::Event& event : events) lower_by(event, shift_);
    verdict.moves = std::any_of(events.begin(), events.end(), moves);
    verdict.fills_planner =
        std::any_of(events.begin(), events.end(),
                    [&](const core::Event& event) { return is_planned(event, step_); });
    verdict.stops_at_contact =
        std::any_of(events.begin(), events.end(), [](const core::Event& event) {
            return motion_in(event) && motion_in(event)->stops_at_contact;
        });
    const auto called = control.modal.selected_tool;
    if (called) called_ = called;
    if (verdict.moves) {
        if (std::string why = objection(lowering.offsets); !why.empty())
            return not_understood(std::move(why), 9);
        verdict.answer.may_move = false;
        verdict = judge_motions(std::move(verdict), events);
        if (!verdict.answer.may_move) return verdict;
    } else {
        judge_->follow(events, *ahead_);
    }
    if (is_jog) {
        // Only the position stays.
        control_.modal.position =
            gcode::program_from_machine(control_.modal.offsets, lowering.machine);
        lowering_.machine = lowering.machine;
    } else {
        control_ = std::move(control);
        lowering_ = lowering;
    }
    waiting_.push_back({number, std::move(events)});
    return verdict;
}

bool LineCheck::follow(uint64_t made_through, size_t most) {
    const auto is_made = [&] {
        return !waiting_.empty() && waiting_.front().number <= made_through;
    };
    for (; most > 0 && is_made(); --most) {
        const std::vector<core::Event>& events = waiting_.front().events;
        judge_->follow(events, *made_);
        waiting_.pop_front();
    }
    return is_made();
}

/// How many motions have cut, or may have.
size_t LineCheck::cuts() const { return ahead_ ? ahead_->stock.log.size() : 0; }

core::Result<void> LineCheck::change_tool(int number) {
    const core::ToolNumber tool{number};
    if (!file_->setup.tools.contains(tool))
        return core::fail_file(path_, fmt::format("does not describe tool {}", number));
    if (tool_ != tool) cuts_before_tool_ = cuts();
    tool_ = tool;
    return {};
}

void LineCheck::renew_stock() {
    judge_.reset(); // with the next synchronise
    made_.reset();
    ahead_.reset();
    waiting_.clear();
    has_cut_ = false;
}

} // namespace app
