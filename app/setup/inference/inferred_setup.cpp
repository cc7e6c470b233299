#include "app/setup/inference/inferred_setup.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/coverage.h"
#include "app/setup/inference/inferred_stock.h"
#include "app/setup/inference/program_survey.h"
#include "app/setup/ini_file.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/program_tools.h"
#include "app/setup/tools/tool_library.h"
#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/dbm/solid.h"
#include "core/motion/kinematics.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/canonical.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

using core::ToolNumber;
using core::Vec3;

constexpr double between = 500.0; // mm in X between workpieces, leaves room for holders and rapids

/// The work offset with most of the feed travel; empty if nothing is cut.
std::optional<size_t> main_offset(const ProgramSurvey& seen) {
    std::optional<size_t> main;
    for (const auto& [offset, area] : seen.work_areas)
        if (!main || area.way > seen.work_areas.at(*main).way) main = offset;
    return main;
}

/// Puts the numbered work offsets that a program uses where the plain ones are, unless it sets them
/// itself.
///
/// Result: whether there is one.
bool assume_extended_offsets(gcode::Environment& environment, const ProgramSurvey& seen) {
    bool has_any = false;
    for (const auto& [offset, area] : seen.work_areas) {
        if (offset < gcode::plain_offset_count || offset >= gcode::no_work_offset || area.is_set)
            continue;
        has_any = environment.extended_offsets.emplace(offset, environment.work_offsets[0]).second
                  || has_any;
    }
    return has_any;
}

/// Puts the work offsets that a partial set-up leaves out where one is that it states.
///
/// Result: whether there is one.
bool assume_other_offsets(SetupFile& file) {
    if (!file.is_partial || file.infers_frame || file.offsets_set.empty()) return false;
    gcode::Environment& environment = file.environment;
    const gcode::AxisValues stated =
        environment.work_offset(static_cast<size_t>(*file.offsets_set.begin()));
    for (size_t i = 0; i < gcode::plain_offset_count; ++i)
        if (environment.work_offsets[i] == gcode::AxisValues{}
            && !file.offsets_set.contains(static_cast<int>(i)))
            environment.work_offsets[i] = stated;
    return true;
}

/// The work offset in which the program meets the bodies whose place is assumed: the one that they
/// name, if it cuts there, else the one with most of the feed travel. Empty if there are none.
std::optional<size_t> offset_of_bodies(const SetupFile& file, const ProgramSurvey& seen) {
    const bool is_assumed = !file.offsets_of_bodies.empty() && file.offsets_set.empty()
                            && file.environment.parameters.empty();
    if (!is_assumed) return std::nullopt;
    const size_t named = *file.offsets_of_bodies.begin();
    return file.names_offset_of_bodies && seen.work_areas.contains(named) ? named
                                                                          : main_offset(seen);
}

/// Puts the bodies whose place is assumed where the program itself sets their work offset (G10):
/// where it is at the first feed.
void move_bodies(SetupFile& file, const ProgramSurvey& seen) {
    const auto offset = offset_of_bodies(file, seen);
    if (!offset || *offset >= gcode::no_work_offset) return;
    const WorkArea& area = seen.work_areas.at(*offset);
    const std::string name = gcode::name_of_offset(*offset);
    if (area.is_moved)
        file.assumptions.push_back(
            fmt::format("the program sets {} to more than one place: stock and fixtures are at the "
                        "first, and there are none at the others",
                        name));
    // A numbered offset that nothing states has no frame of its own: it is where G54 is.
    auto before = file.frames.find(gcode::name_of_offset(*file.offsets_of_bodies.begin()));
    if (before == file.frames.end()) before = file.frames.find("G54");
    const core::Transform after =
        machine_from_offset(file.setup.machine, area.first.origin, area.first.rotation_deg);
    if (after == before->second) return;
    const core::Transform shift = after * before->second.inverse();
    file.setup.stock_mount.link_from_body = shift * file.setup.stock_mount.link_from_body;
    for (core::Fixture& fixture : file.setup.fixtures)
        if (!fixture.is_machine)
            fixture.mount.link_from_body = shift * fixture.mount.link_from_body;
    for (auto& [frame, pose] : file.frames)
        if (frame != "machine" && !gcode::offset_of_name(frame)) pose = shift * pose;
    before->second = file.frames[name] = after;
    if (!area.is_moved)
        file.assumptions.push_back(
            fmt::format("stock and fixtures are where the program sets {} itself", name));
}

