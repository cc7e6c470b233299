#include "gcode/exec/restart.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/exec/execution.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace gcode {
namespace {

constexpr const char* offset_names[] = {"G54", "G55",   "G56",   "G57",  "G58",
                                        "G59", "G59.1", "G59.2", "G59.3"};

/// Null for the planes of the secondary axes.
const char* code_of_plane(Plane plane) {
    switch (plane) {
    case Plane::xy:
        return "G17";
    case Plane::zx:
        return "G18";
    case Plane::yz:
        return "G19";
    default:
        return nullptr;
    }
}

bool is_feed(const CanonicalCommand& command) {
    return std::holds_alternative<StraightFeed>(command) || std::holds_alternative<ArcFeed>(command)
           || std::holds_alternative<ThreadFeed>(command);
}

bool feeds(const BlockCommands& block) {
    return std::any_of(block.commands.begin(), block.commands.end(), is_feed);
}

/// The states of both runs at the first feed.
struct Meeting {
    ModalState before, after; // of the run from the start, around that block
    ModalState alone;         // of the run from the line
    bool alone_failed = false;
    std::optional<MotionCode> motion; // modal code of an earlier block that the other run lacked
};

bool is_plain_motion(const CanonicalCommand& command) {
    return is_feed(command) || std::holds_alternative<StraightTraverse>(command);
}

/// Whether a block moves by the modal motion code: not home, in a cycle, or to a machine position.
bool goes_on_moving(const BlockCommands& block) {
    const auto has = [&](std::string_view code) {
        return block.text.find(code) != std::string_view::npos;
    };
    return !block.is_cycle && !has("G53") && !has("g53")
           && std::any_of(block.commands.begin(), block.commands.end(), is_plain_motion);
}

/// Lists what the run from the line lacks.
class Needs {
public:
    Needs(const Meeting& meeting, const Dialect& dialect) : at_(meeting), dialect_(dialect) {}

    std::vector<std::string> all() {
        add_tool();
        add_frame();
        add_spindle();
        add_feed();
        add_position();
        return std::move(needs_);
    }

private:
    /// Whether a value differs and the failed block would not have set it.
    template <typename Value>
    bool lacks(Value ModalState::*value) const {
        if (at_.after.*value == at_.alone.*value) return false;
        return !at_.alone_failed || at_.before.*value == at_.after.*value;
    }
    void need(std::string what) { needs_.push_back(std::move(what)); }

    void add_tool() {
        const ModalState& modal = at_.after;
        const bool klartext = dialect_.language == Language::klartext;
        if (lacks(&ModalState::tool) && modal.tool)
            need(klartext ? fmt::format("TOOL CALL {}", core::value_of(*modal.tool))
                          : fmt::format("T{} in the spindle", core::value_of(*modal.tool)));
        if (klartext || !dialect_.length_needs_g43 || !modal.length_number) return;
        if (modal.length_sign != 0.0 && lacks(&ModalState::length_sign))
            need(fmt::format("{} H{}", modal.length_sign > 0.0 ? "G43" : "G44",
                             core::value_of(*modal.length_number)));
        else if (modal.length_sign != 0.0 && lacks(&ModalState::length_number))
            need(fmt::format("H{}", core::value_of(*modal.length_number)));
    }

    void add_frame() {
        const ModalState& modal = at_.after;
        if (modal.offsets.active != at_.alone.offsets.active
            && modal.offsets.active < std::size(offset_names))
            need(offset_names[modal.offsets.active]);
        if (lacks(&ModalState::unit)) need(modal.unit == LengthUnit::inch ? "G20" : "G21");
        if (lacks(&ModalState::distance))
            need(modal.distance == DistanceMode::incremental ? "G91" : "G90");
        if (const char* code = code_of_plane(modal.plane); code && lacks(&ModalState::plane))
            need(code);
        if (modal.transforms != at_.alone.transforms)
            need("the active rotation, scaling, mirror image or tilted plane");
        if (modal.offsets.axis != at_.alone.offsets.axis) need("G92");
        if (lacks(&ModalState::compensation) && modal.compensation != Side::none)
            need(modal.compensation == Side::left ? "G41" : "G42");
    }

    void add_spindle() {
        const ModalState& modal = at_.after;
        const bool turns = modal.spindle != core::SpindleDirection::stopped;
        if (turns && (lacks(&ModalState::spindle) || lacks(&ModalState::speed)))
            need(fmt::format("S{:g} {}", modal.speed,
                             modal.spindle == core::SpindleDirection::clockwise ? "M3" : "M4"));
        if (modal.flood && lacks(&ModalState::flood)) need("M8");
        if (modal.mist && lacks(&ModalState::mist)) need("M7");
    }

