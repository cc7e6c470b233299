#include "app/report/exchange/rule_help.h"

#include <algorithm>
#include <iterator>

namespace app {
namespace {

constexpr RuleHelp table[] = {
    {"collision", "Two bodies meet.",
     "Look at the pair and the block that the message names; change the path, the tool or where "
     "the bodies stand."},
    {"near-miss", "A clearance is less than its allowance.",
     "Keep farther away, or state a smaller allowance for this pair."},
    {"undecided", "It could not be proven that a clearance keeps its allowance.",
     "Check with a smaller mesh size, or keep farther away."},
    {"missing-length-offset", "Z moves after a tool change without the tool's length offset.",
     "Write G43 with the tool's H behind the tool change."},
    {"offset-not-tool", "The length or radius offset belongs to another tool.",
     "Give H and D the number of the tool in the spindle."},
    {"length-offset-cancelled", "Z moves below the clearance plane while the offset is cancelled.",
     "Take out G49, or say G43 again before going down."},
    {"tool-not-in-table", "A tool is called of which nothing is known.",
     "Describe it in the set-up or the tool table."},
    {"stick-out-short", "Holder or shank meets the stock while the flutes cut.",
     "Clamp the tool with the stick-out that the message names, or use a longer one."},
    {"work-offset-unset", "A work offset is called that was never set.",
     "Set it, or call the one that was."},
    {"offset-implausible", "The stock does not lie where this work offset puts the cuts.",
     "Compare the datum of the program with that of the set-up."},
    {"home-through-part", "The way home leads through an intermediate point at the work.",
     "Retract Z first: G91 G28 Z0."},
    {"machine-move-with-state", "A move in machine coordinates with an offset or G91 still on.",
     "Cancel what is still on before G53."},
    {"rapid-in-stock", "A rapid goes through material.",
     "Retract before going across, or cut there with a feed."},
    {"rapid-near-clamp", "A rapid passes a fixture too near.",
     "Retract above the fixture before going across."},
    {"dog-leg-rapid", "A rapid is free on a straight line, but not as this machine moves.",
     "Move Z by itself first."},
    {"low-retract", "A retract is lower than what stands between two features.",
     "Retract higher between them."},
    {"incremental-left-on", "G91 is still on and the path leaves the programmed region.",
     "Say G90."},
    {"state-left-over", "Something is still on that the program did not mean to keep.",
     "Cancel it where it is no longer needed."},
    {"restart-in-the-middle", "A start in the middle lacks what earlier lines have said.",
     "Say it again before the first cut."},
    {"units-jump", "The path and the stock differ as inches and millimetres do.",
     "Say G20 or G21, and which the stock is in."},
    {"missing-decimal-point", "A number without a point counts in smallest steps.",
     "Write the decimal point."},
    {"block-delete", "The program moves otherwise when blocks with / are switched off.",
     "Make both paths safe."},
    {"arc-radius", "An arc's start and end are not equally far from its centre.",
     "Correct the centre or the end of the arc."},
    {"over-engagement", "A cut is deeper than the flutes are long, or the shank rubs.",
     "Cut in smaller steps, or use a tool with longer flutes."},
    {"tool-change-unsafe", "A tool is changed too near to the work.",
     "Retract to the change position first."},
    {"singular-orientation", "Rotary axes turn far while the tool hardly leans.",
     "Tilt the path or the work away from the pole."},
    {"spindle-off", "The tool cuts while the spindle stands or turns the wrong way.",
     "Start the spindle, in the tool's direction, before the cut."},
    {"no-feed", "A feed move without a feed.", "Say F before the first cut."},
    {"over-travel", "An axis goes beyond its limit.",
     "Move the work, or change the path; look at the work offset first."},
    {"rotary-with-tool-down", "The table turns while the tool is in the way.",
     "Retract before turning."},
    {"first-move",
     "A motion begins at a place that nobody knows, and is not clear from everywhere.",
     "Say where the axes stand: `start` under [program] in the set-up, or the machine's home."},
    {"fixture-move", "A fixture does not move as the set-up says.",
     "Correct the line or the M code under [[fixture.move]]."},
    {"rest-material", "Material is left that the part does not have.",
     "Nothing to do, unless another operation expects it gone."},
    {"gouge", "Material is missing that the part has.",
     "Look at the block that the message names: tool, offset, or depth."},
    {"loose-piece", "A piece of the stock is cut loose.",
     "Leave tabs, or clamp it before the last cut."},
    {"holder-into-wall", "Holder or nose meets a wall or a jaw.",
     "Use a longer tool, or keep farther from the wall."},
    {"air-cut", "A long series of feeds removes nothing.",
     "Nothing to do for safety; the time can be saved."},
    {"refused", "The coprocessor does not permit a block.",
     "Look at the same block with the exact engine."},
    {"program", "The control remarks something about a block.", "See the message."},
};

} // namespace

RuleHelp help_of(std::string_view rule) {
    const auto* found = std::find_if(std::begin(table), std::end(table),
                                     [&](const RuleHelp& help) { return help.rule == rule; });
    return found == std::end(table) ? RuleHelp{rule, "", ""} : *found;
}

} // namespace app
