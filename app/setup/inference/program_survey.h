#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/motion/event.h"
#include "gcode/language/modal_state.h"

namespace gcode {
struct Environment;
struct Program;
} // namespace gcode

namespace core {
struct Machine;
}

namespace app {

/// The feeds of a program in the coordinates of one work offset.
struct WorkArea {
    core::Vec3 zero = core::Vec3(0.0); // program zero at the first feed, machine frame
    core::Aabb reach;                  // of the tip
    double way = 0.0;                  // travel of the tip, mm
    bool is_set = false;               // the program sets the work offset itself
    gcode::WorkOffset first;           // the work offset at the first feed
    bool is_moved = false;             // it has another value at a later feed
};

/// Facts about a whole program from which its set-up is inferred.
struct ProgramSurvey {
    std::vector<core::ToolNumber> tools; // in the order in which they are first called
    bool calls_tools = false;            // including T0
    bool empties_spindle = false;        // calls T0
    bool turns_spindle = false;
    bool states_speed = false;    // of the spindle, above 0
    bool offsets_lengths = false; // uses G43 or an equivalent
    bool feeds_before_call = false;
    std::map<core::ToolNumber, double> control_lengths; // in effect at the first feed of each tool
    std::map<core::ToolNumber, std::string> tool_names; // by which the program calls them
    std::map<core::ToolNumber, bool> mills;             // of each tool that feeds: whether sideways

    std::map<size_t, WorkArea> work_areas; // by work offset with feeds, 0 is G54
    std::map<size_t, bool> offsets;        // in whose coordinates it moves: whether it sets them
    std::set<core::ToolNumber> left_taps;  // tools that tap with the spindle counterclockwise
    bool sets_offsets = false;             // sets a work offset that it then uses
    std::set<size_t> other_axes;           // beyond Z, away from 0, that no machine describes

    core::Vec3 zero = core::Vec3(0.0); // of the surveyed work offset, machine frame
    bool feeds = false;                // in that work offset
    core::Aabb cutting;                // box of feeds below the retract plane, machine frame
    double lowest = 0.0;               // lowest tip position on feeds, machine Z
    double highest_cut = 0.0;          // highest sideways feed below the retract plane
    bool cuts_sideways = false;
    std::optional<double> retract; // height of most rapid travel
};

/// Tool sizes that a survey needs.
struct SurveyTools {
    std::map<core::ToolNumber, double> lengths, radii; // mm; missing ones count as 0
};

/// The size of the tool in the spindle; before any call, that of the entry for tool 0.
double size_of(const std::map<core::ToolNumber, double>& sizes,
               const std::optional<core::ToolNumber>& tool);

/// Surveys a whole program. Cuts are limited to those in the coordinates of work offset `offset`,
/// if given.
ProgramSurvey survey(const gcode::Program& program, const gcode::Environment& environment,
                     const SurveyTools& tools, const std::optional<size_t>& offset = {});

/// One event of a block, with the tool in the spindle, the active offsets and the line of the
/// block.
struct ProgramEvent {
    const core::Event& event;
    std::optional<core::ToolNumber> tool;
    const gcode::Offsets& offsets;
    uint32_t line = 0;
    bool is_cycle = false;
    bool is_in_work = true; // its block moves in the coordinates of the program
};

/// Runs a program to its end or its first error and reports every event. Checks nothing.
///
/// Result: the tools that the program calls by names which the environment lacks.
std::map<core::ToolNumber, std::string>
visit_events(const gcode::Program& program, const gcode::Environment& environment,
             const std::function<void(const ProgramEvent&)>& visit);

/// The path of a tool tip over one motion, machine frame; arcs as points on them.
struct TipTrack {
    std::vector<core::Vec3> positions;
    bool sideways = false; // it moves in X or Y

    double lowest() const;
    double length() const;
};

/// The path of the tip of a tool with the given length, as seen from the work with all rotary axes
/// at 0; empty if an end point is unknown. `machine`: null without rotary axes.
std::optional<TipTrack> tip_track(const core::Motion& motion, double tool_length,
                                  const core::Machine* machine);

/// Why a program is for a lathe, to follow "because": it never moves Y, and it has a code used only
/// in turning. Empty for any other program.
std::optional<std::string> turning_reason(const gcode::Program& program);

/// The line in which a Klartext program first reads the axis positions: what it does then depends
/// on where the axes were jogged.
std::optional<size_t> line_that_asks_for_positions(const gcode::Program& program);

} // namespace app