    void add_feed() {
        const ModalState& modal = at_.after;
        if (at_.motion) need(written(*at_.motion));
        if (lacks(&ModalState::feed_mode))
            need(fmt::format("G{}", modal.feed_mode == FeedMode::inverse_time ? 93
                                    : modal.feed_mode == FeedMode::per_turn   ? 95
                                                                              : 94));
        if (modal.feed && lacks(&ModalState::feed))
            need(fmt::format("F{:g}", modal.feed_mode == FeedMode::inverse_time
                                          ? *modal.feed
                                          : from_mm(*modal.feed, modal.unit)));
        if (modal.cycle && lacks(&ModalState::cycle) && !at_.alone.cycle)
            need("the cycle " + written(modal.cycle->code));
    }

    void add_position() {
        const ModalState& modal = at_.after;
        std::string position;
        for (size_t axis = 0; axis < 3; ++axis) {
            if (!modal.position[axis] || modal.spread[axis] != 0.0) continue;
            const std::optional<double>& alone = at_.alone.position[axis];
            if (alone && std::abs(*alone - *modal.position[axis]) < 1e-6) continue;
            if (at_.alone_failed && at_.before.position[axis] != modal.position[axis]) continue;
            position += fmt::format("{}{}{:g}", position.empty() ? "" : " ", axis_letters[axis],
                                    from_mm(*modal.position[axis], modal.unit));
        }
        if (!position.empty()) need("the tool at " + position);
    }

    const Meeting& at_;
    const Dialect& dialect_;
    std::vector<std::string> needs_;
};

/// Runs both in step up to the first feed; empty when no feed follows.
std::optional<Meeting> meet(ProgramLibrary& library, const Environment& environment,
                            InterpreterState whole, InterpreterState alone) {
    Interpreter first(library, environment), second(library, environment);
    std::optional<MotionCode> motion;
    while (true) {
        Meeting meeting{.before = whole.modal, .after = {}, .alone = {}, .motion = motion};
        const auto block = first.next(whole);
        if (!block || !*block) return std::nullopt;
        const uint32_t line = (*block)->line;
        const bool is_feed_block = feeds(**block);
        const auto other = second.next(alone);
        const bool parted = !other || !*other || (*other)->line != line;
        const auto& active = whole.modal.motion;
        const bool goes_on = (is_straight(active) || is_arc(active))
                             && active == meeting.before.motion && active != alone.modal.motion;
        if (!motion && goes_on && goes_on_moving(**block)) meeting.motion = motion = active;
        if (!is_feed_block && !parted) continue;
        meeting.after = whole.modal;
        meeting.alone = alone.modal;
        meeting.alone_failed = parted;
        return meeting;
    }
}

} // namespace

core::Result<uint32_t> line_meant(const Program& program, DialectId id, std::string_view text) {
    const bool has_letter = !text.empty() && (text[0] == 'N' || text[0] == 'n');
    const bool counts_blocks = dialect(id).language == Language::klartext;
    const auto number = number_in(has_letter ? text.substr(1) : text);
    if (number && !has_letter && !counts_blocks) {
        FEELER_TRY(const bool there, program.has_line(*number));
        if (there && *number > 0) return *number;
    }
    for (uint32_t line = 1; number && (has_letter || counts_blocks); ++line) {
        FEELER_TRY(const auto found, program.find_line(line));
        if (!found) break;
        if (block_number(*found, !counts_blocks) == number) return line;
    }
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("the program has no line {} to start at", text));
}

core::Result<Restart> restart_at(ProgramLibrary& library, const Environment& environment,
                                 uint32_t line, std::optional<core::ToolNumber> tool) {
    InterpreterState whole = initial_state(environment);
    Restart restart{.state = whole, .line = line, .missing = {}};
    restart.state.next = {.source = 0, .line = line};
    restart.state.tape_open = true;
    if (tool) restart.state.modal.tool = tool;
    Interpreter interpreter(library, environment);
    InterpreterState before = whole;
    while (true) {
        before = whole;
        const auto block = interpreter.next(whole);
        if (!block || !*block)
            return core::fail(
                core::ErrorCode::invalid_value,
                fmt::format("the program does not reach line {} when run from its beginning",
                            line));
        if ((*block)->file.empty() && (*block)->line >= line) break;
    }
    if (const auto meeting = meet(library, environment, std::move(before), restart.state))
        restart.missing = Needs(*meeting, dialect(environment.dialect)).all();
    return restart;
}

} // namespace gcode
