#include "app/gate/line_check.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "app/check/block_events.h"
#include "app/guard/live_setup.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_length.h"
#include "app/setup/toml_edit.h"
#include "core/base/file_reads.h"
#include "core/base/rule_table.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace app {
namespace {

constexpr std::string_view who = "the gate";
constexpr size_t offset_count = 6;         // G54 to G59
constexpr double most_correction = 0.2;    // of Z after the first cut, mm
constexpr double least_arc_error = 0.0005; // mm: $$ shows three digits
constexpr double most_arc_error = 0.02;    // mm
constexpr double least_difference = 5e-4;  // of numbers, mm or inches

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

/// A letter with its number, as Grbl reads it: of more than eight digits, it drops the others.
struct GrblWord {
    char letter = 0;
    double value = 0.0, exact = 0.0;
};

/// A number of digits with or without a sign and a point.
double number_in(std::string_view text) {
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    double value = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// The words of a line; empty if it has another form.
std::optional<std::vector<GrblWord>> words_of(const std::string& text) {
    constexpr int most_digits = 8;
    std::vector<GrblWord> words;
    for (size_t i = 0; i < text.size();) {
        GrblWord word;
        word.letter = text[i++];
        if (std::isalpha(static_cast<unsigned char>(word.letter)) == 0) return {};
        const size_t begin = i;
        if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
        std::string kept = text.substr(begin, i - begin);
        int digits = 0;
        bool has_point = false;
        for (; i < text.size(); ++i) {
            if (text[i] == '.' && !std::exchange(has_point, true)) {
                kept += '.';
            } else if (std::isdigit(static_cast<unsigned char>(text[i])) != 0) {
                if (++digits <= most_digits)
                    kept += text[i];
                else if (!has_point)
                    kept += '0';
            } else {
                break;
            }
        }
        if (digits == 0) return {};
        word.value = number_in(kept);
        word.exact = number_in(text.substr(begin, i - begin));
        words.push_back(word);
    }
    return words;
}

/// Modal groups of the codes that plain lines may have.
std::optional<int> plain_group(double code) {
    if (is_among(code, {0, 1})) return 1;
    if (is_among(code, {17, 18, 19})) return 2;
    if (is_among(code, {90, 91})) return 3;
    if (is_among(code, {20, 21})) return 6;
    if (is_among(code, {54, 55, 56, 57, 58, 59})) return 12;
    return {};
}

/// Whether a line has only straight motions and modes whose effect is over when Grbl has taken it
/// in, and nothing for which Grbl may refuse it.
bool is_plain(const std::vector<GrblWord>& words) {
    std::string seen;
    std::set<int> groups;
    for (const GrblWord& word : words) {
        if (word.letter == 'G') {
            const auto group = plain_group(word.value);
            if (!group || !groups.insert(*group).second) return false;
            continue;
        }
        constexpr double most_lines = 1e7;
        if (std::string_view("NXYZFS").find(word.letter) == std::string_view::npos) return false;
        if (seen.find(word.letter) != std::string::npos) return false;
        seen += word.letter;
        if (word.letter == 'F' && !(word.value > 0.0)) return false;
        if (word.letter == 'S' && word.value < 0.0) return false;
        if (word.letter == 'N' && !(word.value >= 0.0 && word.value < most_lines)) return false;
    }
    return true;
}

bool stores_offset(const std::string& text) { return text.find("G10") != std::string::npos; }

/// Whether a line may set an offset without storing it: G43.1, G49, G92 and G92.1.
bool sets_offsets(const std::string& text) {
    for (const std::string_view code : {"G43", "G49", "G92"})
        if (text.find(code) != std::string::npos) return true;
    return false;
}

/// An M code that Grbl refuses and that a check accepts, because many senders act on it.
std::optional<double> refused_machine_code(const std::vector<GrblWord>& words) {
    for (const GrblWord& word : words)
        if (word.letter == 'M' && !is_among(word.value, {0, 1, 2, 3, 4, 5, 7, 8, 9, 30}))
            return word.value;
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
        // A little more, since Grbl rounds its numbers.
        if (least > 0.0 && std::abs(*motion->to[i] - *motion->from[i]) >= 1.1 * least) return true;
    }
    return false;
}

bool has_arc(const std::vector<core::Event>& events) {
    return std::any_of(events.begin(), events.end(), [](const core::Event& event) {
        return motion_in(event) && motion_in(event)->arc;
    });
}

/// Whether an arc ends so near to its start that Grbl, with its single floats and from a place that
/// is known to a step only, may make a full circle of it, or leave a full circle out.
bool is_doubtful_arc(const core::Event& event, const core::Vec3& step) {
    const core::Motion* const motion = motion_in(event);
    if (!motion || !motion->arc) return false;
    constexpr double rounding = 0.002, usual_step = 0.02; // mm
    const double of_steps = glm::length(step) > 0.0 ? glm::length(step) : usual_step;
    core::Vec3 chord(0.0);
    for (int by = 1; by <= 2; ++by) {
        const auto axis = static_cast<size_t>((motion->arc->normal + by) % 3);
        chord[by] = *motion->to[axis] - *motion->from[axis];
    }
    const double length = glm::length(chord);
    return length > 0.0 && length < 1.5 * of_steps + rounding;
}

/// Squares of the radii at the start and the end of an arc, and of its chord.
struct ArcSquares {
    double start = 0.0, end = 0.0, chord = 0.0;