/// Moves the work offsets that nobody has stated apart, as for workpieces clamped side by side,
/// unless the program sets them itself.
///
/// Result: the assumptions; empty if nothing was moved.
std::vector<std::string> move_apart(SetupFile& file, const ProgramSurvey& seen) {
    const auto main = main_offset(seen);
    if (!main || seen.work_areas.size() < 2 || seen.sets_offsets) return {};
    const auto is_stated = [&](size_t offset) {
        return file.offsets_set.contains(static_cast<int>(offset));
    };
    const bool has_stated = std::any_of(seen.work_areas.begin(), seen.work_areas.end(),
                                        [&](const auto& area) { return is_stated(area.first); });
    const std::optional<size_t> with_bodies = offset_of_bodies(file, seen);
    const auto stays = [&](size_t offset) {
        return has_stated ? is_stated(offset) : offset == with_bodies.value_or(*main);
    };
    double edge = -core::infinity;
    std::vector<std::string> others;
    for (const auto& [offset, area] : seen.work_areas) {
        if (stays(offset)) edge = std::max(edge, area.reach.max.x);
        if (offset != *main) others.push_back(gcode::name_of_offset(offset));
    }
    bool has_moved = false;
    for (const auto& [offset, area] : seen.work_areas) {
        if (stays(offset)) continue;
        const double shift = edge + between - area.reach.min.x;
        file.environment.writable_work_offset(offset)[0] += shift;
        edge = area.reach.max.x + shift;
        has_moved = true;
    }
    if (!has_moved) return {};
    constexpr std::string_view equal = "all work offsets are equal; ";
    for (std::string& text : file.assumptions)
        if (const size_t at = text.find(equal); at != std::string::npos)
            text.replace(at, equal.size(), "all work offsets are at the same height; ");
    return {fmt::format("the program cuts in {} and {}, assumed to be separate workpieces. The "
                        "stock is at {}, where most is cut; there is none at {}, so cuts there "
                        "are not checked: to check them, state the offsets and a stock in a "
                        "set-up",
                        gcode::name_of_offset(*main), fmt::join(others, ", "),
                        gcode::name_of_offset(*main), fmt::join(others, ", "))};
}

/// Moves a stated stock with the work offset in whose coordinates it is, if nobody has stated that.
void move_stock(SetupFile& file, const ProgramSurvey& seen) {
    const auto offset = gcode::offset_of_name(file.stock_frame);
    const bool moves = offset && !file.offsets_set.contains(static_cast<int>(*offset))
                       && !file.needs_stock && file.setup.fixtures.empty()
                       && !file.setup.machine.has_rotary();
    if (!moves) return;
    const auto area = seen.work_areas.find(*offset);
    const gcode::WorkOffset place = area != seen.work_areas.end() && area->second.is_set
                                        ? area->second.first
                                        : gcode::WorkOffset{file.environment.work_offset(*offset)};
    file.setup.stock_mount.link_from_body =
        machine_from_offset(file.setup.machine, place.origin, place.rotation_deg);
}

/// Puts the frames of the work offsets that the program uses where those offsets are now.
void place_frames(SetupFile& file, const ProgramSurvey& seen) {
    for (const auto& [offset, is_set] : seen.offsets)
        if (offset < gcode::no_work_offset && !is_set && !file.offsets_of_bodies.contains(offset))
            file.frames[gcode::name_of_offset(offset)] =
                machine_from_offset(file.setup.machine, file.environment.work_offset(offset));
}

/// A number for the tool in the spindle before the first tool call: that of the only partly
/// described tool, else one that is not in use.
ToolNumber free_number(const ProgramSurvey& seen, const SetupFile& file) {
    if (seen.tools.empty() && file.partial_tools.size() == 1)
        return file.partial_tools.begin()->first;
    int number = 1;
    while (std::find(seen.tools.begin(), seen.tools.end(), ToolNumber{number}) != seen.tools.end())
        ++number;
    return ToolNumber{number};
}

/// Whether a number is that of a tool, and neither the program nor the set-up has this tool.
bool is_free(ToolNumber number, const ProgramSurvey& seen, const SetupFile& file) {
    return core::value_of(number) > 0 && !file.setup.tools.contains(number)
           && std::find(seen.tools.begin(), seen.tools.end(), number) == seen.tools.end();
}

/// A tool called a drill that cuts sideways becomes a mill of that diameter.
FoundTool as_used(FoundTool tool, const ProgramSurvey& seen) {
    const auto use = seen.mills.find(tool.tool.number);
    const bool mills = use != seen.mills.end() && use->second;
    if (!mills || !core::only_drills(tool.tool.shape) || tool.tool.point_deg) return tool;
    tool.tool.shape = core::ToolShape::flat;
    tool.source += " and its use, because drills do not cut sideways";
    return tool;
}

/// A tool of which the set-up states the shape: what other sources say of it does not count.
FoundTool stated_tool(const FoundTool& found, const PartialTool& partial) {
    FoundTool stated{.tool = partial.tool, .has_shape = true, .source = "the set-up"};
    if (!partial.stated.contains("name")) stated.tool.name = found.tool.name;
    if (partial.stated.contains("diameter")) return stated;
    stated.has_diameter = false;
    stated.tool.diameter = found.tool.diameter;
    return stated;
}

