#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/motion/event.h"

namespace gcode {
struct Environment;
struct Offsets;
struct Program;
} // namespace gcode

namespace app {

/// What a program feeds in the coordinates of one work offset.
struct WorkPlace {
    core::Vec3 zero = core::Vec3(0.0); // of the program at the first feed, machine frame
    core::Aabb reach;                  // of the tip
    double way = 0.0;                  // of the tip, mm
};

/// What a program does as a whole, which its set-up can be guessed from.
struct ProgramSurvey {
    std::vector<core::ToolNumber> tools; // in the order in which they are first called
    bool calls_tools = false;            // also T0
    bool empties_spindle = false;        // calls T0
    bool turns_spindle = false;
    bool states_speed = false;    // of the spindle, above 0
    bool offsets_lengths = false; // G43 or its like, ever
    bool feeds_before_call = false;
    std::map<core::ToolNumber, double> control_lengths; // that are in effect as a tool first feeds
    std::map<core::ToolNumber, bool> mills; // of each tool that feeds: it feeds sideways

    std::map<size_t, WorkPlace> places; // of each work offset, 0 is G54, where it feeds
    bool sets_offsets = false;          // writes a work offset that it then uses

    core::Vec3 zero = core::Vec3(0.0); // of the place that is looked at, machine frame
    bool feeds = false;                // there
    core::Aabb cutting;                // of the tip on feeds below the retract plane; machine frame
    double lowest = 0.0;               // where the tip feeds, machine Z
    double highest_cut = 0.0;          // of feeds sideways below the retract plane
    bool cuts_sideways = false;
    std::optional<double> retract; // the height of most rapid travel
};

/// Sizes of the tools that a survey needs.
struct SurveyTools {
    std::map<core::ToolNumber, double> lengths, radii; // those that are not there count as 0
};

/// The size of the tool that is in the spindle; the one without a number serves before any call.
double size_of(const std::map<core::ToolNumber, double>& sizes,
               const std::optional<core::ToolNumber>& tool);

/// Looks at a whole program; at what it cuts only in the coordinates of the work offset `place`, if
/// there is one.
ProgramSurvey survey(const gcode::Program& program, const gcode::Environment& environment,
                     const SurveyTools& tools, const std::optional<size_t>& place = {});

/// What a program does next, as far as it can be read: one event of one block, the tool that is in
/// the spindle, the offsets that are in effect, and the line it comes from.
struct ProgramEvent {
    const core::Event& event;
    std::optional<core::ToolNumber> tool;
    const gcode::Offsets& offsets;
    uint32_t line = 0;
    bool is_cycle = false;
};

/// Runs a program to its end or its first error and shows every event. Nothing is checked.
void visit_events(const gcode::Program& program, const gcode::Environment& environment,
                  const std::function<void(const ProgramEvent&)>& visit);

/// The way of a tool's tip over one motion, machine frame; arcs by places on them.
struct TipTrack {
    std::vector<core::Vec3> places;
    bool sideways = false; // it moves in X or Y

    double lowest() const;
    double length() const;
};

/// The way of the tip of a tool of a length; empty where an end is not known.
std::optional<TipTrack> tip_track(const core::Motion& motion, double tool_length);

/// Why a program is one for a lathe, as it ends "because ...": it never moves Y, and it says a
/// code that only turning has use for. Empty for any other.
std::optional<std::string> turning_reason(const gcode::Program& program);

/// The line in which a Klartext program first asks where the axes stand: what it does then depends
/// on where somebody jogged them.
std::optional<size_t> line_that_asks_for_places(const gcode::Program& program);

} // namespace app