    explicit ArcSquares(const core::Motion& motion) {
        const auto square = [](double x) { return x * x; };
        for (int by = 1; by <= 2; ++by) {
            const int axis = (motion.arc->normal + by) % 3;
            const auto i = static_cast<size_t>(axis);
            start += square(*motion.from[i] - motion.arc->centre[axis]);
            end += square(*motion.to[i] - motion.arc->centre[axis]);
            chord += square(*motion.to[i] - *motion.from[i]);
        }
    }
};

/// How far from a circle of its start's radius an arc ends: Grbl follows that circle to the last
/// chord, and accepts up to 0.5 mm.
double radius_error(const ArcSquares& arc) {
    return std::abs(std::sqrt(arc.end) - std::sqrt(arc.start));
}

/// How far Grbl's centre of an arc that is given by its radius may be off: it computes the height
/// of the centre above the chord in single floats, from a difference.
double centre_error(const ArcSquares& arc) {
    constexpr double rounding = 2.4e-7; // of a single float, with that of its operands
    const double height = std::max(0.0, 4.0 * arc.start - arc.chord);
    const double off = 4.0 * arc.start * rounding;
    const double less = std::sqrt(height) - std::sqrt(std::max(0.0, height - off));
    return 0.5 * std::max(less, std::sqrt(height + off) - std::sqrt(height));
}

/// Lets arcs be as far from their paths as Grbl may make them.
void widen_arcs(std::vector<core::Event>& events, bool by_radius) {
    constexpr double negligible = 0.005; // mm, as decimals of programs are rounded
    for (core::Event& event : events) {
        auto* const motion = std::get_if<core::Motion>(&event);
        if (!motion || !motion->arc) continue;
        const ArcSquares arc(*motion);
        const double off = by_radius ? centre_error(arc) : radius_error(arc);
        if (off > negligible) motion->path_error += off;
    }
}

/// The events with arcs of less than a turn.
std::vector<core::Event> with_short_arcs(std::vector<core::Event> events) {
    for (core::Event& event : events)
        if (auto* const motion = std::get_if<core::Motion>(&event); motion && motion->arc)
            motion->arc->angle = std::remainder(motion->arc->angle, 2.0 * std::numbers::pi);
    return events;
}

/// The events with full circles in place of short arcs.
std::vector<core::Event> with_full_circles(std::vector<core::Event> events) {
    for (core::Event& event : events)
        if (auto* const motion = std::get_if<core::Motion>(&event); motion && motion->arc)
            motion->arc->angle = std::copysign(2.0 * std::numbers::pi, motion->arc->angle);
    return events;
}

void lower_by(core::Event& event, double z) {
    auto* const motion = std::get_if<core::Motion>(&event);
    if (!motion) return;
    *motion->from[2] -= z;
    *motion->to[2] -= z;
    if (motion->arc) motion->arc->centre.z -= z;
}

/// Whether two places are the same but for what a controller rounds in its reports.
bool is_near(const core::AxisPosition& a, const core::AxisPosition& b) {
    constexpr double rounding = 0.05; // mm
    for (size_t i = 0; i < 3; ++i)
        if (!a[i] || !b[i] || !(std::abs(*a[i] - *b[i]) <= rounding)) return false;
    return true;
}

std::string number(double value) { return fmt::format("{:.3f}", value); }

} // namespace