/// A found tool with the values that the set-up states of it.
FoundTool overlaid(FoundTool found, const PartialTool& partial) {
    const auto states = [&](const char* key) { return partial.stated.contains(key); };
    if (states("shape")) return stated_tool(found, partial);
    core::ToolDescription& tool = found.tool;
    const core::ToolDescription& stated = partial.tool;
    if (states("stick_out") || states("holder") || states("holder_mesh")) tool.gauge_length.reset();
    const bool has_plain_shank =
        tool.shank.size() == 1 && tool.shank[0].lower_diameter == tool.shank[0].upper_diameter;
    if (states("stick_out") && has_plain_shank) {
        tool.shank_diameter = tool.shank[0].lower_diameter;
        tool.shank.clear();
    }
    for (const core::ToolSize& size : core::tool_sizes())
        if (states(size.key)) size.put(tool, size.of(stated));
    found.has_diameter = found.has_diameter || states("diameter");
    tool.is_in_inches = stated.is_in_inches;
    if (states("name")) tool.name = stated.name;
    if (states("teeth")) tool.teeth = stated.teeth;
    if (states("shank")) {
        tool.shank = stated.shank;
        tool.stick_out = stated.stick_out;
    }
    if (states("holder") || states("holder_mesh")) tool.holder = stated.holder;
    if (states("touched_off")) {
        tool.touched_off = stated.touched_off;
        tool.length_is_guess = stated.length_is_guess;
    }
    if (states("spindle")) tool.cuts = stated.cuts;
    if (states("cuts_at_centre")) tool.cuts_at_centre = stated.cuts_at_centre;
    if (states("cuts_at_centre") || states("centre_diameter"))
        tool.centre_radius =
            states("centre_diameter") ? stated.centre_radius : 0.25 * tool.diameter;
    if (states("single_point")) tool.single_point = stated.single_point;
    found.source += " and the set-up";
    return found;
}

/// A tool of a library that does not name its shape: the program decides what it is.
FoundTool shaped(const FoundTool& listed, const FoundTool& in_program) {
    const PartialTool known{listed.tool, known_keys(listed), {}};
    FoundTool found = overlaid(in_program, known);
    found.tool.number = listed.tool.number;
    found.has_shape = in_program.has_shape && in_program.is_described;
    found.is_described = true;
    found.source = listed.source;
    if (in_program.is_described) found.source += " and " + in_program.source;
    return found;
}

/// Puts the stated values of partly described tools into the missing ones.
///
/// Errors: invalid_value if they do not fit to what is known of the tool.
core::Result<void> overlay(const SetupFile& file, const ProgramSurvey& seen,
                           std::vector<FoundTool>& missing) {
    for (FoundTool& found : missing) {
        const auto partial = file.partial_tools.find(found.tool.number);
        if (partial == file.partial_tools.end()) continue;
        found = overlaid(std::move(found), partial->second);
        if (file.is_partial) found = as_used(std::move(found), seen);
        const auto assembled = core::assemble(complete(found).tool);
        if (!assembled)
            return tl::unexpected<core::Error>(
                {core::ErrorCode::invalid_value, partial->second.where,
                 fmt::format("{} (what the set-up does not state is taken from {})",
                             assembled.error().message, found.source),
                 file.path});
    }
    return {};
}

/// Whether all tools on offer are those of the library.
bool names_none(const SuggestedTools& offered, const SetupFile& file) {
    return std::all_of(offered.tools.begin(), offered.tools.end(),
                       [&](const auto& tool) { return file.library.contains(tool.first); });
}

/// The tools that the program uses and the set-up lacks, with what is known of them.
core::Result<std::vector<FoundTool>> missing_tools(SetupFile& file, const gcode::Program& program,
                                                   const ProgramSurvey& seen) {
    FEELER_TRY(const SuggestedTools offered, suggested_tools(file, program));
    const gcode::LengthUnit unit = unit_of_program(program, unit_at_start(file.environment));
    const auto mills = [&](ToolNumber number) {
        const auto found = seen.mills.find(number);
        return found == seen.mills.end() ? std::nullopt : std::optional(found->second);
    };
    std::vector<FoundTool> missing;
    std::vector<ToolNumber> wanted = seen.tools;
    const bool only_empties = seen.tools.empty() && seen.empties_spindle;
    if (file.is_partial && only_empties) wanted.push_back(ToolNumber{0}); // it cuts after T0 M6
    for (const ToolNumber number : wanted) {
        const auto found = offered.tools.find(number);
        if (file.setup.tools.contains(number)) continue;
        // The only tool of a program whose calls have variables, as in T#1 M6.
        const bool may_be_only = file.is_partial && offered.in_spindle && wanted.size() == 1;
        const bool is_only = may_be_only && offered.tools.empty();
        if (found != offered.tools.end() || is_only) {
            FoundTool tool = is_only ? *offered.in_spindle : found->second;
            tool.tool.number = number;
            if (!tool.has_shape && file.library.contains(number))
                tool = shaped(tool, may_be_only && names_none(offered, file)
                                        ? *offered.in_spindle
                                        : unknown_tool(number, mills(number), unit));
            missing.push_back(file.is_partial ? as_used(std::move(tool), seen) : tool);
        } else if (file.is_partial || file.partial_tools.contains(number)) {
            missing.push_back(unknown_tool(number, mills(number), unit));
        }
    }
    for (FoundTool& found : missing) {
        const auto name = seen.tool_names.find(found.tool.number);
        if (name != seen.tool_names.end()) found.tool.name = name->second;
    }
    const bool one_is_held = seen.feeds_before_call || !seen.calls_tools;
    const bool is_held_besides = file.is_partial && seen.calls_tools;
    const bool is_stated = !file.setup.tools.empty() && !is_held_besides;
    const std::optional<ToolNumber> at_start = file.setup.tool_at_start;
    const bool is_known = at_start && (!file.is_partial || !is_free(*at_start, seen, file));
    if (!one_is_held || is_stated || is_known) return missing;
    const ToolNumber held = at_start.value_or(free_number(seen, file));
    if (file.setup.tools.contains(held)) {
        file.setup.tool_at_start = held;
    } else if (offered.in_spindle) {
        missing.push_back(*offered.in_spindle);
        if (core::value_of(missing.back().tool.number) == 0) missing.back().tool.number = held;
    } else if (file.is_partial) {
        missing.push_back(unknown_tool(held, mills(ToolNumber{0}), unit));
    }
    if (file.is_partial && seen.calls_tools && !at_start) {
        if (!file.setup.tool_at_start) file.setup.tool_at_start = missing.back().tool.number;
        file.assumptions.push_back(
            fmt::format("the program cuts before its first tool call: tool {} is in the spindle",
                        core::value_of(*file.setup.tool_at_start)));
    }
    return missing;
}

