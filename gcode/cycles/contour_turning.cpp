#include <algorithm>

#include <fmt/format.h>

#include "gcode/cycles/cycles.h"
#include "gcode/cycles/turning_cycle.h"
#include "gcode/exec/flow.h"
#include "gcode/language/language.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// A and C of a block give the size of its corner; these axes are unknown while the contour is
/// traced.
constexpr size_t fillet_axis = 3, chamfer_axis = 5;

TurningPoint point_of(const Position& position) { return {*position[0], *position[2]}; }

core::Result<void> check_turning(const Execution& execution) {
    const Word& mover = moving_word(execution);
    // On Mach3 and other controls these codes select the units.
    const std::string_view instead = execution.statement.word('Q') ? ""
                                     : mover.value == 70.0         ? "; if it means inches, use G20"
                                     : mover.value == 71.0 ? "; if it means millimetres, use G21"
                                                           : "";
    const auto& words = execution.block.words;
    const bool is_mach3 = std::any_of(words.begin(), words.end(), [](const Word& word) {
        return word.letter == 'G' && (word.value == 90.1 || word.value == 91.1);
    });
    if (is_mach3 && !instead.empty())
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: beside G91.1 it is Mach3's code for {}; with that, "
                        "--dialect linuxcnc reads the program",
                        written(mover),
                        mover.value == 70.0 ? "inches: use G20" : "millimetres: use G21"),
            mover.span);
    const auto refuse = [&](std::string_view why) {
        return core::fail(ErrorCode::syntax, fmt::format("{}: {}{}", written(mover), why, instead),
                          mover.span);
    };
    const ModalState& modal = execution.modal();
    if (modal.plane != Plane::zx)
        return refuse("turning cycles work in the ZX plane: program G18 first");
    if (modal.compensation != Side::none)
        return refuse("no turning cycle is allowed while cutter radius compensation is on: cancel "
                      "it with G40 first");
    if (modal.distance == DistanceMode::incremental)
        return refuse(
            "with G91 the control puts the contour in the wrong place: program G90 first");
    if (!execution.statement.word('Q'))
        return refuse("no Q word: it must give the number of the subprogram with the contour");
    return {};
}

/// Runs the blocks of the subprogram on a copy of the state.
struct Tracing {
    Execution& execution;
    InterpreterState state;
    TurningContour contour{};

    core::Result<void> enter();
    core::Result<void> follow();
    core::Result<void> take(const BlockCommands& block, const Position& before);
};

core::Result<void> Tracing::enter() {
    const Word& label = *execution.statement.word('Q');
    FEELER_TRY(const int number, whole_number(label));
    Block call;
    if (auto parsed = parse_line(fmt::format("o{} call", number), execution.block.line,
                                 execution.dialect, call);
        !parsed)
        return parsed;
    call.flow.span = label.span;
    BlockCommands unused;
    state.modal.motion.reset();
    state.modal.cycle.reset();
    return run_flow(
        {execution.library, execution.environment, execution.dialect, call, state, unused});
}

/// A block of the contour: its single motion and the corner after it.
core::Result<void> Tracing::take(const BlockCommands& block, const Position& before) {
    for (size_t i = 0; i < block.commands.size(); ++i) {
        const auto* arc = std::get_if<ArcFeed>(&block.commands[i]);
        const auto* feed = std::get_if<StraightFeed>(&block.commands[i]);
        if (!arc && !feed && !std::holds_alternative<StraightTraverse>(block.commands[i])) continue;
        const core::SourceSpan where{.line = block.line, .column = block.columns[i], .length = 1};
        const Position& now = state.modal.position;
        if (block.is_cycle || (arc && arc->plane != Plane::zx))
            return core::fail(
                ErrorCode::syntax,
                "the contour of a turning cycle may only have lines and arcs in the ZX plane",
                where);
        if (now[fillet_axis] && now[chamfer_axis])
            return core::fail(ErrorCode::syntax,
                              "a corner can have a fillet (A) or a chamfer (C), not both", where);
        if (contour.size() == greatest_contour)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("the contour of a turning cycle may have at most {} moves",
                            greatest_contour),
                where);
        TurningSegment segment{point_of(now)};
        if (arc) segment.arc = TurningArc{{arc->centre[1], arc->centre[0]}, arc->turns > 0};
        if (now[fillet_axis]) segment.corner = CornerShape::fillet;
        if (now[chamfer_axis]) segment.corner = CornerShape::chamfer;
        segment.corner_size =
            to_mm(now[fillet_axis].value_or(now[chamfer_axis].value_or(0.0)), state.modal.unit);
        if (segment.end != point_of(before) || arc) contour.push_back(segment);
    }
    return {};
}