core::Result<LineCheck> LineCheck::open(const std::string& setup, const Options& options) {
    LineCheck check;
    check.path_ = setup;
    check.tolerance_ = options.tolerance;
    FEELER_TRY(SetupFile file, read_setup(setup, {})); // says what is wrong with the file
    check.text_ = core::file_bytes(setup).value_or("");
    check.takes_offsets_ = file.infers_frame;
    check.is_set_up_ = !check.takes_offsets_;
    check.zero_is_set_ = options.zero_is_set;
    if (file.dialect && *file.dialect != gcode::DialectId::grbl)
        return core::fail_file(setup, fmt::format("the gate is for Grbl, and the set-up is for {}",
                                                  gcode::dialect(*file.dialect).name));
    if (check.takes_offsets_) {
        FEELER_TRY(const std::string whole, with_offsets(check.text_, {}, file.length_unit));
        FEELER_TRY(file, read_text(whole, setup));
    }
    if (std::string why = why_incomplete(file, who); !why.empty())
        return core::fail_file(setup, std::move(why));
    if (file.loses_machine)
        return core::fail_file(setup,
                               "has tools of different lengths that are touched off, so where "
                               "its machine bodies are is not known: state the lengths (G43.1), "
                               "or leave the bodies out");
    if (file.setup.machine.has_rotary())
        return core::fail_file(setup, "Grbl has no rotary axes, and the set-up's machine has");
    const auto& tools = file.setup.tools;
    if (options.tool)
        check.tool_ = core::ToolNumber{*options.tool};
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
    check.environment_ = file.environment;
    check.environment_.dialect = gcode::DialectId::grbl;
    if (auto notes = apply(file.control, check.environment_, file.setup.machine); !notes)
        return tl::unexpected(core::in_file(notes.error(), setup));
    file.setup.machine.rapid = core::RapidStyle::straight;
    // The control says where it starts, and where its reference points are.
    std::erase_if(file.assumptions, [&](const std::string& assumption) {
        return assumption == file.start_assumption
               || assumption.find("home position") != std::string::npos;
    });
    check.file_ = std::move(file);
    return check;
}

std::string LineCheck::why_not(const OperatorWord& word) const {
    if (word.tool && !file_->setup.tools.contains(core::ToolNumber{*word.tool}))
        return fmt::format("The set-up does not describe tool {}.", *word.tool);
    return {};
}

/// Builds the model at the place where the control has its zero, with uncut stock.
core::Result<void> LineCheck::build(const GrblFacts& facts) {
    if (takes_offsets_) {
        FEELER_TRY(const std::string text, with_offsets(text_, facts, file_->length_unit));
        FEELER_TRY(SetupFile file, read_text(text, path_));
        file.setup.machine.rapid = core::RapidStyle::straight;
        file_ = std::move(file);
    }
    shift_ = shift_of_tool_ = 0.0;
    judge_.emplace(file_->setup);
    FEELER_TRY(core::SimulatorState state, core::start_of_run(judge_->setup(), {}));
    state.is_assumed = {};
    state.tool_known = true;
    made_ = std::move(state);
    has_cut_ = false;
    return {};
}

/// Lets the bodies stay where they are although Z of the control has moved by this, since another
/// tool was touched off. False if that is not possible.
bool LineCheck::use_shift(double z) {
    core::Setup setup = file_->setup;
    const auto stands = [&](const core::MachineBody& body) {
        return body.link != setup.machine.spindle;
    };
    const auto& bodies = setup.machine.bodies;
    if (std::any_of(bodies.begin(), bodies.end(), stands)) return false;
    shift_ = z;
    core::MachineAxis& axis = setup.machine.axes[2];
    if (axis.min) *axis.min -= shift_;
    if (axis.max) *axis.max -= shift_;
    judge_.emplace(setup);
    return true;
}