/// Notes on partly described tools that the program does not use: they cannot be completed.
void add_notes_on_unused(SetupFile& file, const std::vector<FoundTool>& used) {
    for (const auto& [number, partial] : file.partial_tools) {
        const auto is_it = [&, which = number](const FoundTool& found) {
            return found.tool.number == which;
        };
        if (std::any_of(used.begin(), used.end(), is_it)) continue;
        file.assumptions.push_back(
            fmt::format("tool {} is described in part, and the program does not use it: it is left "
                        "out",
                        core::value_of(number)));
    }
}

std::vector<std::string> put_tools(SetupFile& file, const std::vector<FoundTool>& tools,
                                   const ProgramSurvey& seen, double least_flutes) {
    std::vector<std::string> assumed;
    for (FoundTool tool : tools) {
        if (seen.left_taps.contains(tool.tool.number))
            tool.tool.cuts = core::SpindleDirection::counterclockwise;
        auto length = seen.control_lengths.find(tool.tool.number);
        if (length == seen.control_lengths.end()) // the tool in the spindle before the first call
            length = seen.control_lengths.find(ToolNumber{0});
        assumed.push_back(put_tool(file, tool, least_flutes,
                                   length == seen.control_lengths.end() ? 0.0 : length->second));
    }
    return assumed;
}

SurveyTools sizes(const SetupFile& file, bool calls_tools) {
    SurveyTools known;
    for (const auto& [number, tool] : file.setup.tools) {
        double widest = 0.0;
        for (const core::ToolPart& part : tool.parts)
            if (part.kind == core::PartKind::flutes) widest = core::bounds(part.profile).max.x;
        known.lengths[number] = tool.length;
        known.radii[number] = widest;
    }
    // A motion before the first call belongs to the tool stated for the start, or to the only tool.
    const bool only_one = !calls_tools && file.setup.tools.size() == 1;
    if (file.setup.tool_at_start || only_one) {
        const ToolNumber only = file.setup.tool_at_start.value_or(file.setup.tools.begin()->first);
        known.lengths[ToolNumber{0}] = known.lengths[only];
        known.radii[ToolNumber{0}] = known.radii[only];
    }
    return known;
}

/// Adds the stock that the program states, else the one inferred from its cuts.
core::Result<std::vector<std::string>> complete_stock(SetupFile& file,
                                                      const gcode::Program& program,
                                                      const ProgramSurvey& seen,
                                                      const SurveyTools& tools) {
    const Vec3 frame = file.setup.stock_mount.link_from_body.translation;
    const double margin = file.stock_margin.value_or(0.0);
    const gcode::LengthUnit unit = unit_of_program(program, unit_at_start(file.environment));
    std::optional<core::Aabb> reach;
    if (seen.feeds) reach = core::Aabb{seen.cutting.min - seen.zero, seen.cutting.max - seen.zero};
    const auto stated = file.stock_margin ? std::nullopt : declared_stock(program, unit, reach);
    InferredStock stock;
    if (stated) {
        const Vec3 shift = seen.zero - frame;
        const core::Aabb box{stated->box.min + shift, stated->box.max + shift};
        const auto sentence = [&](gcode::LengthUnit words) {
            return fmt::format("the stock is the box given by {}: {}", stated->source,
                               box_text(box, words));
        };
        stock = {{stated->box.min + seen.zero, stated->box.max + seen.zero},
                 sentence(gcode::LengthUnit::mm),
                 sentence(gcode::LengthUnit::inch)};
        file.stock_known = Known::described;
    } else {
        file.stock_known = Known::inferred;
        stock = guessed_stock(seen, frame, margin);
        if (seen.feeds && !file.stock_margin)
            stock = guessed_stock(seen, frame, margin,
                                  uncut_plunges(program, file.environment, tools, stock.box));
    }
    const double tolerance = file.setup.stock.tolerance;
    file.setup.stock = {core::SolidBox{{stock.box.min - frame, stock.box.max - frame}}, tolerance};
    file.stock_comment = file.length_unit == gcode::LengthUnit::inch ? stock.why_inch : stock.why;
    return std::vector<std::string>{stock.why};
}

