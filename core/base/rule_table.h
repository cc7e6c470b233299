#pragma once

#include "core/base/rule.h"

// Included only by sources that name a rule, so that a new row compiles little again.
namespace core {

// `tests/documentation.py . FEELER --update` writes these texts into docs/manual/rules.md. The rule
// `program` covers all remarks of the interpreter.
inline constexpr RuleEntry all_rules[] = {
    {"collision", Severity::error, "Two bodies overlap.",
     "Look at the pair and the block in the message; change the path, the tool or the position of "
     "the bodies."},
    {"near-miss", Severity::error, "Two bodies are closer than their minimum clearance.",
     "Increase the clearance, or set a smaller `allowance` for this pair."},
    {"undecided", Severity::error,
     "It could not be proven that two bodies keep their minimum clearance.",
     "Check with a smaller mesh size, or increase the clearance."},
    {"missing-length-offset", Severity::error,
     "Z moves after a tool change without the length offset of the tool.",
     "Add G43 with the H of the tool after the tool change."},
    {"offset-not-tool", Severity::warning, "The length or radius offset belongs to another tool.",
     "Give H and D the number of the tool in the spindle."},
    {"length-offset-cancelled", Severity::warning,
     "Z moves down while the length offset is cancelled.",
     "Remove G49, or add G43 before moving down."},
    {"tool-not-in-table", Severity::warning,
     "The program calls a tool that no set-up, table or comment describes.",
     "Describe it in the set-up or in the tool table."},
    {"stick-out-short", Severity::error,
     "The holder or the shank meets the stock while the flutes cut.",
     "Clamp the tool with the stick-out given in the message, or use a longer one."},
    {"work-offset-unset", Severity::warning,
     "A work offset is used that was never set, while another one is set.",
     "Set it, or select the one that is set."},
    {"offset-implausible", Severity::warning,
     "The stock is not where this work offset puts the cuts.",
     "Compare the datum of the program with that of the set-up."},
    {"home-through-part", Severity::error,
     "The path to the home position passes an intermediate point at the work.",
     "Retract Z first: G91 G28 Z0."},
    {"machine-move-with-state", Severity::warning,
     "A move in machine coordinates while an offset or G91 is still on.",
     "Cancel what is still on before G53."},
    {"rapid-in-stock", Severity::error, "A rapid moves through material.",
     "Retract before moving across, or use a feed move."},
    {"rapid-near-clamp", Severity::error, "A rapid passes a fixture too closely.",
     "Retract above the fixture before moving across."},
    {"dog-leg-rapid", Severity::error,
     "A rapid is clear on a straight line, but not on the bent path that this machine takes.",
     "Move Z by itself first."},
    {"low-retract", Severity::warning, "A retract is lower than an obstacle between two features.",
     "Retract higher between them."},
    {"incremental-left-on", Severity::warning,
     "G91 is still on after a tool change and the path leaves the programmed region.", "Add G90."},
    {"state-left-over", Severity::warning,
     "Compensation, a cycle, scaling, a rotation, a mirror image, a tilted plane or an axis offset "
     "is still on at a tool change or at the end.",
     "Cancel it where it is no longer needed."},
    {"restart-in-the-middle", Severity::warning,
     "A start in the middle of the program lacks modes or offsets that earlier lines set.",
     "Set them again before the first cut."},
    {"units-jump", Severity::warning,
     "Path and stock differ by the ratio of inch and mm, or the unit changes in the middle of the "
     "program.",
     "Add G20 or G21, and check the unit of the stock."},
    {"missing-decimal-point", Severity::warning,
     "Lengths with and without a decimal point are mixed on a control that may count the latter in "
     "least input increments.",
     "Add the decimal point."},
    {"block-delete", Severity::warning,
     "The program moves differently when blocks with `/` are skipped.", "Make both paths safe."},
    {"arc-radius", Severity::error,
     "The radii at the start and end of an arc differ by more than the control's tolerance.",
     "Correct the centre or the end of the arc."},
    {"over-engagement", Severity::warning, "A cut is deeper than the flutes, or the shank rubs.",
     "Cut in smaller steps, or use a tool with longer flutes."},
    {"tool-change-unsafe", Severity::error, "The tool is changed too close to the work.",
     "Retract to the change position first."},
    {"singular-orientation", Severity::warning, "Rotary axes turn far while the tool hardly tilts.",
     "Tilt the path or the work away from the singular orientation."},
    {"spindle-off", Severity::error,
     "The tool cuts while the spindle is stopped or turns the wrong way.",
     "Start the spindle, in the direction of the tool, before the cut."},
    {"no-feed", Severity::error, "A feed move without a feed.", "Add F before the first cut."},
    {"over-travel", Severity::error, "An axis moves beyond its limit.",
     "Move the work or change the path; check the work offset first."},
    {"rotary-with-tool-down", Severity::error, "The table turns while the tool is in the way.",
     "Retract before turning."},
    {"first-move", Severity::warning,
     "A motion starts at an unknown position and is not clear from every possible start.",
     "State `start` under `[program]`, or the home position of the machine."},
    {"fixture-move", Severity::error, "A fixture does not move as the set-up says.",
     "Correct the line or the M code under `[[fixture.move]]`."},
    {"rest-material", Severity::note, "Material is left outside the part.",
     "None, unless a later operation needs it removed."},
    {"gouge", Severity::error, "Material of the part has been cut away.",
     "Look at the block in the message: tool, offset or depth."},
    {"loose-piece", Severity::warning, "A piece of the stock is cut loose.",
     "Leave tabs, or clamp it before the last cut."},
    {"holder-into-wall", Severity::error, "The holder or the spindle nose hits a wall or a jaw.",
     "Use a longer tool, or stay farther from the wall."},
    {"air-cut", Severity::note, "A long series of feeds removes nothing.",
     "None for safety; a rapid would save time."},
    {"refused", Severity::error,
     "With `--engine coprocessor`: the coprocessor does not permit a block.",
     "Check the block with the exact engine."},
    {"program", Severity::warning,
     "A remark on how a block was read, for example that an M code is unknown.",
     "See the message."},
};

/// The id of a rule. A name that is not in the table does not compile, since a constant expression
/// cannot throw.
consteval const char* rule_id(std::string_view name) {
    for (const RuleEntry& rule : all_rules)
        if (rule.name == name) return rule.name.data();
    throw "no rule has this name";
}

} // namespace core
