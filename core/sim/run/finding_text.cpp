#include "core/sim/run/finding_text.h"

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/motion/corner.h"
#include "core/sim/run/cure_trial.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
namespace {

std::string rule_of(const PairClearance& pair, const BlockMove& move, bool spindle_runs) {
    if (move.only_dog_leg) return rule_id("dog-leg-rapid");
    if (pair.verdict == Verdict::undecided) return rule_id("undecided");
    const bool rapid = move.motion == BlockMotion::rapid;
    if (rapid && move.turns) return rule_id("rotary-with-tool-down");
    const bool fixture = pair.pair.fixture.has_value();
    if (pair.verdict == Verdict::violation)
        return rapid && fixture ? rule_id("rapid-near-clamp") : rule_id("near-miss");
    if (!fixture && rapid) return rule_id("rapid-in-stock");
    if (!fixture && pair.pair.part == PartKind::flutes && !spindle_runs && !move.leaves_contact)
        return rule_id("spindle-off");
    return pair.pair.part == PartKind::holder || pair.pair.part == PartKind::nose
               ? rule_id("holder-into-wall")
               : rule_id("collision");
}

/// "3.200 mm".
std::string amount_text(const TriedShift& shift) { return at_most(std::abs(shift.by)) + " mm"; }

/// What the block keeps after a shift that was tried.
std::string kept_text(const TriedShift& shift, const std::string& body) {
    return fmt::format("tried: this block then keeps {} mm from {}",
                       clearance_at_least(shift.keeps), body);
}

/// Cure of a pair that is too near: the shift of the path that was tried; else, for a near miss,
/// the direction that leads away most directly.
std::string cure_by_shift(const PairClearance& pair, const PairStudy& study,
                          const std::string& body) {
    const std::string move = pair.pair.fixture ? fmt::format(", or move {}", body) : std::string();
    if (study.shift)
        return fmt::format("Move the tool path at least {} towards {}{} ({}){}.",
                           amount_text(*study.shift), "XYZ"[study.shift->axis],
                           study.shift->by > 0.0 ? '+' : '-', kept_text(*study.shift, body), move);
    if (study.tried && study.cuts)
        return fmt::format("Change the path{} (no small shift along one axis clears this block and "
                           "still lets it cut; tried).",
                           move);
    if (study.tried)
        return fmt::format("Change the path{} (this block cannot be cleared by shifting it along "
                           "one axis; tried).",
                           move);
    const Vec3 away = pair.on_tool - pair.on_body;
    if (!(glm::length(away) > 0.0)) return "";
    return fmt::format("Move the tool path towards {}{}.", direction_text(glm::normalize(away)),
                       move);
}

std::string cure_of_rapid(const PairStudy& study, const BlockMove& move, const std::string& part,
                          const std::string& body) {
    if (move.within == MoveWithin::way_home)
        return "Retract along the tool axis first, for example with G91 G28 Z0 or G53 G0 Z0; then "
               "move the other axes home.";
    if (study.starts_inside)
        return fmt::format("Correct the block before it: the {} {} in {} already where this rapid "
                           "begins.",
                           part, part == name_of(PartKind::flutes) ? "are" : "is", body);
    if (move.within == MoveWithin::cycle)
        return fmt::format(
            "Raise the plane from which the cycle feeds and to which it retracts{}.",
            move.shifts ? "; if its shift meets the wall, check the amount and the direction of "
                          "the shift and the diameter of the tool"
                        : "");
    if (study.shift)
        return fmt::format("Rapid at least {} higher ({}), or feed through the material.",
                           amount_text(*study.shift), kept_text(*study.shift, body));
    return "Raise the retract height, or feed through the material.";
}

/// Cure of an undecided pair: reduce whatever widens its interval most.
std::string cure_of_doubt(const Setup& setup, const PairClearance& pair, const BlockMove& move,
                          const RoundedCorners& corners) {
    const bool rapid = move.motion == BlockMotion::rapid;
    const double off =
        path_deviation(pair.pair, rapid ? corners.rapids.deviation : corners.by, corners);
    if (rapid && corners.rapids.keeps_speed())
        return fmt::format("The control rounds corners between rapids as far as their speeds and "
                           "accelerations make it: program {}{}.",
                           setup.machine.has_rotary()
                               ? "G61, or G64 P0.02 if no rotary axis turns before or after"
                               : "G64 P0.02 or G61",
                           states_all_dynamics(setup.machine)
                               ? ""
                               : ", or state `rapid` and `acceleration` of the axes");
    if (!rapid && !pair.found() && setup.machine.has_rotary() && corners.turns.keeps_speed())
        return "LinuxCNC may begin this motion before the one before it has ended: program G61 "
               "where rotary axes turn; if that does not decide it, increase the clearance.";
    // A lower bound of 0 is cut off, so the width of the interval is only known to be at least
    // upper - lower. A pair that was only found near a corner has no upper bound.
    if (off > 0.0 && (!pair.found() || 4.0 * off >= pair.upper - pair.lower)) {
        if (setup.machine.has_rotary() && corners.arcs.blends())
            return fmt::format("LinuxCNC may round corners by {:.4g} mm: use a smaller tolerance, "
                               "or G61 where rotary axes turn; if that does not decide it, "
                               "increase the clearance.",
                               off);
        return fmt::format("The control may round corners by {:.4g} mm: use a smaller tolerance or "
                           "exact stops; if that does not decide it, increase the clearance.",
                           off);
    }
    if (move.turns)
        return "Turn the rotary axes farther away or in shorter blocks, or increase the clearance.";
    if (pair.pair.fixture) return "Increase the clearance.";
    const double tolerance = setup.stock.tolerance - setup.stock.deviation;
    if (setup.stock.deviation > std::max(tolerance, setup.mesh_size))
        return "Use a smaller `mesh_deviation` of [stock]; if that does not decide it, increase "
               "the "
               "clearance.";
    if (tolerance <= 0.0)
        return "Use a smaller mesh size; if that does not decide it, increase the clearance.";
    return fmt::format("The raw stock may be {:g} mm larger than stated: measure it and reduce "
                       "`tolerance` of [stock]{}, or increase the clearance.",
                       tolerance, tolerance < setup.mesh_size ? " and the mesh size" : "");
}

/// Whether the cure of a pair is a shift of the path, not a change of the tool.
bool is_cured_by_shift(const PairClearance& pair) {
    return pair.pair.fixture || pair.verdict == Verdict::violation;
}

std::string cure_of(const PairClearance& pair, const std::string& rule, const std::string& part,
                    const std::string& body, const BlockMove& move, const PairStudy& study) {
    const bool fixture = pair.pair.fixture.has_value();
    if (rule == rule_id("rapid-in-stock")) return cure_of_rapid(study, move, part, body);
    if (rule == rule_id("rotary-with-tool-down"))
        return "Retract the tool before the rotary axes turn.";
    if (rule == rule_id("spindle-off"))
        return "Start the spindle in the correct direction before the tool feeds into the stock.";
    if (rule == rule_id("dog-leg-rapid"))
        return fmt::format("A straight line would be clear: move the axes one after another around "
                           "{}, or use a fast feed move instead of the rapid.",
                           body);
    if (is_cured_by_shift(pair))
        if (const std::string cure = cure_by_shift(pair, study, body); !cure.empty()) return cure;
    if (pair.pair.part == PartKind::machine)
        return "Move the work, or use a longer tool: a machine body comes too close.";
    if (pair.pair.part == PartKind::shank && !fixture)
        return "Use longer flutes, a slimmer shank or neck, or less depth.";
    if (pair.pair.part != PartKind::flutes && !fixture)
        return "Use a longer stick-out, a slimmer holder, or less depth.";
    return fixture ? fmt::format("Change the path, or move {}.", body) : "Change the path.";
}

/// Beginning of a message about a rapid.
const char* words_for_rapid(MoveWithin within) {
    switch (within) {
    case MoveWithin::way_home:
        return "On the rapid to the reference point (G28, G30), the";
    case MoveWithin::cycle:
        return "On a rapid of this cycle, the";
    case MoveWithin::block:
        return "On a rapid within this block, the";
    default:
        return "On a rapid, the";
    }
}

std::string rapid_into_stock(const std::string& part, MoveWithin within) {
    const char* whose = within == MoveWithin::way_home
                            ? " on the way to the reference point (G28, G30)"
                        : within == MoveWithin::cycle ? " on a rapid of this cycle"
                        : within == MoveWithin::block ? " on a rapid within this block"
                                                      : "";
    return fmt::format("Rapid into material: the {} collides with the stock{}.", part, whose);
}

std::string message_of(const PairClearance& pair, const std::string& rule, const BlockMove& move,
                       const std::string& part, const std::string& body, double at) {
    const char* kind = move.only_dog_leg ? "On a straight line this rapid would be clear, but the "
                                           "axes do not arrive together: the"
                       : move.turns      ? "While rotary axes turn, the"
                       : move.motion == BlockMotion::rapid ? words_for_rapid(move.within)
                                                           : "The";
    if (rule == rule_id("rapid-in-stock")) return rapid_into_stock(part, move.within);
    if (rule == rule_id("spindle-off"))
        return "The flutes meet the stock while the spindle is stopped or turns the wrong way.";
    if (pair.verdict == Verdict::collision)
        return fmt::format("{} {} collides with {} {}.", kind, part, body, moment_text(at));
    const double keep = pair.allowance.distance;
    const int digits = digits_below(pair.upper, keep);
    if (pair.verdict == Verdict::violation)
        return fmt::format(
            "{} {} comes within {} mm of {} (minimum clearance {} mm; short by {} mm).", kind, part,
            bounds_text(pair.lower, pair.upper, " to ", digits), body, at_most(keep),
            missing_text(keep - pair.upper, keep - pair.lower, " to ", digits));
    if (keep <= resolution)
        return fmt::format("{} {} may collide with {}: contact or collision is undecided.", kind,
                           part, body);
    return fmt::format("{} {} may come within {} mm of {} (minimum clearance {} mm).", kind, part,
                       clearance_at_least(pair.lower), body, at_most(keep));
}

/// Changes the verb to the plural for "flutes": "the flutes come", but "the holder comes".
std::string in_the_plural(std::string message) {
    for (const auto& [one, many] :
         {std::pair{"flutes comes", "flutes come"}, std::pair{"flutes collides", "flutes collide"}})
        if (const size_t at = message.find(one); at != std::string::npos)
            message.replace(at, std::string(one).size(), many);
    return message;
}

/// Name of the second body in a sentence.
std::string body_in_words(const Setup& setup, const Pair& pair) {
    return pair.fixture ? body_name(setup, pair) : "the stock";
}

/// Message about a new tool at the tool change position.
std::string change_message(const PairClearance& pair, ToolNumber tool, const std::string& part,
                           const std::string& body) {
    const bool many = pair.pair.part == PartKind::flutes;
    const int number = value_of(tool);
    if (pair.verdict == Verdict::collision)
        return fmt::format("Tool {} is loaded where its {} {} with {}.", number, part,
                           many ? "collide" : "collides", body);
    const double keep = pair.allowance.distance;
    if (pair.verdict == Verdict::violation)
        return fmt::format(
            "Tool {} is loaded where its {} {} only {} mm from {} (minimum clearance {} mm).",
            number, part, many ? "are" : "is",
            bounds_text(pair.lower, pair.upper, " to ", digits_below(pair.upper, keep)), body,
            at_most(keep));
    return fmt::format("Tool {} is loaded where its {} may be as close to {} as {} mm (minimum "
                       "clearance {} mm).",
                       number, part, body, clearance_at_least(pair.lower), at_most(keep));
}

/// A collision is always an error, whatever severity its rule has.
Severity severity_about(const Setup& setup, const PairClearance& pair, const std::string& rule) {
    return pair.verdict == Verdict::collision ? Severity::error : severity_of(setup, rule);
}

double shortfall_of(const PairClearance& pair) {
    return pair.allowance.distance - (pair.verdict == Verdict::undecided ? pair.lower : pair.upper);
}

} // namespace