/// How the stock that the program states reaches beyond that of the set-up; empty if it does not.
std::string stock_mismatch(const SetupFile& file, const gcode::Program& program,
                           const ProgramSurvey& seen) {
    constexpr double rounding = 0.5; // mm; stock sizes are nominal
    const core::Transform& machine_from_stock = file.setup.stock_mount.link_from_body;
    const bool is_parallel = machine_from_stock.rotation == core::Mat3(1.0);
    if (!seen.feeds || !is_parallel || stands_for_no_stock(file.setup.stock)) return {};
    const gcode::LengthUnit unit = unit_of_program(program, unit_at_start(file.environment));
    const core::Aabb reach{seen.cutting.min - seen.zero, seen.cutting.max - seen.zero};
    const auto stated = declared_stock(program, unit, reach);
    if (!stated) return {};
    const core::Aabb body = core::bounds(file.setup.stock);
    const Vec3 shift = machine_from_stock.translation - seen.zero;
    const core::Aabb known{body.min + shift, body.max + shift};
    const core::Aabb room = known.grown(rounding + file.setup.stock.tolerance);
    bool is_inside = true;
    for (int axis = 0; axis < 3; ++axis)
        is_inside = is_inside && stated->box.min[axis] >= room.min[axis]
                    && stated->box.max[axis] <= room.max[axis];
    if (is_inside) return {};
    return fmt::format("The stock that the program was made for reaches beyond that of the set-up: "
                       "{} gives {}, and the set-up {} (program coordinates).",
                       stated->source, box_text(stated->box, gcode::LengthUnit::mm),
                       box_text(known, gcode::LengthUnit::mm));
}

/// Omits the stock for a program whose cuts cannot be known.
///
/// Result: the reason; empty for all other programs.
std::optional<std::string> leave_out_stock(SetupFile& file, const gcode::Program& program) {
    std::string why;
    if (const auto turning = turning_reason(program);
        turning
        && (file.is_inferred || file.needs_stock || stands_for_no_stock(file.setup.stock))) {
        why = fmt::format("this is a lathe program, because {}. Turning is not checked: there is "
                          "no stock, and only the codes are checked",
                          *turning);
        file.not_judged = why;
    } else if (const auto line = line_that_asks_for_positions(program); line && file.needs_stock) {
        why = fmt::format("line {} reads the axis positions, so the motions depend on where the "
                          "axes were jogged: no stock is assumed",
                          *line);
    } else {
        return std::nullopt;
    }
    file.setup.rules[core::rule_id("missing-length-offset")] = core::Severity::off;
    file.setup.rules[core::rule_id("tool-change-unsafe")] = core::Severity::off;
    if (file.needs_stock)
        file.setup.stock = {core::SolidBox{unreachable_box()}, file.setup.stock.tolerance};
    return why;
}

/// Assumes that Z is touched off with each tool: then their lengths have no effect.
void assume_touch_off(SetupFile& file) {
    file.touches_off = true;
    for (auto& [number, tool] : file.setup.tools) {
        if (tool.description.touched_off) continue;
        core::ToolDescription touched = tool.description;
        touched.touched_off = 0.0;
        auto assembled = core::assemble(touched);
        if (!assembled) continue;
        assembled->reach_is_assumed = tool.reach_is_assumed;
        tool = *std::move(assembled);
        file.environment.tool_lengths[number] = 0.0;
    }
    file.setup.rules[core::rule_id("missing-length-offset")] = core::Severity::off;
    file.assumptions.push_back(
        "the program uses no tool length offset: Z is touched off with each tool");
}

/// Whether nothing contradicts that Z is touched off with each tool: a stated work offset does,
/// with a tool of which the true length counts.
bool may_touch_off(const SetupFile& file) {
    const auto& tools = file.setup.tools;
    const auto is_touched_off = [](const auto& tool) {
        return tool.second.description.touched_off.has_value();
    };
    return file.infers_frame
           || (file.is_partial && std::all_of(tools.begin(), tools.end(), is_touched_off));
}

/// Assumes what an operator does by hand when running such a program.
void assume_handwork(SetupFile& file, const ProgramSurvey& seen) {
    const bool cuts = !seen.mills.empty();
    if (!seen.turns_spindle && cuts) {
        file.setup.spindle_at_start = core::SpindleDirection::clockwise;
        file.assumptions.push_back(
            "the program never starts the spindle: it is switched on by hand");
    } else if (seen.turns_spindle && !seen.states_speed) {
        file.speed_by_hand = true;
        file.assumptions.push_back("the program has no spindle speed: it is set by hand");
    }
}

/// Whether the set-up or the program states every work offset in whose coordinates the program
/// moves, and the set-up every one in whose frame bodies stand.
Known known_offsets(const SetupFile& file, const ProgramSurvey& seen) {
    if (!file.offsets_of_bodies.empty()) return Known::inferred;
    if (seen.offsets.empty() && file.offsets_set.empty()) return Known::inferred;
    const bool has_table = !file.infers_frame && !file.environment.parameters.empty();
    for (const auto& [offset, is_set] : seen.offsets) {
        if (offset >= gcode::no_work_offset) continue;
        const bool is_stated = file.offsets_set.contains(static_cast<int>(offset));
        const bool is_in_table =
            has_table && file.environment.work_offset(offset) != gcode::AxisValues{};
        if (!is_stated && !is_in_table && !is_set) return Known::inferred;
    }
    return Known::described;
}

