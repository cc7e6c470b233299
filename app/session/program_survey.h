#pragma once

#include <map>
#include <vector>

#include "core/base/vec.h"
#include "core/sim/tool_assembly.h"
#include "gcode/environment.h"
#include "gcode/interpreter.h"

namespace app {

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

    bool feeds = false;
    core::Aabb cutting;       // of the tip on feeds below the retract plane; machine frame
    double lowest = 0.0;      // where the tip feeds, machine Z
    double highest_cut = 0.0; // of feeds sideways below the retract plane
    bool cuts_sideways = false;
    std::optional<double> retract; // the height of most rapid travel
};

/// Sizes of the tools that a survey needs.
struct SurveyTools {
    std::map<core::ToolNumber, double> lengths, radii; // those that are not there count as 0
};

ProgramSurvey survey(const gcode::Program& program, const gcode::Environment& environment,
                     const SurveyTools& tools);

} // namespace app