std::string moment_text(double fraction) {
    if (fraction < 0.01) return "at the start of the block";
    return fmt::format("after {:.0f} % of the block", 100.0 * fraction);
}

Finding finding_of(const Setup& setup, const PairClearance& pair, const BlockMove& move,
                   const SimulatorState& state, const PairStudy& study) {
    const ToolAssembly* tool = nullptr;
    if (state.tool && setup.tools.count(*state.tool)) tool = &setup.tools.at(*state.tool);
    const bool spindle_runs = tool && turns_to_cut(state.spindle, *tool);
    const std::string& part = part_name(setup, pair.pair);
    const std::string body = body_in_words(setup, pair.pair);
    const double at = move.duration > 0.0 ? pair.time / move.duration : 0.0;
    Finding finding;
    finding.rule = rule_of(pair, move, spindle_runs);
    finding.severity = severity_about(setup, pair, finding.rule);
    finding.message = in_the_plural(message_of(pair, finding.rule, move, part, body, at));
    finding.cure = finding.rule == rule_id("undecided")
                       ? cure_of_doubt(setup, pair, move, state.corners)
                       : cure_of(pair, finding.rule, part, body, move, study);
    finding.overlap = study.overlap;
    if (finding.overlap) finding.message += " " + overlap_text(*finding.overlap);
    finding.pair = {part, body_name(setup, pair.pair)};
    finding.shortfall = shortfall_of(pair);
    if (!finding.cure.empty()) finding.cure[0] = upper(finding.cure[0]);
    return finding;
}

Finding unsafe_change(const Setup& setup, const PairClearance& pair, ToolNumber tool) {
    Finding finding;
    finding.rule = rule_id("tool-change-unsafe");
    finding.severity = severity_about(setup, pair, finding.rule);
    finding.pair = {part_name(setup, pair.pair), body_name(setup, pair.pair)};
    finding.message = change_message(pair, tool, finding.pair[0], body_in_words(setup, pair.pair));
    finding.cure =
        "Move to a safe position, for example with G28 or G53 Z0, before the tool change.";
    finding.shortfall = shortfall_of(pair);
    return finding;
}

} // namespace core