/// A coarser mesh for large stocks, to limit memory, and a finer one for small stocks.
void choose_mesh_size(SetupFile& file) {
    constexpr double cells = 600.0, usual = 0.5, finest = 0.05, least_cells = 40.0;
    constexpr double thin_cells = 4.0; // across the shortest side, whatever that takes
    if (file.mesh_is_stated || !file.is_partial) return;
    const Vec3 size = core::bounds(file.setup.stock).size();
    const double longest = std::max({size.x, size.y, size.z});
    const double shortest = std::min({size.x, size.y, size.z});
    const double steps = std::ceil(longest / least_cells / finest); // of a small stock
    const double fine = std::min(usual, core::round(100.0 * steps * finest) / 100.0);
    const double coarse = std::ceil(10.0 * longest / cells) / 10.0;
    file.setup.mesh_size = std::max(fine, std::min(coarse, shortest / thin_cells));
}

/// Whether a program that starts anywhere feeds to a position that it does not state itself, or
/// ends at one: with G91 from the start, or with an axis that it never positions.
bool relies_on_start(const gcode::Program& program, const gcode::Environment& environment) {
    bool relies = false, is_known = true;
    visit_events(program, environment, [&](const ProgramEvent& event) {
        const auto* motion = std::get_if<core::Motion>(&event.event);
        if (!motion) return;
        is_known = motion->to[0] && motion->to[1] && motion->to[2];
        relies = relies || (!is_known && motion->kind != core::MotionKind::rapid);
    });
    return relies || !is_known;
}

/// Withdraws an assumed start position on which more than the first motions would rest.
void withdraw_start(SetupFile& file, const gcode::Program& program) {
    std::array<bool, 3>& is_assumed = file.setup.start_is_assumed;
    if (std::none_of(is_assumed.begin(), is_assumed.end(), [](bool is) { return is; })) return;
    gcode::Environment anywhere = file.environment;
    for (size_t i = 0; i < is_assumed.size(); ++i)
        if (is_assumed[i]) anywhere.start[i].reset();
    if (!relies_on_start(program, anywhere)) return;
    file.environment.start = anywhere.start;
    is_assumed = {};
    std::erase(file.assumptions, file.start_assumption);
}

/// What is assumed of axes that the program moves and no machine describes.
void assume_axes(SetupFile& file, const ProgramSurvey& seen) {
    if (file.has_axes) return;
    file.uses_other_axes = !seen.other_axes.empty();
    for (const size_t axis : seen.other_axes)
        file.assumptions.push_back(fmt::format(
            "axis {} {}, so blocks are checked only while it is at 0, and the stock is inferred "
            "from cuts there",
            core::axis_letters[axis],
            core::is_rotary(axis) ? "turns the table with the stock and all fixtures; where its "
                                    "centre is, is not known"
                                  : "moves the tool or the work, it is not known which"));
}

/// Bodies that a check leaves out because nobody stated how far the tools stick out.
std::vector<std::string> unknown_reaches(const core::Setup& setup) {
    const core::Machine& machine = setup.machine;
    const bool has_bodies = std::any_of(
        machine.bodies.begin(), machine.bodies.end(),
        [&](const core::MachineBody& body) { return !is_on_table_side(machine, body.link); });
    std::vector<std::string> notes;
    for (const auto& [number, tool] : setup.tools)
        if (has_bodies && tool.reach_is_assumed)
            notes.push_back(
                fmt::format("nobody has stated how far tool {} sticks out, so the "
                            "spindle and other bodies that move with it are not checked "
                            "while it is used",
                            core::value_of(number)));
    return notes;
}

} // namespace

core::Result<SetupFile> bare_setup(const ProgramSettings& given) {
    SetupFile file;
    file.is_inferred = file.is_partial = file.infers_frame = file.needs_stock = true;
    FEELER_TRY(AppliedSettings applied, apply(given, file.environment));
    const ProgramSettings& settings = applied.settings;
    if (file.environment.kinematics && file.environment.kinematics->machine) {
        // The rotary axes have their places, so the work cannot be assumed to be anywhere.
        FEELER_TRY(SetupFile at_zero, read_setup_text({}, {}, given));
        at_zero.is_inferred = true;
        at_zero.assumptions.push_back(fmt::format(
            "no set-up: no fixtures; work offsets are {}",
            settings.parameters.empty() ? "at machine zero" : "those of the parameter file"));
        at_zero.assumptions.push_back(
            "every tool was touched off: the control knows its true length");
        return at_zero;
    }
    file.dialect = settings.dialect;
    file.tool_table = settings.tool_table;
    const std::string position = assume_machine_zero(file);
    const gcode::AxisValues& zero = file.environment.work_offsets[0];
    file.setup.stock_mount.link_from_body = core::translation({zero[0], zero[1], zero[2]});
    file.frames["G54"] = file.frames["stock"] = file.setup.stock_mount.link_from_body;
    file.frames["machine"] = {};
    file.assumptions = std::move(applied.notes);
    const std::string speeds = complete_machine(file.setup.machine, file.environment, false);
    if (!speeds.empty()) file.assumptions.push_back(speeds);
    file.assumptions.push_back("no set-up: no fixtures, no axis limits; " + position);
    file.assumptions.push_back("every tool was touched off: the control knows its true length");
    return file;
}