/// The operator says that the work lies at the zero of the control.
core::Result<void> LineCheck::take_zero(const GrblFacts& facts, bool is_new_workpiece) {
    is_set_up_ = true;
    if (!made_ || is_new_workpiece) return build(facts);
    if (!takes_offsets_) return {}; // compared with the set-up's
    const gcode::AxisValues known = file_->environment.work_offset(*facts.active());
    core::Vec3 by = facts.zero();
    for (int axis = 0; axis < 3; ++axis) by[axis] -= known[static_cast<size_t>(axis)];
    const bool is_beside = std::abs(by.x) > tolerance_ || std::abs(by.y) > tolerance_;
    const bool is_above = std::abs(by.z - shift_) > tolerance_;
    if (!is_beside && !is_above) return {};
    if (!has_cut_) return build(facts);
    if (!is_beside && tool_was_changed_ && use_shift(by.z)) {
        shift_of_tool_ = shift_;
        return {};
    }
    const bool is_correction = std::abs(by.z - shift_of_tool_) <= most_correction;
    if (!is_beside && is_correction && use_shift(by.z)) return {};
    is_set_up_ = false;
    problem_ = fmt::format(
        "The zero has moved by X{} Y{} Z{} mm since the stock was cut. {}If there is a "
        "new workpiece, send $FEELER=NEW.",
        number(by.x), number(by.y), number(by.z - shift_), is_beside ? "" : tool_note());
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
    core::SpindleChange& spindle = spindle_ = {};
    bool has_feed = false;
    std::istringstream words(facts.modes);
    for (std::string word; words >> word;) {
        const double value = number_in(std::string_view(word).substr(1));
        if (word == "G0") motion = gcode::MotionCode::rapid;
        if (word == "G1") motion = gcode::MotionCode::straight;
        if (word == "G2") motion = gcode::MotionCode::arc_clockwise;
        if (word == "G3") motion = gcode::MotionCode::arc_counterclockwise;
        if (word == "G38.2") motion = gcode::MotionCode::probe_toward;
        if (word == "G38.3") motion = gcode::MotionCode::try_probe_toward;
        if (word == "G38.4") motion = gcode::MotionCode::probe_away;
        if (word == "G38.5") motion = gcode::MotionCode::try_probe_away;
        if (word[0] == 'G' && (plain_group(value).value_or(1) != 1 || value == 93.0))
            environment_.startup_code += word + ' ';
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
    if (facts.is_reset) programs_spindle_ = false;
    // A spindle that is switched by hand.
    if (!programs_spindle_ && spindle.direction == core::SpindleDirection::stopped
        && file_->setup.spindle_at_start != core::SpindleDirection::stopped)
        spindle = {file_->setup.spindle_at_start, 1.0};
    step_ = facts.step;
    arc_error_ = facts.arc_tolerance;
}

void LineCheck::synchronise(const GrblFacts& facts, const core::Vec3& position,
                            uint64_t made_through, const std::optional<OperatorWord>& word) {
    using Kind = OperatorWord::Kind;
    look_at_setup();
    if (judge_) follow(made_through, waiting_.size());
    // A part of the others may have been made, but not in check mode.
    has_cut_ = has_cut_ || (made_ && made_->stock.log.size() > 0) || (!facts.is_dry && cuts() > 0);
    const core::AxisPosition before = ahead_ ? ahead_->position : core::AxisPosition();
    waiting_.clear();
    ahead_.reset();
    jogged_.reset();
    problem_.clear();
    const bool says_zero = (word && word->kind != Kind::sets_up)
                           || (std::exchange(zero_is_set_, false) && !facts.is_lost);
    // The zero was set on a machine that did not know its place before.
    const bool moves_zero = facts.was_homed && takes_offsets_ && is_set_up_ && made_;
    if (facts.is_lost || moves_zero || (word && word->kind == Kind::sets_up)) is_set_up_ = false;
    if (word && word->tool) {
        tool_ = core::ToolNumber{*word->tool};
        tool_was_changed_ = true;
        called_.reset();
    }
    if (!facts.active())
        problem_ = "The control does not say which work offset it uses.";
    else if (const std::string mode = facts.unknown_mode(); !mode.empty())
        problem_ =
            fmt::format("The control is in mode {}, which Grbl 1.1 does not have, so where it "
                        "moves is not known. Leave this mode.",
                        mode);
    else if (!facts.stored_line.empty())
        problem_ = fmt::format("Grbl runs the stored line {} at each reset, and nobody checks it: "
                               "clear it ($N0= and $N1=) without the gate.",
                               facts.stored_line);
    else if (says_zero)
        note_failure(take_zero(facts, word && word->kind == Kind::new_workpiece));
    if (is_set_up_) tool_was_changed_ = false;
    if (is_set_up_ && !made_) note_failure(build(facts));
    if (facts.is_lost && !says_zero)
        problem_ = facts.ended_homing
                       ? "A homing was not finished, so where the machine stands is not known. "
                         "Home it again, or touch off."
                       : "The controller was restarted, and takes its place for zero. Home it, or "
                         "touch off.";
    if (moves_zero && !says_zero)
        problem_ = "The machine was homed after the zero was set, so the zero may be elsewhere.";
    take_modes(facts, position);
    knows_control_ = true;
    if (!is_set_up_) return;
    const core::AxisPosition here = position_at(position - core::Vec3(0.0, 0.0, shift_));
    // Otherwise an end of a retreat is no new beginning.
    if (!is_near(before, here)) judge_->begin_retreat();
    put_at(*made_, here);
    made_->tool = tool_;
    made_->spindle = spindle_;
    ahead_ = *made_;
    may_retreat_ = true;
}

/// Without a model, nothing can be checked.
void LineCheck::note_failure(const core::Result<void>& done) {
    if (done) return;
    is_set_up_ = false;
    made_.reset();
    problem_ = done.error().message + ".";
}

std::string LineCheck::objection() const {
    constexpr const char* to_confirm =
        "Jogs, probing and motions straight up pass unchecked, and no others, until you send "
        "$FEELER=ZERO: the zero is set, and the work is where the set-up says.";
    if (is_set_up_) return objection(lowering_.offsets, called_);
    return problem_.empty() ? to_confirm : problem_ + " " + to_confirm;
}

/// What to say where the tool may be another one.
std::string LineCheck::tool_note() const {
    return fmt::format(
        "If another tool was touched off, send $FEELER=T and its number first; tool {} "
        "is taken to be in the spindle. ",
        core::value_of(*tool_));
}

/// Why no motion may be made with these offsets; empty if there is no reason.
std::string LineCheck::objection(const gcode::Offsets& offsets,
                                 std::optional<core::ToolNumber> called) const {
    if (!problem_.empty()) return problem_;
    if (has_changed_)
        return "The set-up file has changed since the gate has read it: start the gate again.";
    const std::string name = gcode::name_of_offset(offsets.active);
    if (takes_offsets_ && name != file_->stock_frame)
        return fmt::format(
            "{0} is in use, and the bodies of the set-up stand in {1}: let them stand "
            "in {0} (frame), or state all work offsets.",
            name, file_->stock_frame);
    if (!states_work_offset(*file_, offsets.active))
        return fmt::format("{} is in use, and the set-up does not state it.", name);
    const gcode::AxisValues stated = file_->environment.work_offset(offsets.active);
    for (size_t axis = 0; axis < 3; ++axis) {
        const double zero = offsets.work.origin[axis] + offsets.axis[axis].value_or(core::infinity);
        const double expected = stated[axis] + (axis == 2 ? shift_ : 0.0);
        if (std::abs(zero - expected) <= tolerance_) continue;
        const std::string there =
            takes_offsets_ ? fmt::format("was {} when the zero was set (mm). {}If the work "
                                         "lies there now, send $FEELER=ZERO.",
                                         number(expected), tool_note())
                           : fmt::format("{} in the set-up (mm).", number(expected));
        return fmt::format("{}{} {} is {} on the control and {}", name,
                           offsets.axis[axis].value_or(0.0) != 0.0 ? " with G92" : "",
                           core::axis_letters[axis], number(zero), there);
    }
    const core::ToolAssembly& tool = file_->setup.tools.at(*tool_);
    if (std::abs(offsets.tool[2] - tool.length) > tolerance_)
        return fmt::format(
            "The length of tool {} is {} on the control (G43.1) and {} in the set-up "
            "(mm). A tool that is touched off has touched_off = 0 there.",
            core::value_of(*tool_), number(offsets.tool[2]), number(tool.length));
    if (called && *called != *tool_)
        return fmt::format(
            "The program calls tool {0}, and tool {1} is in the spindle. Change the tool, send "
            "$FEELER=T{0}, touch off, and send $FEELER=ZERO.",
            core::value_of(*called), core::value_of(*tool_));
    return {};
}

/// Brings `ahead_` back to behind the lines that may be sent.
void LineCheck::rewind() {
    ahead_ = *made_;
    for (const Permitted& line : waiting_) judge_->follow(line.events, *ahead_);
}

/// While nobody knows where the bodies are.
LineVerdict LineCheck::judge_unchecked(LineVerdict verdict, const std::vector<core::Event>& events,
                                       bool is_jog) const {
    verdict.asks_anew = verdict.asks_anew || (verdict.moves && !is_jog);
    verdict.answer.may_move = is_jog || verdict.stops_at_contact || goes_straight_up(events);
    if (!verdict.answer.may_move) verdict.answer.reason = objection();
    return verdict;
}

LineVerdict LineCheck::judge_motions(LineVerdict verdict, std::vector<core::Event>& events) {
    if (verdict.stops_at_contact) {
        verdict.answer.reason = judge_->problem_beyond_contact(events, *ahead_);
        if (!verdict.answer.reason.empty()) return verdict;
    }
    const bool is_doubtful =
        std::any_of(events.begin(), events.end(),
                    [&](const core::Event& event) { return is_doubtful_arc(event, step_); });
    if (is_doubtful) {
        core::SimulatorState state = *ahead_;
        verdict.answer = judge_->judge(with_full_circles(events), state);
        if (!verdict.answer.may_move) {
            verdict.answer.reason =
                "Grbl may make a full circle of this arc. " + verdict.answer.reason;
            return verdict;
        }
    }
    // What only a full circle would cut stays in the stock.
    verdict.answer = judge_->judge(is_doubtful ? with_short_arcs(events) : events, *ahead_);
    if (is_doubtful && verdict.answer.may_move) events = with_short_arcs(std::move(events));
    if (shift_ != 0.0 && verdict.answer.reason.find("machine coordinates") != std::string::npos)
        verdict.answer.reason +=
            fmt::format(" (Here Z is {} less than on the control, by the length of "
                        "the tool.)",
                        number(shift_));
    if (verdict.answer.may_move) {
        may_retreat_ = false;
        judge_->begin_retreat();
        return verdict;
    }
    rewind();
    verdict.asks_first = jogged_.has_value();
    if (!may_retreat_ || verdict.asks_first) return verdict;
    const LiveAnswer retreat = judge_->judge_retreat(events, 0.0, *ahead_);
    if (retreat.may_move)
        verdict.answer = retreat;
    else
        rewind();
    return verdict;
}

LineVerdict LineCheck::judge_jog(LineVerdict verdict, std::vector<core::Event>& events) {
    core::AxisSpread& spread = ahead_->spread;
    core::AxisRange range;
    for (size_t i = 0; i < core::axis_count; ++i) {
        const double here = ahead_->position[i].value_or(0.0);
        range.min[i] = jogged_ ? std::min(jogged_->min[i], here) : here;
        range.max[i] = jogged_ ? std::max(jogged_->max[i], here) : here;
        spread.below[i] = here - range.min[i];
        spread.above[i] = range.max[i] - here;
    }
    for (core::Event& event : events)
        if (auto* const motion = std::get_if<core::Motion>(&event)) motion->settles = 0;
    const core::AxisPosition before = ahead_->position;
    verdict = judge_motions(std::move(verdict), events);
    if (!verdict.answer.may_move) return verdict;
    for (size_t i = 0; i < core::axis_count; ++i) {
        const double travel = ahead_->position[i].value_or(0.0) - before[i].value_or(0.0);
        range.min[i] += std::min(travel, 0.0);
        range.max[i] += std::max(travel, 0.0);
    }
    jogged_ = range;
    ahead_->spread = {};
    return verdict;
}

std::optional<core::Vec3> LineCheck::place_ahead() const {
    if (!ahead_ || !is_set_up_ || jogged_ || !ahead_->spread.none()) return {};
    core::Vec3 place(0.0, 0.0, shift_);
    for (size_t i = 0; i < 3; ++i) {
        if (!ahead_->position[i]) return {};
        place[static_cast<int>(i)] += *ahead_->position[i];
    }
    return place;
}

void LineCheck::look_at_setup() { has_changed_ = core::file_bytes(path_) != text_; }

LineVerdict LineCheck::judge(uint64_t number, const std::string& text, bool is_jog) {
    look_at_setup();
    if (!knows_control_) return not_understood("Nothing is known of the control yet.", 9);
    // Grbl makes such a jog to machine zero.
    if (is_jog && text.find_first_of("XYZ") == std::string::npos)
        return not_understood("It has no axis.", 26);
    constexpr size_t longest = 79; // what Grbl stores
    if (text.size() > longest)
        return not_understood(fmt::format("It has more than {} characters.", longest), 11);
    const auto words = words_of(is_jog ? text.substr(3) : text);
    if (!words)
        return not_understood("It does not consist of letters with numbers.",
                              std::isalpha(static_cast<unsigned char>(text[0])) != 0 ? 2 : 1);
    for (const GrblWord& word : *words)
        if (std::abs(word.value - word.exact) > least_difference)
            return not_understood(
                fmt::format("Grbl takes eight digits of a number, so it reads {}{}.", word.letter,
                            word.value),
                2);
    constexpr double last_tool = 255; // of Grbl
    for (const GrblWord& word : *words)
        if (word.letter == 'T' && word.value > last_tool)
            return not_understood(fmt::format("Grbl has no tool {}.", word.value), 38);
    if (const auto code = refused_machine_code(*words)) {
        // Grbl does not take the T of this line, but whoever wrote it wants another tool.
        for (const GrblWord& word : *words)
            if (word.letter == 'T' && *code == 6.0 && word.value == std::floor(word.value))
                called_ = control_.modal.selected_tool =
                    core::ToolNumber{static_cast<int>(word.value)};
        return not_understood(fmt::format("Grbl has no M{}.", *code), 20);
    }
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
    verdict.is_plain =
        !is_jog && is_plain(*words) && control_.modal.feed_mode == gcode::FeedMode::per_minute;
    verdict.changes_offset = control.modal.offsets != control_.modal.offsets;
    verdict.asks_anew = stores_offset(text) || (sets_offsets(text) && verdict.changes_offset);
    verdict.answer.may_move = true;
    // Grbl forgets the feed when G94 ends G93.
    const bool ends_inverse_time = control_.modal.feed_mode == gcode::FeedMode::inverse_time
                                   && control.modal.feed_mode == gcode::FeedMode::per_minute;
    if (ends_inverse_time && text.find('F') == std::string::npos) {
        control.modal.feed.reset();
    }
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
        events_of(file_->setup, block, lowering, file_->speed_by_hand);
    std::erase_if(events,
                  [](const core::Event& event) { return motion_in(event) && !moves(event); });
    for (core::Event& event : events) lower_by(event, shift_);
    widen_arcs(events, text.find('R') != std::string::npos);
    verdict.moves = std::any_of(events.begin(), events.end(), moves);
    verdict.fills_planner =
        std::any_of(events.begin(), events.end(),
                    [&](const core::Event& event) { return is_planned(event, step_); });
    verdict.stops_at_contact =
        std::any_of(events.begin(), events.end(), [](const core::Event& event) {
            return motion_in(event) && motion_in(event)->stops_at_contact;
        });
    verdict.asks_anew = verdict.asks_anew || verdict.stops_at_contact;
    const auto called = control.modal.selected_tool ? control.modal.selected_tool : called_;
    const bool switches_spindle = std::any_of(events.begin(), events.end(), [](const auto& event) {
        return std::holds_alternative<core::SpindleChange>(event);
    });
    if (!is_set_up_) {
        programs_spindle_ = programs_spindle_ || switches_spindle;
        verdict = judge_unchecked(std::move(verdict), events, is_jog);
        // Behind motions the control is asked anew.
        if (verdict.answer.may_move && !verdict.moves) control_ = std::move(control);
        return verdict;
    }
    if (verdict.moves && has_arc(events) && arc_error_ < least_arc_error)
        return not_understood("Grbl's $12 is 0, so it may make an arc as one straight line: set it "
                              "to 0.002 without the gate.",
                              9);
    if (verdict.moves && has_arc(events) && arc_error_ > most_arc_error)
        return not_understood(
            fmt::format("Grbl makes arcs with chords up to {:.3g} mm off ($12): set "
                        "it to {:.3g} or less without the gate.",
                        arc_error_, most_arc_error),
            9);
    if (verdict.moves) {
        if (std::string why = objection(lowering.offsets, called); !why.empty())
            return not_understood(std::move(why), 9);
        verdict.answer.may_move = false;
        if (!is_jog) jogged_.reset(); // the gate has asked where they have ended
        verdict = is_jog ? judge_jog(std::move(verdict), events)
                         : judge_motions(std::move(verdict), events);
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
    called_ = called;
    programs_spindle_ = programs_spindle_ || switches_spindle;
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

} // namespace app