core::Result<void> Tracing::follow() {
    Interpreter interpreter(execution.library, execution.environment);
    const size_t level = execution.state.frames.size();
    while (state.frames.size() > level && state.ending == ProgramStatus::running) {
        Position& place = state.modal.position;
        place[fillet_axis].reset();
        place[chamfer_axis].reset();
        const Position before = place;
        FEELER_TRY(const BlockCommands* const block, interpreter.next(state));
        if (!block) break;
        for (const Warning& warning : block->warnings) execution.result.warnings.push_back(warning);
        if (auto taken = take(*block, before); !taken) return taken;
    }
    return {};
}

core::Result<TurningMoves> moves_along(const Execution& execution, CodeNumber code,
                                       TurningPoint start, const TurningContour& contour) {
    const double mm_per_unit = to_mm(1.0, execution.modal().unit);
    if (code == g_code(70)) {
        FinishingWords words;
        words.first_distance = length_word(execution, 'D').value_or(0.0);
        words.last_distance = length_word(execution, 'E').value_or(0.0);
        if (const Word* word = execution.statement.word('P')) words.passes = word->value;
        return finishing_moves(start, contour, words, mm_per_unit);
    }
    RoughingWords words;
    words.facing = code >= g_code(72);
    words.pockets = static_cast<PocketCutting>(tenth_of(code));
    words.allowance = length_word(execution, 'D').value_or(0.0);
    words.depth = length_word(execution, 'I');
    words.retract = length_word(execution, 'R');
    words.shift_x = length_word(execution, 'U').value_or(0.0);
    words.shift_z = length_word(execution, 'W').value_or(0.0);
    return roughing_moves(start, contour, words, mm_per_unit);
}

core::Result<void> emit_move(Execution& execution, const TurningMove& move) {
    ModalState& modal = execution.modal();
    Position end = modal.position;
    end[0] = move.end.x, end[2] = move.end.z;
    if (move.rapid) {
        modal.motion = MotionCode::rapid;
        execution.traverse(end);
        return {};
    }
    FEELER_TRY(const double rate, feed_rate(execution, distance_between(modal.position, end)));
    modal.motion = MotionCode::straight;
    if (!move.arc) {
        execution.feed(end, rate);
        return {};
    }
    modal.motion =
        move.arc->counterclockwise ? MotionCode::arc_counterclockwise : MotionCode::arc_clockwise;
    execution.emit(ArcFeed{end,
                           Plane::zx,
                           {move.arc->centre.z, move.arc->centre.x},
                           move.arc->counterclockwise ? 1 : -1,
                           rate});
    modal.position = end;
    modal.leaves_contour = false;
    return {};
}

} // namespace

core::Result<void> turn_contour(Execution& execution) {
    if (auto checked = check_turning(execution); !checked) return checked;
    const Word& mover = moving_word(execution);
    FEELER_TRY(const Position start, target_of(execution));
    if (!start[0] || !start[2])
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: the start position is unknown: add X and Z, or set "
                                      "[program] start in the set-up",
                                      written(mover)),
                          mover.span);
    execution.result.is_cycle = true;
    execution.traverse(start);
    execution.modal().motion = MotionCode::rapid;
    Tracing tracing{execution, execution.state};
    if (auto entered = tracing.enter(); !entered) return entered;
    if (auto followed = tracing.follow(); !followed) return followed;
    FEELER_TRY(
        const TurningMoves moves,
        placed(moves_along(execution, execution.statement.of(ModalGroup::motion)->code->number,
                           point_of(start), tracing.contour),
               mover.span));
    for (const TurningMove& move : moves)
        if (auto emitted = emit_move(execution, move); !emitted) return emitted;
    execution.state.parameters = tracing.state.parameters;
    return {};
}

} // namespace gcode