core::Result<SetupFile> infer_setup(const gcode::Program& program,
                                    const ProgramSettings& settings) {
    FEELER_TRY(SetupFile file, bare_setup(settings));
    if (!file.dialect) {
        FEELER_TRY(file.dialect, gcode::supported(gcode::recognise(program)));
    }
    FEELER_TRY(file.environment.dialect, gcode::supported(*file.dialect));
    if (auto whole = complete_setup(file, program); !whole) return tl::unexpected(whole.error());
    return file;
}

core::Result<void> complete_setup(SetupFile& file, const gcode::Program& program) {
    if (file.is_inferred)
        file.length_unit = unit_of_program(program, unit_at_start(file.environment));
    withdraw_start(file, program);
    const bool has_other_offsets = assume_other_offsets(file);
    ProgramSurvey first = survey(program, file.environment, sizes(file, true));
    if (file.infers_frame && assume_extended_offsets(file.environment, first))
        first = survey(program, file.environment, sizes(file, true));
    FEELER_TRY(std::vector<FoundTool> tools, missing_tools(file, program, first));
    if (const auto fits = overlay(file, first, tools); !fits) return tl::unexpected(fits.error());
    add_notes_on_unused(file, tools);
    const bool touches_off = !first.offsets_lengths && may_touch_off(file);
    if (touches_off && !file.setup.tools.empty()) assume_touch_off(file);
    put_tools(file, tools, first, 0.0);
    file.tools_used.insert(first.tools.begin(), first.tools.end());
    for (const FoundTool& tool : tools) file.tools_used.insert(tool.tool.number);
    assume_axes(file, first);
    file.stock_known = file.needs_stock ? Known::missing : Known::described;
    file.offsets_known = known_offsets(file, first);
    for (const auto& [offset, is_set] : first.offsets)
        if (offset < gcode::no_work_offset) file.offsets_used.insert(offset);
    if (file.is_partial) assume_handwork(file, first);
    if (touches_off && !file.touches_off) assume_touch_off(file);
    move_bodies(file, first);
    std::vector<std::string> about_stock;
    if (file.infers_frame || has_other_offsets) about_stock = move_apart(file, first);
    const bool is_apart = file.infers_frame || !about_stock.empty();
    if (has_other_offsets) move_stock(file, first);
    place_frames(file, first);
    if (!file.needs_stock) {
        choose_mesh_size(file);
        file.stock_mismatch = stock_mismatch(file, program, first);
    }
    const bool has_stock = !file.needs_stock && !stands_for_no_stock(file.setup.stock);
    if (has_stock && tools.empty() && !file.is_inferred) return {};
    const SurveyTools known = sizes(file, first.calls_tools);
    const auto offset = is_apart ? main_offset(first) : std::nullopt;
    const ProgramSurvey seen = survey(program, file.environment, known, offset);
    if (const auto why = leave_out_stock(file, program)) {
        about_stock = {*why};
    } else if (file.needs_stock) {
        FEELER_TRY(const auto notes, complete_stock(file, program, seen, known));
        about_stock.insert(about_stock.end(), notes.begin(), notes.end());
        choose_mesh_size(file);
    }
    // Flutes of unstated length are as long as the program needs them.
    const double top =
        core::bounds(file.setup.stock).max.z + file.setup.stock_mount.link_from_body.translation.z;
    const double deep = seen.feeds ? std::max(0.0, top - seen.lowest + 1.0) : 0.0;
    std::vector<std::string> notes = put_tools(file, tools, first, deep);
    for (size_t i = 0; i < tools.size(); ++i) {
        file.inferred_tools.insert_or_assign(tools[i].tool.number, notes[i]);
        file.found_tools.insert_or_assign(tools[i].tool.number, tools[i]);
    }
    if (!about_stock.empty()) file.inferred_stock = about_stock.back();
    for (std::string& note : unknown_reaches(file.setup)) notes.push_back(std::move(note));
    if (!file.not_judged.empty()) notes.clear(); // irrelevant: motions are not checked
    notes.insert(notes.end(), about_stock.begin(), about_stock.end());
    file.assumptions.insert(file.assumptions.end(), notes.begin(), notes.end());
    return {};
}

core::Result<SetupFile> completed_setup(const std::string& text, const std::string& path,
                                        const gcode::Program& program,
                                        const ProgramSettings& settings) {
    FEELER_TRY(SetupFile file, read_setup_text(text, path, settings));
    if (!file.dialect) {
        FEELER_TRY(file.dialect, gcode::supported(gcode::recognise(program)));
    }
    FEELER_TRY(file.environment.dialect, gcode::supported(*file.dialect));
    file.is_partial = true;
    if (auto whole = complete_setup(file, program); !whole)
        return tl::unexpected(core::in_file(std::move(whole).error(), path));
    return file;
}

bool is_stock_of_program(const SetupFile& file) {
    return file.needs_stock && file.stock_known == Known::described;
}

bool stands_for_no_stock(const core::Solid& stock) {
    constexpr double rounding = 1e-3;
    const core::Aabb box = core::bounds(stock), none = unreachable_box();
    return glm::distance(box.min, none.min) < rounding
           && glm::distance(box.max, none.max) < rounding;
}

std::shared_ptr<const Coverage> coverage_of(const SetupFile& file) {
    const bool has_stock = !stands_for_no_stock(file.setup.stock);
    const auto known = [&](Known stated, const char* word) {
        return file.assumed.contains(word) ? std::min(stated, Known::inferred) : stated;
    };
    const Known start = file.infers_start ? Known::inferred : Known::described;
    return std::make_shared<const Coverage>(Coverage{
        .stock = has_stock ? known(file.stock_known, "stock") : Known::missing,
        .fixtures = file.fixtures_known,
        .offsets = file.loses_machine ? Known::missing : known(file.offsets_known, "offsets"),
        .limits = file.limits_known,
        .start = known(start, "start"),
        .tools_assumed = {file.guessed_tools.begin(), file.guessed_tools.end()},
        .limits_need_offsets = file.limits_need_offsets});
}

namespace {

/// Default diameter of an unknown tool, mm.
double usual_diameter(gcode::LengthUnit unit) {
    return unit == gcode::LengthUnit::inch ? 6.35 : 6.0;
}

/// A plain tool of that diameter, for sizes that contradict each other.
core::ToolAssembly plain_tool(const core::ToolDescription& tool, double least_flutes) {
    FoundTool plain;
    plain.tool.number = tool.number;
    plain.tool.diameter = tool.diameter;
    plain.tool.touched_off = tool.touched_off;
    plain.tool.length_is_guess = tool.length_is_guess;
    const auto assembled = core::assemble(complete(plain, least_flutes).tool);
    return assembled ? *assembled : core::ToolAssembly{.description = plain.tool, .parts = {}};
}

} // namespace

core::Result<SuggestedTools> suggested_tools(const SetupFile& file, const gcode::Program& program) {
    SuggestedTools offered;
    offered.tools = file.library;
    ProgramTools named =
        tools_of_program(program, unit_of_program(program, unit_at_start(file.environment)));
    for (auto& [number, listed] : offered.tools)
        if (const auto said = named.tools.find(number);
            said != named.tools.end() && said->second.has_shape && !listed.has_shape)
            listed = shaped(listed, said->second);
    offered.tools.merge(named.tools);
    offered.in_spindle = std::move(named.in_spindle);
    if (!file.tool_table.empty()) {
        FEELER_TRY(auto table, read_tool_library(file.tool_table, file.environment.machine_unit));
        offered.tools.merge(table);
    }
    return offered;
}

FoundTool unknown_tool(ToolNumber number, std::optional<bool> mills, gcode::LengthUnit unit) {
    FoundTool guess;
    guess.tool.number = number;
    guess.tool.shape = mills.value_or(true) ? core::ToolShape::flat : core::ToolShape::drill;
    guess.tool.diameter = usual_diameter(unit);
    guess.has_shape = true;
    guess.is_described = false;
    guess.source = fmt::format("its use alone: it {}, and nothing describes it",
                               !mills   ? "cuts nothing"
                               : *mills ? "cuts sideways"
                                        : "only moves up and down");
    return guess;
}

std::string put_tool(SetupFile& file, const FoundTool& found, double least_flutes,
                     double control_length) {
    CompleteTool whole = complete(found, least_flutes);
    core::ToolDescription& tool = whole.tool;
    const auto partial = file.partial_tools.find(tool.number);
    const auto states = [&](const char* key) {
        return partial != file.partial_tools.end() && partial->second.stated.contains(key);
    };
    const bool states_length = states("touched_off");
    const core::ToolDescription& known = found.tool;
    const bool is_whole = known.shape == core::ToolShape::profile;
    const bool knows_diameter =
        is_whole || states("diameter") || (found.has_diameter && found.is_described);
    const bool knows_flutes =
        is_whole || known.flute_length > 0.0 || known.shape == core::ToolShape::lollipop;
    const bool knows_reach = is_whole || known.stick_out || !known.shank.empty()
                             || (known.gauge_length && !known.holder.empty());
    if (!knows_flutes || !knows_diameter || !knows_reach) file.guessed_tools.insert(tool.number);
    const bool knows_lengths = !file.library.empty() || !file.tool_table.empty();
    const bool is_guess = file.is_inferred || (file.is_partial && !knows_lengths);
    if ((is_guess || file.touches_off) && !states_length) {
        tool.touched_off = control_length;
        tool.length_is_guess = control_length == 0.0;
    }
    // The control's tool table may give the tool length.
    const auto entry =
        file.environment.length_offsets.find(core::OffsetNumber{core::value_of(tool.number)});
    const bool longer = entry != file.environment.length_offsets.end()
                        && entry->second.length > tool.stick_out.value_or(0.0);
    if (!is_guess && longer && !tool.gauge_length) tool.gauge_length = entry->second.length;
    const bool is_held =
        found.tool.stick_out || found.tool.gauge_length || !found.tool.holder.empty();
    auto assembled = core::assemble(tool);
    if (!assembled) {
        whole.assumed = fmt::format("{}; treated as a flat end mill of {:g} mm",
                                    assembled.error().message, tool.diameter);
        assembled = plain_tool(tool, least_flutes);
    }
    assembled->reach_is_assumed = !is_held;
    file.environment.tool_lengths[tool.number] = assembled->length;
    if (tool.length_is_guess) file.environment.guessed_lengths.insert(tool.number);
    file.environment.tool_diameters[tool.number] = assembled->description.diameter;
    file.setup.tools.insert_or_assign(tool.number, *std::move(assembled));
    return whole.assumed;
}

} // namespace app
